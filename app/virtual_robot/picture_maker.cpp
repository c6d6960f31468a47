#include "app/virtual_robot/picture_maker.h"

#include <cmath>
#include <map>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vtkActor.h>  // vtkRenderingCore
#include <vtkActorCollection.h>
#include <vtkLight.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTexture.h>

#include "app/virtual_robot/picture_effects.h"
#include "widgets/scene/lens_warp.h"
#include "widgets/scene/offscreen_renderer.h"
#include "widgets/scene/robot_rep.h"
#include "widgets/scene/world_rep.h"

namespace longarm::virtual_robot {
namespace {

// The pinhole picture is a little larger than the camera's, because bending crops and blurs.
constexpr int kRasterWidth = 768, kRasterHeight = 576;
// Instead of multisampling, which costs more than the scene under software GL: the blur of a real lens [px of raster].
constexpr double kLensBlur = 0.6;
constexpr double kSharp_px = 0.2, kWorstBlur_px = 12;    // Less is not seen; more makes no difference.
constexpr double kGroundSize = 40;       // [m]
constexpr int kJpegQuality = 92;
constexpr const char* kGround = "ground";

struct Lens {
  vision::CameraModel model;
  scene::LensWarp warp;
};

bool same(const vision::CameraModel& a, const vision::CameraModel& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.skew == b.skew &&
         a.cx == b.cx && a.cy == b.cy && a.distortion == b.distortion;
}

planning::WorldObject groundBody() {
  planning::WorldObject ground;
  ground.name = kGround;
  ground.shape = planning::Box{{kGroundSize, kGroundSize, 0.1}};
  ground.X_WO.translation().z() = -0.05;
  ground.rgba = {0.62, 0.61, 0.58, 1};
  return ground;
}

vtkSmartPointer<vtkLight> lightFrom(const Eigen::Vector3d& direction, double intensity) {
  auto light = vtkSmartPointer<vtkLight>::New();
  const Eigen::Vector3d from = -10 * direction.normalized();
  light->SetLightTypeToSceneLight();
  light->SetPositional(false);
  light->SetPosition(from.x(), from.y(), from.z());
  light->SetFocalPoint(0, 0, 0);
  light->SetIntensity(intensity);
  return light;
}

// The main light, and a weaker one from behind the robot for what bounces off the surroundings.
void setLights(vtkRenderer* renderer, const planning::ScenarioLight& light) {
  renderer->SetAutomaticLightCreation(false);
  renderer->AddLight(lightFrom(light.direction, light.intensity));
  renderer->AddLight(lightFrom({0.8, -0.15, -0.45}, 1.1 * light.ambient));
}

// Anisotropic filtering doubles the time of a picture and is hardly seen through a lens.
void simplifyTextures(vtkRenderer* renderer) {
  vtkActorCollection* actors = renderer->GetActors();
  actors->InitTraversal();
  while (vtkActor* actor = actors->GetNextActor()) {
    if (actor->GetTexture() != nullptr) actor->GetTexture()->SetMaximumAnisotropicFiltering(1);
  }
}

}  // namespace

struct PictureMaker::Impl {
  std::unique_ptr<scene::OffscreenRenderer> renderer;
  std::unique_ptr<scene::RobotRep> robot;
  std::unique_ptr<scene::WorldRep> world;
  scene::SurfaceNames surfaces;
  std::map<std::string, Lens> lenses;
  NoiseBank noise;

  Status prepare(const PictureOrder& order) {
    const auto found = lenses.find(order.camera);
    if (found != lenses.end() && same(found->second.model, order.lens)) return {};
    auto warp = scene::LensWarp::make(order.lens, kRasterWidth, kRasterHeight);
    if (!warp) return warp.error();
    lenses.erase(order.camera);
    lenses.emplace(order.camera, Lens{order.lens, std::move(*warp)});
    return {};
  }

  void show(const WorldSnapshot& snapshot) {
    robot->update(snapshot.X_WL);
    auto objects = snapshot.objects;
    objects.insert(objects.begin(), groundBody());
    world->update(objects, {}, surfaces);
    simplifyTextures(renderer->renderer());
  }
};

PictureMaker::PictureMaker() : m_impl(std::make_unique<Impl>()) {}

PictureMaker::~PictureMaker() {
  m_impl->robot.reset();
  m_impl->world.reset();
}

Result<std::unique_ptr<PictureMaker>> PictureMaker::create(const planning::Workcell& workcell,
                                                           const planning::Scenario& scenario) {
  scene::OffscreenOptions options;
  options.width = kRasterWidth;
  options.height = kRasterHeight;
  options.samples = 0;
  auto renderer = scene::OffscreenRenderer::create(options);
  if (!renderer) return renderer.error();
  std::unique_ptr<PictureMaker> made(new PictureMaker);
  Impl& impl = *made->m_impl;
  impl.renderer = std::move(*renderer);
  impl.robot = std::make_unique<scene::RobotRep>(workcell.model);
  impl.world = std::make_unique<scene::WorldRep>();
  impl.surfaces[kGround] = scenario.ground;
  for (const auto& object : scenario.objects) impl.surfaces[object.body.name] = object.surface;
  setLights(impl.renderer->renderer(), scenario.light);
  impl.robot->addTo(impl.renderer->renderer());
  impl.world->addTo(impl.renderer->renderer());
  return made;
}

Result<cv::Mat> PictureMaker::render(const WorldSnapshot& world, const PictureOrder& order) {
  const auto pose = world.X_WC.find(order.camera);
  if (pose == world.X_WC.end()) {
    return Error{ErrorCode::kNotFound, "no camera \"" + order.camera + "\" to take a picture with"};
  }
  if (auto status = m_impl->prepare(order); !status) return status.error();
  const scene::LensWarp& warp = m_impl->lenses.at(order.camera).warp;
  m_impl->show(world);
  m_impl->renderer->lookFrom(pose->second, warp.pinhole());
  cv::Mat raster = m_impl->renderer->render();
  cv::GaussianBlur(raster, raster, {3, 3}, kLensBlur);
  cv::Mat picture = warp.apply(raster);
  if (order.blur_px > kSharp_px) cv::GaussianBlur(picture, picture, {}, std::min(order.blur_px, kWorstBlur_px));
  if (order.glare) addGlare(picture);
  if (order.dark) darken(picture);
  m_impl->noise.addTo(picture, order.noise, order.seed ^ static_cast<unsigned>(std::llround(world.time_s * 1000)));
  return picture;
}

Result<Picture> PictureMaker::take(const WorldSnapshot& world, const PictureOrder& order) {
  const auto picture = render(world, order);
  if (!picture) return picture.error();
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".jpg", *picture, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality})) {
    return Error{ErrorCode::kInternal, "the picture of camera \"" + order.camera + "\" could not be encoded"};
  }
  return Picture{order.camera, world.time_s, order.lens, std::string(bytes.begin(), bytes.end())};
}

}  // namespace longarm::virtual_robot
