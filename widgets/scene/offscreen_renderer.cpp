#include "widgets/scene/offscreen_renderer.h"

#include <algorithm>
#include <mutex>
#include <string>

// GLEW's header must come before any other that declares OpenGL.
#include <vtk_glew.h>  // vtkglew

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <opencv2/imgproc.hpp>
#include <vtkCamera.h>                     // vtkRenderingCore
#include <vtkGenericOpenGLRenderWindow.h>  // vtkRenderingOpenGL2
#include <vtkObjectFactory.h>              // vtkCommonCore
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include "widgets/scene/camera_presets.h"

namespace longarm::scene {
namespace {

/// A surfaceless OpenGL context.
struct EglContext {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  ~EglContext() {
    if (context == EGL_NO_CONTEXT) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);  // the display is shared by the process and stays
  }
  bool makeCurrent() const { return eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE; }
};

Error eglError(const std::string& call) {
  return {ErrorCode::kInternal, "Cannot render without a display: " + call + " failed with EGL error " +
                                    std::to_string(eglGetError()) + ". Install Mesa's EGL (libegl-mesa0)."};
}

/// One initialised display for the whole process.
Result<EGLDisplay> sharedDisplay() {
  static std::mutex mutex;
  static EGLDisplay display = EGL_NO_DISPLAY;
  std::lock_guard<std::mutex> lock(mutex);
  if (display != EGL_NO_DISPLAY) return display;
  const auto get = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get == nullptr) return eglError("eglGetPlatformDisplayEXT");
  EGLDisplay candidate = get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  EGLint major = 0, minor = 0;
  if (candidate == EGL_NO_DISPLAY || eglInitialize(candidate, &major, &minor) == EGL_FALSE) {
    return eglError("eglInitialize");
  }
  display = candidate;
  return display;
}

Status start(EglContext& egl) {
  const Result<EGLDisplay> display = sharedDisplay();
  if (!display) return display.error();
  egl.display = *display;
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return eglError("eglBindAPI");
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(egl.display, wanted, &config, 1, &count) == EGL_FALSE || count < 1) {
    return eglError("eglChooseConfig");
  }
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 2, EGL_NONE};
  egl.context = eglCreateContext(egl.display, config, EGL_NO_CONTEXT, version);
  if (egl.context == EGL_NO_CONTEXT) return eglError("eglCreateContext");
  if (!egl.makeCurrent()) return eglError("eglMakeCurrent");
  return {};
}

/// VTK's window for contexts of others.  It initialises GLEW by itself: VTK's way asks GLX for a display, finds none and
/// reports an error at each start though every entry point is loaded.
class EglWindow final : public vtkGenericOpenGLRenderWindow {
 public:
  static EglWindow* New();
  vtkTypeMacro(EglWindow, vtkGenericOpenGLRenderWindow)

  void OpenGLInitContext() override {
    if (Initialized) return;
    glewExperimental = GL_TRUE;
    glewInit();
    while (glGetError() != GL_NO_ERROR) {
    }
    GlewInitValid = true;
    Initialized = true;
  }
  void MakeCurrent() override {
    if (egl != nullptr) egl->makeCurrent();
  }
  bool IsCurrent() override { return egl != nullptr && eglGetCurrentContext() == egl->context; }

  const EglContext* egl = nullptr;  ///< Borrowed; outlives the window's use of it.

 protected:
  EglWindow() = default;
  ~EglWindow() override = default;

 private:
  EglWindow(const EglWindow&) = delete;
  void operator=(const EglWindow&) = delete;
};
vtkStandardNewMacro(EglWindow)

}  // namespace

struct OffscreenRenderer::Impl {
  EglContext egl;
  vtkSmartPointer<EglWindow> window;
  vtkSmartPointer<vtkRenderer> renderer;
  vtkSmartPointer<vtkUnsignedCharArray> pixels;

  ~Impl() {
    if (window == nullptr) return;
    egl.makeCurrent();
    window->RemoveRenderer(renderer);
    window->Finalize();
    window->egl = nullptr;
  }
};

OffscreenRenderer::OffscreenRenderer() : m_impl(std::make_unique<Impl>()) {}

OffscreenRenderer::~OffscreenRenderer() = default;

Result<std::unique_ptr<OffscreenRenderer>> OffscreenRenderer::create(const OffscreenOptions& options) {
  std::unique_ptr<OffscreenRenderer> made(new OffscreenRenderer);
  Impl& impl = *made->m_impl;
  const Status started = start(impl.egl);
  if (!started) return started.error();
  impl.window = vtkSmartPointer<EglWindow>::New();
  impl.window->egl = &impl.egl;
  impl.window->SetOwnContext(0);
  impl.window->SetReadyForRendering(true);
  impl.window->SetFrameBlitModeToNoBlit();
  impl.window->SetMultiSamples(options.samples);
  impl.renderer = vtkSmartPointer<vtkRenderer>::New();
  impl.renderer->SetBackground(options.background.data());
  impl.renderer->SetBackground2(options.background_top.data());
  impl.renderer->SetGradientBackground(options.background != options.background_top);
  impl.window->AddRenderer(impl.renderer);
  impl.pixels = vtkSmartPointer<vtkUnsignedCharArray>::New();
  made->resize(options.width, options.height);
  return made;
}

vtkRenderer* OffscreenRenderer::renderer() const { return m_impl->renderer; }

int OffscreenRenderer::width() const { return m_impl->window->GetSize()[0]; }

int OffscreenRenderer::height() const { return m_impl->window->GetSize()[1]; }

void OffscreenRenderer::resize(int width, int height) {
  m_impl->window->SetSize(std::clamp(width, 1, 8192), std::clamp(height, 1, 8192));
}

void OffscreenRenderer::lookFrom(const Pose& X_WC, const vision::CameraModel& camera, double near_m, double far_m) {
  vtkCamera* vtk_camera = m_impl->renderer->GetActiveCamera();
  setCameraPose(vtk_camera, X_WC);
  setPinholeProjection(vtk_camera, camera, width(), height(), near_m, far_m);
}

cv::Mat OffscreenRenderer::render() {
  m_impl->egl.makeCurrent();
  m_impl->window->Render();
  const int w = width(), h = height();
  m_impl->window->GetPixelData(0, 0, w - 1, h - 1, 0, m_impl->pixels.Get(), 0);
  const cv::Mat bottom_up(h, w, CV_8UC3, m_impl->pixels->GetPointer(0));
  cv::Mat rgb, picture;
  cv::flip(bottom_up, rgb, 0);
  cv::cvtColor(rgb, picture, cv::COLOR_RGB2BGR);
  return picture;
}

}  // namespace longarm::scene
