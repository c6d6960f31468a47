#pragma once

/// @file
/// A whole window whose settings and autosave live in a folder of their own, with or without a robot.

#include <memory>

#include <QScreen>
#include <QSettings>
#include <QTemporaryDir>
#include <gtest/gtest.h>

#include "ui/main_window.h"
#include "ui/simulated_hand.h"

namespace longarm::tests {

class WindowFixture : public ::testing::Test {
 protected:
  void openWindow(const QString& theme = QStringLiteral("dark"), const QSize& size = {1280, 800}) {
    settings = std::make_unique<QSettings>(folder.filePath(QStringLiteral("settings.ini")), QSettings::IniFormat);
    appearance = std::make_unique<ui::Appearance>(theme);
    bench = std::make_unique<ui::Workbench>(folder.filePath(QStringLiteral("autosave")));
    window = std::make_unique<ui::MainWindow>(*bench, *appearance, *settings);
    window->resize(size);
    window->show();
    ui::SimulatedHand::pump(50);
  }
  void TearDown() override {
    if (window) window->close();
    window.reset();
    bench.reset();
  }

  /// Files named by LONGARM_UI_PICTURES, for looking at the window.
  void look(const QString& name) {
    const QString to = qEnvironmentVariable("LONGARM_UI_PICTURES");
    window->scene()->view()->requestRender();
    ui::SimulatedHand::pump(400);
    if (!to.isEmpty()) window->screen()->grabWindow(window->winId()).save(to + QLatin1Char('/') + name + QStringLiteral(".png"));
  }

  QTemporaryDir folder;
  std::unique_ptr<QSettings> settings;
  std::unique_ptr<ui::Appearance> appearance;
  std::unique_ptr<ui::Workbench> bench;
  std::unique_ptr<ui::MainWindow> window;
  ui::SimulatedHand hand;
};

}  // namespace longarm::tests
