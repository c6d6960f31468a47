#include "ui/console.h"

#include <clocale>
#include <cstdio>
#include <memory>

#include <QLocale>
#include <QSettings>
#include <QSurfaceFormat>
#include <QTemporaryDir>
#include <QTimer>
#include <QVTKOpenGLNativeWidget.h>  // vtkGUISupportQt

#include "ui/console_application.h"
#include "ui/demonstration.h"
#include "ui/main_window.h"
#include "widgets/resources.h"

namespace longarm::ui {

namespace {

void prepareQt() {
  QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
  QCoreApplication::setAttribute(Qt::AA_ShareOpenGLContexts);
  QCoreApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
  QCoreApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
  QCoreApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
  QGuiApplication::setHighDpiScaleFactorRoundingPolicy(Qt::HighDpiScaleFactorRoundingPolicy::PassThrough);
}

// Qt ends the program without a display, before anybody can catch it.
bool hasDisplay() {
  const QByteArray platform = qgetenv("QT_QPA_PLATFORM");
  if (!platform.isEmpty() && !platform.startsWith("xcb") && !platform.startsWith("wayland")) return true;
  return !qEnvironmentVariableIsEmpty("DISPLAY") || !qEnvironmentVariableIsEmpty("WAYLAND_DISPLAY");
}

// QApplication sets the locale of the environment; numbers in files and fields have a point in every country.
void pinLocale() {
  std::setlocale(LC_NUMERIC, "C");
  QLocale::setDefault(QLocale::c());
}

RobotChoice choiceOf(const ConsoleOptions& options) {
  RobotChoice choice;
  choice.workcell = QString::fromStdString(options.workcell);
  choice.variant = QString::fromStdString(options.variant);
  choice.scenario = QString::fromStdString(options.scenario);
  return choice;
}

/// Where a run remembers things: the user's own place, or, for a demonstration, a folder that goes away with it.
struct Memory {
  QTemporaryDir folder;
  std::unique_ptr<QSettings> settings;
  QString autosave;
};

void prepareMemory(Memory& memory, bool perform) {
  if (!perform) {
    memory.settings = std::make_unique<QSettings>();
    return;
  }
  memory.settings = std::make_unique<QSettings>(memory.folder.filePath(QStringLiteral("settings.ini")), QSettings::IniFormat);
  memory.autosave = memory.folder.filePath(QStringLiteral("autosave"));
}

// Ends the event loop with the status of the program.
void perform(MainWindow& window, const ConsoleOptions& options) {
  DemonstrationOptions demonstration;
  demonstration.folder = QString::fromStdString(options.screenshots);
  demonstration.scenario = QString::fromStdString(options.scenario);
  Demonstration show(window, demonstration);
  const Status done = show.run();
  if (done) {
    std::printf("longarm: the gripper holds the pipe; %d pictures in %s\n", show.picturesTaken(), options.screenshots.c_str());
  } else {
    std::fprintf(stderr, "longarm: the demonstration failed: %s\n", done.error().message.c_str());
  }
  QCoreApplication::exit(done ? 0 : 4);
}

int runWindow(ConsoleApplication& application, const ConsoleOptions& options) {
  Memory memory;
  prepareMemory(memory, options.perform);
  QSettings& settings = *memory.settings;
  const QString theme = options.theme.empty() ? settings.value(QStringLiteral("theme"), QStringLiteral("dark")).toString()
                                              : QString::fromStdString(options.theme);
  Appearance appearance(theme);
  Workbench bench(memory.autosave);
  MainWindow window(bench, appearance, settings);
  QObject::connect(&application, &ConsoleApplication::caught, &bench, &Workbench::said);
  if (!options.reset_layout) window.layout().restore();
  if (options.perform) window.resize(1920, 1080);
  window.offerRecovery();
  window.show();
  // The window first: what comes next may take seconds.
  QTimer::singleShot(0, &window, [&bench, &options] { bench.openRobot(choiceOf(options)); });
  if (!options.views.empty()) {
    QTimer::singleShot(0, &window, [&bench, &options] { bench.snapshots().openViews(QString::fromStdString(options.views)); });
  }
  if (options.perform) QTimer::singleShot(0, &window, [&window, &options] { perform(window, options); });
  return application.exec();
}

}  // namespace

int runConsole(int& argc, char** argv, const ConsoleOptions& options) {
  if (!hasDisplay()) {
    std::fprintf(stderr, "longarm: there is no display (DISPLAY is not set); use a verb (longarm --help), or xvfb-run -a longarm\n");
    return 2;
  }
  prepareQt();
  ConsoleApplication application(argc, argv);
  pinLocale();
  QCoreApplication::setOrganizationName(QStringLiteral("Longarm"));
  QCoreApplication::setApplicationName(QStringLiteral("longarm"));
  QCoreApplication::setApplicationVersion(QStringLiteral(LONGARM_VERSION));
  widgets::initResources();
  return runWindow(application, options);
}

}  // namespace longarm::ui
