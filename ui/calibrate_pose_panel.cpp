#include "ui/calibrate_pose_panel.h"

#include <cmath>

#include <QCheckBox>
#include <QComboBox>
#include <QDateTime>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QSplitter>
#include <QTabWidget>
#include <QTableWidget>
#include <QVBoxLayout>

#include "ui/calibrate_parts.h"

namespace longarm::ui {

using session::PoseController;
using vision::PaneSide;

namespace {

constexpr double kRadPerDeg = 0.017453292519943295;
constexpr double kPickRadius = 12;         // [screen px]
constexpr int kColumnWidth = 340, kLeastList = 70;
constexpr double kMark_m = 0.007;

}  // namespace

CalibratePosePanel::CalibratePosePanel(Workbench& bench, Appearance& appearance, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_appearance(appearance) {
  auto* row = pageRow(this);
  m_views = new QSplitter(Qt::Horizontal, this);
  m_views->setChildrenCollapsible(false);
  m_views->addWidget(buildPicture(appearance));
  row->addWidget(m_views, 1);
  const auto [side, column] = framedColumn(this, kColumnWidth);
  m_steps = new QTabWidget(side);
  m_steps->addTab(buildWhatStep(), tr("1 Known things"));
  m_steps->addTab(buildPointsStep(), tr("2 Points"));
  column->addWidget(m_steps, 1);
  column->addWidget(buildAnswer(appearance));
  row->addWidget(side);
  bind();
  refresh();
}

CalibratePosePanel::~CalibratePosePanel() {
  m_marks.reset();
  m_contents.reset();
}

QWidget* CalibratePosePanel::buildPicture(Appearance& appearance) {
  const auto [frame, column, row, canvas] = pictureFrame(appearance, this);
  m_canvas = canvas;
  m_snapshot = new QComboBox(frame);
  m_snapshot->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  m_snapshot->setToolTip(tr("Which picture is shown; every one may hold points"));
  m_take = new QPushButton(tr("Take picture"), frame);
  row->addWidget(m_snapshot, 1);
  row->addWidget(m_take);
  m_hint = wordLabel(frame, true);
  column->addWidget(m_hint);
  return frame;
}

QWidget* CalibratePosePanel::buildWhatStep() {
  auto* page = new QWidget(this);
  auto* column = new QVBoxLayout(page);
  auto* form = new QFormLayout;
  m_camera = new QComboBox(page);
  m_unknown = new QComboBox(page);
  m_unknown->addItem(tr("the camera on its mount (T_ext)"), static_cast<int>(PoseController::Unknown::kExt));
  m_unknown->addItem(tr("the pan-tilt's foot (T_dev)"), static_cast<int>(PoseController::Unknown::kDev));
  m_unknown->addItem(tr("an object (T_obj)"), static_cast<int>(PoseController::Unknown::kObj));
  m_camera_too = new QCheckBox(tr("nor how the camera is mounted"), page);
  m_object = new QComboBox(page);
  form->addRow(tr("Camera"), m_camera);
  form->addRow(tr("Not known is"), m_unknown);
  form->addRow(QString(), m_camera_too);
  form->addRow(tr("Object"), m_object);
  column->addLayout(form);
  column->addWidget(new QLabel(tr("Choose a corner, then click it in the picture:"), page));
  m_landmarks = new QListWidget(page);
  m_landmarks->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Ignored);    // a long answer below takes of it
  m_landmarks->setMinimumHeight(kLeastList);
  column->addWidget(m_landmarks, 1);
  column->addWidget(new QLabel(tr("Your own guess (turn in \u00b0, shift in mm):"), page));
  auto* grid = new QGridLayout;
  for (int i = 0; i < 6; ++i) {
    auto* box = m_guess[static_cast<std::size_t>(i)] = new QDoubleSpinBox(page);
    box->setRange(i < 3 ? -180 : -3000, i < 3 ? 180 : 3000);
    box->setDecimals(1);
    box->setSingleStep(i < 3 ? 0.5 : 5);
    box->setButtonSymbols(QAbstractSpinBox::UpDownArrows);
    box->setToolTip(i < 3 ? tr("Turn about axis %1").arg(QLatin1Char("xyz"[i])) : tr("Shift along axis %1").arg(QLatin1Char("xyz"[i - 3])));
    grid->addWidget(box, i / 3, i % 3);
  }
  column->addLayout(grid);
  return page;
}

QWidget* CalibratePosePanel::buildPointsStep() {
  auto* page = new QWidget(this);
  auto* column = new QVBoxLayout(page);
  m_points = plainTable({tr("Miss px"), tr("Without it"), tr("Weight %"), tr("Point")}, page);
  m_points->horizontalHeaderItem(0)->setToolTip(tr("Clicked against projected"));
  m_points->horizontalHeaderItem(1)->setToolTip(tr("The miss if this point had not been used"));
  m_points->horizontalHeaderItem(2)->setToolTip(tr("Leverage: 100 % decides something alone"));
  column->addWidget(m_points, 1);
  auto* row = new QHBoxLayout;
  m_remove = new QPushButton(tr("Remove point"), page);
  m_clear = new QPushButton(tr("Remove all"), page);
  row->addWidget(m_remove);
  row->addWidget(m_clear);
  row->addStretch(1);
  column->addLayout(row);
  return page;
}

QWidget* CalibratePosePanel::buildAnswer(Appearance& appearance) {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  m_result = wordLabel(box);
  m_result->setMinimumHeight(96);
  m_result->setTextInteractionFlags(Qt::TextSelectableByMouse);
  m_apply = holdButton(tr("Hold to use"), appearance, box);
  m_other = new QPushButton(tr("Another pose fits, too: show it"), box);
  column->addWidget(m_result);
  column->addWidget(m_other);
  column->addWidget(m_apply);
  return box;
}

void CalibratePosePanel::buildScene(Appearance& appearance) {
  m_scene = new widgets::SceneView(m_views);
  m_views->addWidget(m_scene);
  m_scene->setMinimumWidth(220);
  m_views->setSizes({600, 400});
  m_views->setStretchFactor(0, 3);
  m_views->setStretchFactor(1, 2);
  m_contents = std::make_unique<SceneContents>(m_scene->renderer());
  m_contents->setWorkcell(m_bench.document().workcell());
  m_marks = std::make_unique<scene::WorldRep>();
  m_marks->addTo(m_scene->renderer());
  const auto style = [this, &appearance] { m_scene->setTheme(appearance.theme()); };
  style();
  connect(&appearance, &Appearance::changed, this, style);
  connect(m_scene, &widgets::SceneView::clicked, this, &CalibratePosePanel::onScene);
  m_scene->showPreset(scene::CameraPreset::kIso);
}

void CalibratePosePanel::bind() {
  connect(m_camera, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] { model().setCamera(m_camera->currentData().toString()); });
  connect(m_unknown, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] {
    model().setUnknown(static_cast<PoseController::Unknown>(m_unknown->currentData().toInt()));
    for (auto* box : m_guess) {
      const QSignalBlocker quiet(box);
      box->setValue(0);
    }
  });
  connect(m_camera_too, &QCheckBox::toggled, this, [this](bool on) { model().setCameraToo(on); });
  connect(m_object, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] { model().setObject(m_object->currentText()); });
  connect(m_snapshot, qOverload<int>(&QComboBox::activated), this, [this](int index) {
    model().setSnapshot(SnapshotId{m_snapshot->itemData(index).toULongLong()});
  });
  connect(m_landmarks, &QListWidget::currentRowChanged, this, [this](int row) {
    if (!m_filling) model().setLandmark(row);
  });
  for (auto* box : m_guess) connect(box, qOverload<double>(&QDoubleSpinBox::valueChanged), this, &CalibratePosePanel::takeGuess);
  connect(m_take, &QPushButton::clicked, this, &CalibratePosePanel::take);
  connect(m_remove, &QPushButton::clicked, this, [this] {
    if (m_points->currentRow() >= 0) model().remove(static_cast<std::size_t>(m_points->currentRow()));
  });
  connect(m_clear, &QPushButton::clicked, this, [this] { model().clear(); });
  connect(m_other, &QPushButton::clicked, this, [this] {
    if (model().outcome() && !model().outcome()->result.alternatives.empty()) model().takeAlternative();
  });
  connect(m_apply, &widgets::HoldButton::held, this, &CalibratePosePanel::apply);
  connect(m_canvas, &widgets::ImageCanvas::pointer, this, &CalibratePosePanel::onPointer);
  connect(&model(), &PoseController::changed, this, &CalibratePosePanel::refresh);
  connect(&model(), &PoseController::landmarksChanged, this, &CalibratePosePanel::refreshLandmarks);
  connect(&model(), &PoseController::snapshotsChanged, this, &CalibratePosePanel::refreshSnapshots);
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, &CalibratePosePanel::refreshAnswer);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, &CalibratePosePanel::refreshAnswer);
  connect(&m_bench.snapshots(), &session::SnapshotController::stateChanged, this, &CalibratePosePanel::refreshAnswer);
}

