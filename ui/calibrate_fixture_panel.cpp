#include "ui/calibrate_fixture_panel.h"

#include <cmath>

#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>

#include "ui/calibrate_parts.h"

namespace longarm::ui {

using vision::OverlayRole;

namespace {

constexpr double kArrow = 40;              // Misses are drawn so many times their size.
constexpr double kPickRadius = 10;         // [screen px]
constexpr int kColumnWidth = 350, kLeastTable = 90;

}  // namespace

CalibrateFixturePanel::CalibrateFixturePanel(Workbench& bench, Appearance& appearance, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* row = pageRow(this);
  row->addWidget(buildPicture(appearance), 1);
  row->addWidget(buildSide(appearance));
  bind();
  refresh();
}

QWidget* CalibrateFixturePanel::buildPicture(Appearance& appearance) {
  const auto [frame, column, row, canvas] = pictureFrame(appearance, this);
  m_canvas = canvas;
  m_open_fixture = new QPushButton(tr("Open fixture..."), frame);
  m_open_fixture->setToolTip(tr("Where the points are: CSV with x,y,z in metres, or YAML with points or a sliding panel"));
  m_open_picture = new QPushButton(tr("Open picture..."), frame);
  m_camera = new QComboBox(frame);
  m_camera->setToolTip(tr("The camera that takes, or took, the picture"));
  m_take = new QPushButton(tr("Use live picture"), frame);
  for (QWidget* each : {static_cast<QWidget*>(m_open_fixture), static_cast<QWidget*>(m_open_picture), static_cast<QWidget*>(m_camera), static_cast<QWidget*>(m_take)}) row->addWidget(each);
  row->addStretch(1);
  m_hint = wordLabel(frame, true);
  column->addWidget(m_hint);
  return frame;
}

QWidget* CalibrateFixturePanel::buildSide(Appearance& appearance) {
  const auto [side, column] = framedColumn(this, kColumnWidth);
  m_fixture = new FixturePicture(appearance, side);
  column->addWidget(m_fixture, 1);
  m_points = plainTable({tr("Point"), tr("x y z m"), tr("Miss px"), tr("Placed")}, side);
  m_points->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Ignored);       // a long answer below takes of it
  m_points->setMinimumHeight(kLeastTable);
  column->addWidget(m_points, 1);
  auto* row = new QHBoxLayout;
  m_match = new QPushButton(tr("Match the rest"), side);
  m_remove = new QPushButton(tr("Take back"), side);
  m_clear = new QPushButton(tr("Clear"), side);
  for (auto* each : {m_match, m_remove, m_clear}) row->addWidget(each);
  column->addLayout(row);
  m_distortion = new QComboBox(side);
  for (const auto& [text, value] : {std::pair{tr("distortion as far as it shows"), -1}, {tr("no distortion"), 0}, {QStringLiteral("k1 k2"), 2}, {QStringLiteral("k1 k2 p1 p2"), 4}}) {
    m_distortion->addItem(text, value);
  }
  column->addWidget(m_distortion);
  m_result = wordLabel(side);
  m_result->setMinimumHeight(92);
  column->addWidget(m_result);
  auto* last = new QHBoxLayout;
  m_save = new QPushButton(tr("Save..."), side);
  m_apply = holdButton(tr("Hold to use this lens"), appearance, side);
  last->addWidget(m_save);
  last->addWidget(m_apply, 1);
  column->addLayout(last);
  return side;
}

