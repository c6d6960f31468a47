#include "ui/calibrate_lens_panel.h"

#include <cmath>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSlider>
#include <QVBoxLayout>

#include "ui/calibrate_parts.h"

namespace longarm::ui {

using vision::OverlayRole;

namespace {

constexpr const char* kNames[4] = {"k1", "k2", "p1", "p2"};
constexpr double kRange[4] = {0.8, 0.8, 0.05, 0.05};
constexpr int kSteps = 1000;               // of a slider, either way
constexpr int kColumnWidth = 340;

}  // namespace

CalibrateLensPanel::CalibrateLensPanel(Workbench& bench, Appearance& appearance, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* row = pageRow(this);
  row->addWidget(buildPicture(appearance), 1);
  row->addWidget(buildSide(appearance));
  bind();
  refresh();
}

QWidget* CalibrateLensPanel::buildPicture(Appearance& appearance) {
  const auto [frame, column, row, canvas] = pictureFrame(appearance, this);
  m_canvas = canvas;
  m_camera = new QComboBox(frame);
  m_take = new QPushButton(tr("Use live picture"), frame);
  m_open = new QPushButton(tr("Open picture..."), frame);
  m_follow = new QCheckBox(tr("follow live"), frame);
  m_follow->setToolTip(tr("Show every live picture of the camera, straightened as the sliders stand"));
  m_straightened = new QCheckBox(tr("straightened"), frame);
  m_straightened->setToolTip(tr("Show the picture without this distortion; guides keep their places"));
  m_straightened->setChecked(true);
  for (QWidget* each : {static_cast<QWidget*>(m_camera), static_cast<QWidget*>(m_take), static_cast<QWidget*>(m_open)}) row->addWidget(each);
  row->addStretch(1);
  row->addWidget(m_follow);
  row->addWidget(m_straightened);
  m_hint = wordLabel(frame, true);
  column->addWidget(m_hint);
  return frame;
}

QWidget* CalibrateLensPanel::buildSide(Appearance& appearance) {
  const auto [side, column] = framedColumn(this, kColumnWidth);
  auto* grid = new QGridLayout;
  for (int i = 0; i < 4; ++i) {
    const auto at = static_cast<std::size_t>(i);
    m_sliders[at] = new QSlider(Qt::Horizontal, side);
    m_sliders[at]->setRange(-kSteps, kSteps);
    m_values[at] = new QDoubleSpinBox(side);
    m_values[at]->setRange(-10, 10);
    m_values[at]->setDecimals(5);
    m_values[at]->setSingleStep(kRange[i] / 100);
    grid->addWidget(new QLabel(QString::fromLatin1(kNames[i]), side), i, 0);
    grid->addWidget(m_sliders[at], i, 1);
    grid->addWidget(m_values[at], i, 2);
  }
  column->addLayout(grid);
  auto* row = new QHBoxLayout;
  m_zero = new QPushButton(tr("No distortion"), side);
  m_reset = new QPushButton(tr("As in use"), side);
  row->addWidget(m_zero);
  row->addWidget(m_reset);
  row->addStretch(1);
  column->addLayout(row);
  column->addSpacing(10);
  auto* guides = new QHBoxLayout;
  m_new_guide = new QPushButton(tr("Next guide"), side);
  m_remove = new QPushButton(tr("Remove guide"), side);
  guides->addWidget(m_new_guide);
  guides->addWidget(m_remove);
  guides->addStretch(1);
  column->addLayout(guides);
  auto* solve = new QHBoxLayout;
  m_coefficients = new QComboBox(side);
  m_coefficients->addItem(QStringLiteral("k1"), 1);
  m_coefficients->addItem(QStringLiteral("k1 k2"), 2);
  m_coefficients->addItem(QStringLiteral("k1 k2 p1 p2"), 4);
  m_coefficients->setCurrentIndex(1);
  m_solve = new QPushButton(tr("Straighten the guides"), side);
  solve->addWidget(m_coefficients);
  solve->addWidget(m_solve, 1);
  column->addLayout(solve);
  m_result = wordLabel(side);
  column->addWidget(m_result, 1);
  m_apply = holdButton(tr("Hold to use"), appearance, side);
  column->addWidget(m_apply);
  return side;
}

void CalibrateLensPanel::bind() {
  connect(m_camera, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] {
    model().setCamera(m_camera->currentData().toString());
    m_bench.live().setWatched({m_camera->currentData().toString()});
  });
  connect(m_take, &QPushButton::clicked, this, [this] { model().setPicture(m_bench.live().picture(m_camera->currentData().toString()).clone()); });
  connect(m_open, &QPushButton::clicked, this, [this] {
    askForFiles(this, tr("A picture with straight edges"), {tr("Pictures (*.png *.jpg *.jpeg *.bmp *.tif *.tiff *.pgm *.ppm)"), tr("All files (*)")}, false,
                [this](const QStringList& files) { model().openFile(files.front()); });
  });
  for (int i = 0; i < 4; ++i) {
    const auto at = static_cast<std::size_t>(i);
    connect(m_sliders[at], &QSlider::valueChanged, this, [this, i](int value) {
      if (!m_filling) model().setCoefficient(i, kRange[i] * value / kSteps);
    });
    connect(m_values[at], qOverload<double>(&QDoubleSpinBox::valueChanged), this, [this, i](double value) {
      if (!m_filling) model().setCoefficient(i, value);
    });
  }
  connect(m_zero, &QPushButton::clicked, &model(), &session::LensController::straightenNothing);
  connect(m_reset, &QPushButton::clicked, &model(), &session::LensController::reset);
  connect(m_new_guide, &QPushButton::clicked, &model(), &session::LensController::endGuide);
  connect(m_remove, &QPushButton::clicked, &model(), &session::LensController::removeGuide);
  connect(m_solve, &QPushButton::clicked, this, [this] { model().solve(m_coefficients->currentData().toInt()); });
  connect(m_straightened, &QCheckBox::toggled, m_canvas, &widgets::ImageCanvas::setUndistorted);
  connect(m_canvas, &widgets::ImageCanvas::pointer, this, &CalibrateLensPanel::onPointer);
  connect(m_apply, &widgets::HoldButton::held, this, [this] {
    if (!m_apply->isEnabled()) return;
    const Status applied = m_bench.calibration().apply(model().change());
    if (!applied) m_bench.say(QString::fromStdString(applied.error().message));
    else model().setCamera(m_camera->currentData().toString());
  });
  connect(&model(), &session::LensController::changed, this, &CalibrateLensPanel::refresh);
  connect(&m_bench.live(), &LivePictures::pictureArrived, this, [this](const QString& camera) {
    if (!isVisible() || camera != m_camera->currentData().toString()) return;
    if (m_follow->isChecked()) model().setPicture(m_bench.live().picture(camera).clone());
    refreshTarget();
  });
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, &CalibrateLensPanel::refreshTarget);
  m_canvas->setUndistorted(true);
}

void CalibrateLensPanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  fillCameras(m_camera, m_bench.document().workcell().get());
  const QString camera = m_camera->currentData().toString();
  if (camera.toStdString() != model().camera()) model().setCamera(camera);
  m_bench.live().setWatched({camera});
  refresh();
}

void CalibrateLensPanel::hideEvent(QHideEvent* event) {
  m_bench.live().setWatched({});
  QWidget::hideEvent(event);
}

void CalibrateLensPanel::onPointer(const vision::PointerEvent& event) {
  if (!event.left) return;
  if (event.phase == vision::PointerPhase::kPress) model().addPoint(event.pixel);
  if (event.phase == vision::PointerPhase::kDoubleClick) model().endGuide();
}

void CalibrateLensPanel::refresh() {
  m_filling = true;
  for (int i = 0; i < 4; ++i) {
    const double value = model().lens().distortion[static_cast<std::size_t>(i)];
    m_sliders[static_cast<std::size_t>(i)]->setValue(static_cast<int>(std::lround(kSteps * value / kRange[i])));
    m_values[static_cast<std::size_t>(i)]->setValue(value);
  }
  m_filling = false;
  if (model().picture().empty()) {
    m_canvas->clearPicture(tr("No picture.\n\nTake a live one, or open a file, that shows edges which are straight in the world."));
    m_hint->setText({});
  } else {
    m_canvas->setCamera(model().lens());
    m_canvas->setPicture(model().picture());
    m_hint->setText(tr("Click along an edge that is straight in the world, three points or more; double-click or Next guide begins another."));
  }
  vision::Overlay overlay;
  const auto& guides = model().guides();
  for (std::size_t i = 0; i < guides.size(); ++i) {
    const bool newest = i + 1 == guides.size();
    addLine(&overlay, newest ? OverlayRole::kSelected : OverlayRole::kSketch, guides[i]);
    for (const auto& p : guides[i]) addMarker(&overlay, OverlayRole::kDepthTick, p);
  }
  m_canvas->setOverlay(overlay);
  const auto straight = model().straightness();
  QStringList lines;
  if (straight) lines << tr("The guides bend by %1 px rms with this lens.").arg(*straight, 0, 'f', 2);
  if (const auto& result = model().result()) {
    lines << tr("Solved from %1 guides: %2 px rms before, %3 px after.").arg(result->line_rms_px.size()).arg(result->rms_before_px, 0, 'f', 2).arg(result->rms_px, 0, 'f', 2);
    for (int i = 0; i < result->coefficients; ++i) {
      lines << tr("%1 = %2 \u00b1 %3").arg(QString::fromLatin1(kNames[i]), QString::number(result->camera.distortion[static_cast<std::size_t>(i)], 'f', 5),
                                          QString::number(std::sqrt(result->covariance(calibration::kK1 + i, calibration::kK1 + i)), 'f', 5));
    }
    for (const auto& warning : result->warnings) lines << QString::fromStdString(warning);
  }
  m_result->setText(lines.join(QLatin1Char('\n')));
  setWhyNot(m_solve, model().whyNotSolve(), tr("Find the distortion that makes the guides straight"));
  setWhyNot(m_remove, guides.empty() ? tr("there is none.") : QString(), tr("Remove the newest guide"));
  setWhyNot(m_new_guide, guides.empty() ? tr("there is none yet: click along an edge.") : QString(), tr("The next click begins another guide"));
  refreshTarget();
}

void CalibrateLensPanel::refreshTarget() {
  const bool live = !m_bench.live().picture(m_camera->currentData().toString()).empty();
  setWhyNot(m_take, live ? QString() : tr("this camera has given no picture yet."), tr("Take the newest live picture of the camera"));
  QString why = model().whyNotApply();
  if (why.isEmpty()) why = m_bench.whyNotCalibrate();
  setWhyNot(m_apply, why, tr("Keep it in the library and use it for this camera from now on; focal lengths stay"));
}

}  // namespace longarm::ui