QString CalibratePosePanel::result() const { return m_result->text(); }

void CalibratePosePanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  const auto& workcell = m_bench.document().workcell();
  fillCameras(m_camera, workcell.get());
  model().setCamera(m_camera->currentData().toString());
  {
    const QSignalBlocker quiet(m_object);
    const QString chosen = m_object->currentText();
    m_object->clear();
    if (workcell) {
      for (const auto& object : workcell->objects) m_object->addItem(QString::fromStdString(object.name));
    }
    m_object->setCurrentIndex(std::max(0, m_object->findText(chosen)));
  }
  model().setObject(m_object->currentText());
  if (m_scene == nullptr) buildScene(m_appearance);
  else m_contents->setWorkcell(workcell);
  refreshSnapshots();
  refreshLandmarks();
  refresh();
}

void CalibratePosePanel::takeGuess() {
  Vector6d increment;
  for (int i = 0; i < 6; ++i) increment[i] = m_guess[static_cast<std::size_t>(i)]->value() * (i < 3 ? kRadPerDeg : 1e-3);
  model().setGuess(increment);
}

QString CalibratePosePanel::whyNotTake() const {
  if (m_camera->currentData().toString().isEmpty()) return tr("no camera is chosen.");
  if (const QString why = m_bench.robot().whyNotReady(); !why.isEmpty()) return why;
  return m_bench.snapshots().whyNot();
}