void CalibrateFixturePanel::bind() {
  connect(m_open_fixture, &QPushButton::clicked, this, [this] {
    askForFiles(this, tr("Fixture file"), {tr("Fixtures (*.csv *.yaml *.yml)"), tr("All files (*)")}, false,
                [this](const QStringList& files) { model().openFixture(files.front()); });
  });
  connect(m_open_picture, &QPushButton::clicked, this, [this] {
    askForFiles(this, tr("Picture of the fixture"), {tr("Pictures (*.png *.jpg *.jpeg *.bmp *.tif *.tiff *.pgm *.ppm)"), tr("All files (*)")}, false,
                [this](const QStringList& files) { model().openPicture(files.front()); });
  });
  connect(m_camera, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] {
    m_bench.live().setWatched({m_camera->currentData().toString()});
    refreshTarget();
  });
  connect(m_take, &QPushButton::clicked, this, [this] {
    const QString camera = m_camera->currentData().toString();
    model().setPicture(m_bench.live().picture(camera).clone(), camera);
  });
  connect(m_canvas, &widgets::ImageCanvas::pointer, this, [this](const vision::PointerEvent& event) {
    if (event.left && event.phase == vision::PointerPhase::kPress) model().click(event.pixel, event.imageTolerance(kPickRadius));
  });
  connect(m_fixture, &FixturePicture::chosen, &model(), &session::FixtureController::setPoint);
  connect(m_points, &QTableWidget::itemSelectionChanged, this, [this] {
    if (!m_filling) model().setPoint(m_points->currentRow());
  });
  connect(m_match, &QPushButton::clicked, &model(), &session::FixtureController::matchRest);
  connect(m_clear, &QPushButton::clicked, &model(), &session::FixtureController::clearMatches);
  connect(m_remove, &QPushButton::clicked, this, [this] {
    const auto& matches = model().matches();
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (static_cast<int>(matches[i].point) == m_points->currentRow()) return model().removeMatch(i);
    }
    if (!matches.empty()) model().removeMatch(matches.size() - 1);
  });
  connect(m_distortion, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] {
    const int count = m_distortion->currentData().toInt();
    model().setDistortion(count < 0 ? std::nullopt : std::optional<int>(count));
  });
  connect(m_save, &QPushButton::clicked, this, [this] {
    const QString camera = m_camera->currentData().toString();
    askWhereToSave(this, tr("Save the camera"), (camera.isEmpty() ? QStringLiteral("camera") : camera) + QStringLiteral(".yaml"),
                   {tr("ROS camera file (*.yaml)"), tr("OpenCV YAML (*.yml)"), tr("OpenCV XML (*.xml)")},
                   [this, camera](const QString& file) { model().save(camera, file); });
  });
  connect(m_apply, &widgets::HoldButton::held, this, [this] {
    if (!m_apply->isEnabled()) return;
    const Status applied = m_bench.calibration().apply(model().change(m_camera->currentData().toString().toStdString()));
    if (!applied) m_bench.say(QString::fromStdString(applied.error().message));
  });
  connect(&model(), &session::FixtureController::changed, this, &CalibrateFixturePanel::refresh);
  connect(&model(), &session::FixtureController::fixtureChanged, this, [this] { m_fixture->setFixture(*model().fixture()); });
  connect(&model(), &session::FixtureController::saved, this, [this](const QString& file) { m_bench.say(tr("Camera saved to %1").arg(file)); });
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, &CalibrateFixturePanel::refreshTarget);
  connect(&m_bench.live(), &LivePictures::pictureArrived, this, [this] {
    if (isVisible()) refreshTarget();
  });
}

QString CalibrateFixturePanel::result() const { return m_result->text(); }

void CalibrateFixturePanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  fillCameras(m_camera, m_bench.document().workcell().get());
  m_bench.live().setWatched({m_camera->currentData().toString()});
  refresh();
}

void CalibrateFixturePanel::hideEvent(QHideEvent* event) {
  m_bench.live().setWatched({});
  QWidget::hideEvent(event);
}

void CalibrateFixturePanel::refreshPoints() {
  const auto& fixture = model().fixture();
  m_filling = true;
  m_points->setRowCount(fixture ? static_cast<int>(fixture->points.size()) : 0);
  for (int row = 0; row < m_points->rowCount(); ++row) {
    const auto& point = fixture->points[static_cast<std::size_t>(row)];
    setCell(m_points, row, 0, QString::fromStdString(point.name));
    setCell(m_points, row, 1, tr("%1 %2 %3").arg(point.xyz.x(), 0, 'f', 3).arg(point.xyz.y(), 0, 'f', 3).arg(point.xyz.z(), 0, 'f', 3));
    setCell(m_points, row, 2, QStringLiteral("-"));
    setCell(m_points, row, 3, QString());
  }
  std::set<std::size_t> placed;
  for (std::size_t i = 0; i < model().matches().size(); ++i) {
    const auto& match = model().matches()[i];
    const int row = static_cast<int>(match.point);
    placed.insert(match.point);
    setCell(m_points, row, 3, match.by_hand ? tr("by you") : tr("found"));
    if (!model().result()) continue;
    setCell(m_points, row, 2, QString::number(model().residual(i).norm(), 'f', 2));
    if (model().result()->left_out[i]) setCell(m_points, row, 3, tr("left out"));
  }
  if (model().point() >= 0) m_points->setCurrentCell(model().point(), 0);
  m_filling = false;
  m_fixture->setMarks(model().point(), placed);
}

