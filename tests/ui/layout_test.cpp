// The layout is remembered, and a bad one is forgotten.
#include <QDockWidget>
#include <QFile>
#include <QSettings>
#include <QSplitter>
#include <QTemporaryDir>
#include <QTest>
#include <gtest/gtest.h>

#include "ui/window_layout.h"

namespace longarm::ui {
namespace {

struct Rig {
  QSettings& settings;
  QMainWindow window;
  QSplitter* splitter = new QSplitter;
  QDockWidget* dock = new QDockWidget(QStringLiteral("Features"), &window);
  std::unique_ptr<WindowLayout> layout;

  explicit Rig(QSettings& kept) : settings(kept) {
    splitter->setObjectName(QStringLiteral("middle"));
    splitter->addWidget(new QWidget);
    splitter->addWidget(new QWidget);
    window.setCentralWidget(splitter);
    dock->setObjectName(QStringLiteral("features"));
    dock->setWidget(new QWidget);
    window.addDockWidget(Qt::BottomDockWidgetArea, dock);
    window.resize(800, 600);
    layout = std::make_unique<WindowLayout>(window, window, std::vector<QSplitter*>{splitter}, settings);
    window.show();
  }
};

class Layout : public ::testing::Test {
 protected:
  QTemporaryDir folder;
  QSettings settings{folder.filePath(QStringLiteral("s.ini")), QSettings::IniFormat};
};

TEST_F(Layout, ComesBackAsItWasLeft) {
  {
    Rig rig(settings);
    rig.window.addDockWidget(Qt::LeftDockWidgetArea, rig.dock);
    rig.layout->save();
  }
  Rig rig(settings);
  EXPECT_TRUE(rig.layout->restore());
  EXPECT_EQ(rig.window.dockWidgetArea(rig.dock), Qt::LeftDockWidgetArea);
  rig.layout->reset();
  EXPECT_EQ(rig.window.dockWidgetArea(rig.dock), Qt::BottomDockWidgetArea);
}

TEST_F(Layout, BringsBackAClosedOrTornOffPanelOnReset) {
  Rig rig(settings);
  rig.dock->setFloating(true);
  rig.dock->close();
  rig.layout->reset();
  EXPECT_TRUE(rig.dock->isVisible());
  EXPECT_FALSE(rig.dock->isFloating());
}

TEST_F(Layout, IsTheFactorysWhenDamagedOrOfAnotherSchema) {
  {
    Rig rig(settings);
    rig.window.addDockWidget(Qt::LeftDockWidgetArea, rig.dock);
    rig.layout->save();
  }
  const auto refused = [this](const QString& key, const QVariant& value) {
    const QVariant kept = settings.value(key);
    settings.setValue(key, value);
    Rig rig(settings);
    EXPECT_FALSE(rig.layout->restore()) << key.toStdString();
    EXPECT_EQ(rig.window.dockWidgetArea(rig.dock), Qt::BottomDockWidgetArea) << key.toStdString();
    settings.setValue(key, kept);
  };
  refused(QStringLiteral("layout/schema"), WindowLayout::kSchema + 1);
  refused(QStringLiteral("layout/docks"), QByteArray("damaged"));
  refused(QStringLiteral("layout/geometry"), QByteArray(40, 'x'));
  refused(QStringLiteral("layout/docks"), QByteArray());
}

}  // namespace
}  // namespace longarm::ui