void CalibratePosePanel::take() { m_bench.snapshots().take(m_camera->currentData().toString(), PaneSide::kLeft); }

void CalibratePosePanel::onPointer(const vision::PointerEvent& event) {
  if (!event.left || event.phase != vision::PointerPhase::kPress) return;
  // Control takes what is drawn under the pointer; a plain click says where the chosen point is.
  if (!event.modifiers.control) return model().pick(event.pixel);
  if (const Status stuck = model().stickAtPixel(event.pixel, event.imageTolerance(kPickRadius)); !stuck) m_bench.say(QString::fromStdString(stuck.error().message));
}

// A listed corner within reach of the click, else whatever surface is there.
void CalibratePosePanel::onScene(const QPointF& position) {
  if (const auto id = m_scene->pick(position, kPickRadius)) return model().setLandmark(static_cast<int>(*id) - 1);
  const auto sight = m_scene->sightAt(position);
  const Status stuck = model().stick(sight.from, sight.along, kPickRadius * sight.radians_per_pixel);
  if (!stuck) m_bench.say(QString::fromStdString(stuck.error().message));
}

void CalibratePosePanel::refreshSnapshots() {
  const QSignalBlocker quiet(m_snapshot);
  m_snapshot->clear();
  for (const auto& snapshot : model().snapshots()) {
    const QString time = QDateTime::fromMSecsSinceEpoch(static_cast<qint64>(snapshot->wall_time_s * 1000)).toString(QStringLiteral("HH:mm:ss"));
    m_snapshot->addItem(QString::fromStdString(snapshot->view.name) + QStringLiteral("  ") + time, QVariant::fromValue<qulonglong>(snapshot->id.value));
  }
  const auto shown = model().snapshot();
  m_snapshot->setCurrentIndex(shown ? m_snapshot->findData(QVariant::fromValue<qulonglong>(shown->id.value)) : -1);
  m_snapshot->setEnabled(m_snapshot->count() > 0);
}