void CalibrateFixturePanel::refreshOverlay() {
  vision::Overlay overlay;
  for (const auto& dot : model().dots()) addMarker(&overlay, OverlayRole::kDepthTick, dot.pixel);
  for (std::size_t i = 0; i < model().matches().size(); ++i) {
    const auto& match = model().matches()[i];
    addMarker(&overlay, match.by_hand ? OverlayRole::kHandle : OverlayRole::kActiveHandle, match.pixel);
    if (match.by_hand) addText(&overlay, OverlayRole::kLabel, match.pixel + Eigen::Vector2d(7, -5), model().fixture()->points[match.point].name);
    if (model().result()) addLine(&overlay, OverlayRole::kMiss, {match.pixel, match.pixel + kArrow * model().residual(i)});
  }
  m_canvas->setOverlay(overlay);
}

void CalibrateFixturePanel::refresh() {
  if (model().picture().empty()) {
    m_canvas->clearPicture(tr("No picture.\n\nOpen one of the fixture, or take a live one."));
    m_hint->setText({});
  } else {
    m_canvas->setPicture(model().picture());
    const int point = model().point();
    m_hint->setText(point >= 0 && model().fixture() ? tr("Click point %1; a click near a dot takes its centre. %2 dots were found; misses are drawn %3-fold.")
                                                           .arg(QString::fromStdString(model().fixture()->points[static_cast<std::size_t>(point)].name)).arg(model().dots().size()).arg(kArrow)
                                                     : tr("%1 dots were found.").arg(model().dots().size()));
  }
  refreshPoints();
  refreshOverlay();
  QStringList lines;
  if (const auto& result = model().result()) {
    const auto values = calibration::lensVector(result->camera);
    QStringList numbers;
    for (const int i : result->estimated.indices()) {
      const int decimals = i < calibration::kK1 ? 2 : 5;
      numbers << tr("%1 %2\u00b1%3").arg(QString::fromLatin1(calibration::lensParameterName(i)), QString::number(values[i], 'f', decimals),
                                        QString::number(std::sqrt(std::max(0.0, result->covariance(i, i))), 'f', decimals));
    }
    lines << numbers.join(QStringLiteral(", "));
    const auto& at = result->X_WC.translation();
    lines << tr("Camera at %1 %2 %3 m in the fixture.").arg(at.x(), 0, 'f', 4).arg(at.y(), 0, 'f', 4).arg(at.z(), 0, 'f', 4);
    lines << tr("rms %1 px (linear %2 px), condition %3.").arg(result->rms_px, 0, 'f', 3).arg(result->dlt_rms_px, 0, 'f', 3).arg(result->linear.condition, 0, 'f', 1);
    for (const auto& warning : result->warnings) lines << QString::fromStdString(warning);
  } else {
    lines << model().why();
  }
  m_result->setText(lines.join(QLatin1Char('\n')));
  setWhyNot(m_match, model().whyNotMatch(), tr("Find the points not clicked, where the camera from your clicks predicts them"));
  const QString none = model().matches().empty() ? tr("nothing is placed.") : QString();
  setWhyNot(m_remove, none, tr("Take back the place of the chosen point, or the newest"));
  setWhyNot(m_clear, none, tr("Take back every place"));
  refreshTarget();
}

void CalibrateFixturePanel::refreshTarget() {
  const QString camera = m_camera->currentData().toString();
  setWhyNot(m_take, m_bench.live().picture(camera).empty() ? tr("this camera has given no picture yet.") : QString(), tr("Take the newest live picture of the camera"));
  const QString none = model().result() ? QString() : model().why();
  setWhyNot(m_save, none, tr("Write a camera file with the camera's pose in the fixture's frame"));
  QString why = none.isEmpty() ? m_bench.whyNotCalibrate() : none;
  if (why.isEmpty()) {
    const auto file = m_bench.calibration().changed(model().change(camera.toStdString()));
    if (!file) why = QString::fromStdString(file.error().message);
  }
  const QString worse = why.isEmpty() ? m_bench.calibration().whyWorse(model().change(camera.toStdString())) : QString();
  setWhyNot(m_apply, why, worse.isEmpty() ? tr("Keep the lens in the library and use it for this camera; its mount stays as it is") : worse);
}

}  // namespace longarm::ui
