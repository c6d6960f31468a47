#pragma once

/// @file
/// The Qt application of the benchmarks that draw.

#include <cstdlib>

#include <QApplication>
#include <QSurfaceFormat>
#include <QVTKOpenGLNativeWidget.h>          // vtkGUISupportQt

namespace longarm::benchmarks {

inline bool hasDisplay() { return std::getenv("DISPLAY") != nullptr; }

/// One application for all; without a display Qt draws into memory.
inline void ensureApplication() {
  if (QCoreApplication::instance() != nullptr) return;
  if (!hasDisplay()) qputenv("QT_QPA_PLATFORM", "offscreen");
  QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
  static int argc = 1;
  static char name[] = "longarm_benchmarks";
  static char* argv[] = {name, nullptr};
  new QApplication(argc, argv);      // lives as long as the process
}

}  // namespace longarm::benchmarks