void CalibratePosePanel::refreshLandmarks() {
  m_filling = true;
  m_landmarks->clear();
  for (const auto& mark : model().landmarks()) m_landmarks->addItem(QString::fromStdString(mark.name));
  m_landmarks->setCurrentRow(model().landmark());
  m_filling = false;
}

void CalibratePosePanel::refresh() {
  m_filling = true;
  m_landmarks->setCurrentRow(model().landmark());
  m_filling = false;
  setWhyNot(m_object, model().unknown() == PoseController::Unknown::kObj ? QString() : tr("only an object's place needs it."), tr("Which object of the workcell"));
  setWhyNot(m_camera_too, model().unknown() == PoseController::Unknown::kExt ? tr("it is what is found already.") : QString(),
            tr("Both are found together (hand-eye): click the same things in pictures at three or more angles of the pan-tilt, or poses of the arm, turned about two axes"));
  const auto shown = model().snapshot();
  if (shown) {
    m_canvas->setCamera(shown->view.camera);
    m_canvas->setPicture(shown->image);
    m_canvas->setOverlay(model().overlay());
    const int chosen = model().landmark();
    m_hint->setText(chosen >= 0 ? tr("Click %1 in the picture. Another: click any corner, edge or surface in the scene, or its drawing here with Ctrl.")
                                      .arg(QString::fromStdString(model().landmarks()[static_cast<std::size_t>(chosen)].name))
                                : tr("Choose a corner in the list; or click any corner, edge or surface in the scene, or its drawing here with Ctrl."));
  } else {
    m_canvas->clearPicture(tr("No picture of this camera yet.\n\n%1").arg(whyNotTake().isEmpty() ? tr("Take one.") : whyNotTake()));
    m_hint->setText({});
  }
  refreshPoints();
  refreshAnswer();
  refreshScene();
}

void CalibratePosePanel::refreshPoints() {
  const auto& picks = model().picks();
  const auto& outcome = model().outcome();
  m_points->setRowCount(static_cast<int>(picks.size()));
  for (int row = 0; row < m_points->rowCount(); ++row) {
    for (int column = 0; column < 3; ++column) setCell(m_points, row, column, QStringLiteral("-"));
    setCell(m_points, row, 3, QString::fromStdString(picks[static_cast<std::size_t>(row)].landmark.name));
  }
  for (std::size_t i = 0; outcome && i < outcome->result.observations.size(); ++i) {
    const auto& o = outcome->result.observations[i];
    const int row = static_cast<int>(outcome->pick[i]);
    setCell(m_points, row, 0, QString::number(o.residual_px.norm(), 'f', 2) + (o.used ? QString() : tr(" (left out)")));
    setCell(m_points, row, 1, o.leave_one_out_px < 0 ? tr("alone decides") : QString::number(o.leave_one_out_px, 'f', 2));
    setCell(m_points, row, 2, QString::number(100 * o.leverage, 'f', 0));
  }
  m_steps->setTabText(1, picks.empty() ? tr("2 Points") : tr("2 Points (%1)").arg(picks.size()));
  const QString none = picks.empty() ? tr("there are none.") : QString();
  setWhyNot(m_remove, none, tr("Remove the selected point"));
  setWhyNot(m_clear, none, tr("Remove every point"));
}

