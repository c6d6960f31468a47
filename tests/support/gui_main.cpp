// Main of tests with widgets: an application, our resources, and no Qt warning goes unnoticed.
#include <atomic>
#include <clocale>
#include <cstdio>
#include <stdexcept>
#include <string>

#include <QApplication>
#include <QLocale>
#include <QSurfaceFormat>
#include <gtest/gtest.h>

#include "core/require.h"
#include "tests/support/gui_warnings.h"
#ifdef LONGARM_GUI_TEST_RESOURCES
#include "widgets/resources.h"
#endif

namespace {

std::atomic<int> g_announced{0};

// Things the platform says that are not ours: the offscreen plugin has no such features.
bool isPlatformChatter(const QString& text) {
  return text.contains(QLatin1String("This plugin does not support")) ||
         text.contains(QLatin1String("QStandardPaths: XDG_RUNTIME_DIR")) ||
         text.contains(QLatin1String("QStandardPaths: runtime directory"));
}

void onQtMessage(QtMsgType type, const QMessageLogContext& context, const QString& text) {
  std::fprintf(stderr, "%s\n", qPrintable(text));
  if (type == QtDebugMsg || type == QtInfoMsg || isPlatformChatter(text)) return;
  if (g_announced.load() > 0) {
    --g_announced;
    return;
  }
  ADD_FAILURE() << "unexpected Qt message (" << (context.file != nullptr ? context.file : "?") << ":" << context.line
                << "): " << text.toStdString();
}

}  // namespace

namespace longarm::tests {

void announceQtWarning() { ++g_announced; }

}  // namespace longarm::tests

int main(int argc, char** argv) {
  longarm::setRequireHandler([](const std::string& what) { throw std::logic_error(what); });
  testing::InitGoogleTest(&argc, argv);
  if (testing::GTEST_FLAG(list_tests)) return RUN_ALL_TESTS();  // ctest asks for names without a display
  QSurfaceFormat format;                       // what QVTKOpenGLNativeWidget::defaultFormat() asks for
  format.setRenderableType(QSurfaceFormat::OpenGL);
  format.setVersion(3, 2);
  format.setProfile(QSurfaceFormat::CoreProfile);
  format.setDepthBufferSize(24);
  format.setStencilBufferSize(8);
  format.setAlphaBufferSize(8);
  QSurfaceFormat::setDefaultFormat(format);
  QCoreApplication::setAttribute(Qt::AA_ShareOpenGLContexts);
  QApplication application(argc, argv);
  std::setlocale(LC_NUMERIC, "C");
  QLocale::setDefault(QLocale::c());
#ifdef LONGARM_GUI_TEST_RESOURCES
  longarm::widgets::initResources();
#endif
  qInstallMessageHandler(onQtMessage);
  return RUN_ALL_TESTS();
}