void CalibratePosePanel::refreshAnswer() {
  setWhyNot(m_take, whyNotTake(), tr("Take a picture with this camera now"));
  QString text = model().outcome() ? model().resultText() : model().solving() ? tr("Calculating ...") : model().why();
  if (const auto miss = model().missInUse()) text = tr("With the calibration in use these points miss by %1 px rms.").arg(*miss, 0, 'f', 1) + QLatin1Char('\n') + text;
  m_result->setText(text);
  m_other->setVisible(model().outcome() && !model().outcome()->result.alternatives.empty());
  m_other->setToolTip(tr("Compare the drawn edges with the picture before one of the poses is used"));
  QString why = model().whyNotApply();
  if (why.isEmpty()) why = m_bench.whyNotCalibrate();
  QString tip = model().unknown() == PoseController::Unknown::kExt   ? tr("Keep it in the library and use it for this camera from now on")
                : model().unknown() == PoseController::Unknown::kDev ? tr("Keep it in the library: the pan-tilt and its cameras stand there from now on")
                                                                     : tr("Keep it in the library: the object stands there from now on");
  const QString worse = why.isEmpty() ? model().whyWorse() : QString();
  if (!worse.isEmpty()) tip += QLatin1Char('\n') + worse;
  m_apply->setText(worse.isEmpty() ? tr("Hold to use") : tr("Hold to use, though worse"));
  setWhyNot(m_apply, why, tip);
}

void CalibratePosePanel::refreshScene() {
  if (m_scene == nullptr || !isVisible()) return;
  const auto shown = model().snapshot();
  m_contents->setJoints(shown ? &shown->robot_state : nullptr);
  m_contents->setPicture(PaneSide::kLeft, model().viewNow(), shown ? shown->image : cv::Mat());
  std::vector<widgets::Pickable> pickables;
  const auto& workcell = m_bench.document().workcell();
  if (workcell && workcell->model) {
    Eigen::VectorXd q = workcell->model->neutral();
    if (shown) workcell->model->assign(shown->robot_state, q);
    for (std::size_t i = 0; i < model().landmarks().size(); ++i) {
      const auto at = model().landmarks()[i].inRoot(*workcell->model, q);
      if (at) pickables.push_back({i + 1, {*at}});
    }
    refreshMarks(q);
  }
  m_contents->setWorld(m_bench.document(), m_bench.held().held());
  m_scene->setPickables(std::move(pickables));
  m_scene->requestRender();
}

void CalibratePosePanel::refreshMarks(const Eigen::VectorXd& q) {
  const auto& robot = *m_bench.document().workcell()->model;
  std::vector<planning::WorldObject> marks;
  const auto add = [&](const session::Landmark& landmark, double radius, vision::OverlayRole role) {
    const auto at = landmark.inRoot(robot, q);
    if (!at) return;
    planning::WorldObject mark;
    mark.name = "mark " + std::to_string(marks.size());
    mark.shape = planning::Sphere{radius};
    mark.X_WO.translation() = *at;
    const QColor colour = m_appearance.theme().role(role).color;
    mark.rgba = {colour.redF(), colour.greenF(), colour.blueF(), 1};
    marks.push_back(mark);
  };
  for (const auto& pick : model().picks()) {
    if (pick.snapshot == (model().snapshot() ? model().snapshot()->id : SnapshotId())) add(pick.landmark, kMark_m, vision::OverlayRole::kHandle);
  }
  if (model().landmark() >= 0) add(model().landmarks()[static_cast<std::size_t>(model().landmark())], 1.6 * kMark_m, vision::OverlayRole::kActiveHandle);
  m_marks->update(marks);
}

void CalibratePosePanel::apply() {
  if (!m_apply->isEnabled()) return;
  // Both are taken from the one answer before the first is used, which begins another.
  std::optional<session::CameraChange> camera;
  std::optional<session::PlaceChange> place;
  if (model().unknown() == PoseController::Unknown::kExt || model().cameraToo()) camera = model().change();
  if (model().unknown() != PoseController::Unknown::kExt) place = model().placeChange();
  Status applied;
  if (place) applied = m_bench.calibration().apply(*place);
  if (applied && camera) applied = m_bench.calibration().apply(*camera);
  if (!applied) m_bench.say(QString::fromStdString(applied.error().message));
}

}  // namespace longarm::ui
