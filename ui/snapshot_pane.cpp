#include "ui/snapshot_pane.h"

#include <QButtonGroup>
#include <QComboBox>
#include <QHBoxLayout>
#include <QSignalBlocker>
#include <QToolButton>
#include <QVBoxLayout>

#include "planning/world/workcell.h"
#include "ui/elided_label.h"
#include "ui/picture_text.h"
#include "ui/zoom_bar.h"
#include "widgets/icon.h"

namespace longarm::ui {

using vision::PaneSide;

namespace {

constexpr double kLeastFrame_px = 8;     // on screen
constexpr double kKeyTurn_rad = 0.0175, kKeyTurnFar_rad = 0.0873;   // 1 and 5 degrees

bool fromRobot(const vision::Snapshot& snapshot) { return snapshot.source == "live"; }

QString titleOf(const vision::Snapshot& snapshot) {
  const QString name = QString::fromStdString(snapshot.view.name);
  return fromRobot(snapshot) ? name + QStringLiteral("  ") + pictureTime(snapshot.wall_time_s) : name;
}

}  // namespace

SnapshotPane::SnapshotPane(PaneSide side, Workbench& bench, Appearance& appearance, QWidget* parent)
    : QFrame(parent), m_side(side), m_bench(bench), m_appearance(appearance) {
  setObjectName(QStringLiteral("panel"));
  m_canvas = new widgets::ImageCanvas(side, this);
  buildHeader();
  connect(m_canvas, &widgets::ImageCanvas::pointer, this, &SnapshotPane::onPointer);
  connect(m_canvas, &widgets::ImageCanvas::sketchKey, this, &SnapshotPane::onKey);
  auto& targeting = m_bench.targeting();
  connect(&targeting, &session::TargetingController::panesChanged, this, [this] {
    const SnapshotId now = m_bench.document().paneSnapshotId(m_side);
    if (now == m_snapshot) return;
    m_snapshot = now;
    // A picture that was taken or opened is what the operator wants to see.
    if (now.valid()) m_live = false;
    refreshPicture();
  });
  connect(&targeting, &session::TargetingController::snapshotsChanged, this, &SnapshotPane::refreshChooser);
  connect(&targeting, &session::TargetingController::overlayChanged, this, &SnapshotPane::refreshOverlay);
  connect(m_canvas, &widgets::ImageCanvas::menuRequested, this, &SnapshotPane::menuRequested);
  connect(&m_bench, &Workbench::paneCameraChanged, this, [this](PaneSide changed) {
    if (changed == m_side) refreshPicture();
  });
  connect(&m_bench.live(), &LivePictures::pictureArrived, this, [this](const QString& camera) {
    if (m_live && camera == m_bench.paneCamera(m_side)) refreshLive();
  });
  connect(&m_bench.robot(), &RobotSession::polledSlowly, this, &SnapshotPane::refreshAge);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, [this] { if (!m_canvas->hasPicture()) refreshPicture(); });
  connect(&m_appearance, &Appearance::changed, this, &SnapshotPane::applyTheme);
  applyTheme();
  refreshPicture();
}

QToolButton* SnapshotPane::button(const char* icon, const QString& tip) {
  auto* result = new QToolButton(this);
  result->setProperty("action_icon", QString::fromLatin1(icon));
  result->setToolTip(tip);
  result->setIconSize({18, 18});
  result->setFocusPolicy(Qt::TabFocus);
  return result;
}

void SnapshotPane::buildHeader() {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  column->setSpacing(3);
  auto* row = new QHBoxLayout;
  row->setSpacing(3);
  column->addLayout(row);
  m_live_button = new QToolButton(this);
  m_live_button->setText(tr("Live"));
  m_live_button->setToolTip(tr("Show this pane's camera live (V for both panes)"));
  m_snapshot_button = new QToolButton(this);
  m_snapshot_button->setText(tr("Snapshot"));
  m_snapshot_button->setToolTip(tr("Show the snapshot that is sketched on"));
  auto* group = new QButtonGroup(this);
  for (auto* each : {m_live_button, m_snapshot_button}) {
    each->setCheckable(true);
    each->setFocusPolicy(Qt::TabFocus);
    group->addButton(each);
    row->addWidget(each);
  }
  m_chooser = new QComboBox(this);
  m_chooser->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  m_chooser->setMinimumWidth(70);
  m_chooser->setFocusPolicy(Qt::TabFocus);
  row->addWidget(m_chooser, 1);
  m_fit = button("view-fit", tr("Show the whole picture (Ctrl+0, or double-click with the middle button)"));
  m_full_size = button("view-full-size", tr("One picture pixel per screen pixel (Ctrl+1)"));
  m_undistort = button("view-undistort", tr("Show the picture without lens distortion; picks keep their meaning (U)"));
  m_undistort->setCheckable(true);
  for (auto* each : {m_fit, m_full_size, m_undistort}) row->addWidget(each);
  column->addWidget(m_canvas, 1);
  m_zoom_bar = new ZoomBar(m_side, m_bench, m_canvas, this);
  column->addWidget(m_zoom_bar);
  m_info = new ElidedLabel(this, Qt::ElideMiddle);
  m_info->setObjectName(QStringLiteral("muted"));
  column->addWidget(m_info);

  connect(m_live_button, &QToolButton::clicked, this, [this] { setLive(true); });
  connect(m_snapshot_button, &QToolButton::clicked, this, [this] { setLive(false); });
  connect(m_chooser, qOverload<int>(&QComboBox::activated), this, &SnapshotPane::choose);
  connect(m_fit, &QToolButton::clicked, m_canvas, &widgets::ImageCanvas::fit);
  connect(m_full_size, &QToolButton::clicked, m_canvas, &widgets::ImageCanvas::zoomTo100);
  connect(m_undistort, &QToolButton::toggled, this, &SnapshotPane::setUndistorted);
}

void SnapshotPane::applyTheme() {
  m_canvas->setTheme(m_appearance.theme());
  for (auto* each : {m_fit, m_full_size, m_undistort}) {
    each->setIcon(widgets::icon(each->property("action_icon").toString(), m_appearance.theme()));
  }
}

void SnapshotPane::showLive(const QString& camera) {
  m_live = true;
  m_bench.setPaneCamera(m_side, camera);
  refreshPicture();
}

void SnapshotPane::showSnapshot() { setLive(false); }

void SnapshotPane::setLive(bool live) {
  m_live = live;
  refreshPicture();
}

void SnapshotPane::setUndistorted(bool on) {
  if (m_undistort->isChecked() != on) {
    m_undistort->setChecked(on);
    return;
  }
  m_canvas->setUndistorted(on);
  Q_EMIT undistortedChanged(on);
}

bool SnapshotPane::undistorted() const { return m_undistort->isChecked(); }

std::optional<vision::View> SnapshotPane::view() const {
  if (m_live) return m_bench.live().view(m_bench.paneCamera(m_side));
  const auto snapshot = m_bench.document().paneSnapshot(m_side);
  return snapshot ? std::optional<vision::View>(snapshot->view) : std::nullopt;
}

const cv::Mat& SnapshotPane::picture() const {
  static const cv::Mat none;
  if (m_live) return m_bench.live().picture(m_bench.paneCamera(m_side));
  const auto snapshot = m_bench.document().paneSnapshot(m_side);
  return snapshot ? snapshot->image : none;
}

QString SnapshotPane::emptyText() const {
  if (!m_live) return tr("No snapshot in this pane.\n\nTake a pair (Ctrl+T), or open pictures from files (Ctrl+O).");
  const QString why = m_bench.robot().whyNotReady();
  if (!why.isEmpty()) return tr("No live picture.\n\n%1\n\nPictures from files work without a robot (Ctrl+O).").arg(why);
  const QString camera = m_bench.paneCamera(m_side);
  return camera.isEmpty() ? tr("The workcell has no camera for this pane.") : tr("Waiting for the first picture of %1.").arg(camera);
}

void SnapshotPane::refreshPicture() {
  (m_live ? m_live_button : m_snapshot_button)->setChecked(true);
  m_bench.live().setShown(m_side, m_live ? m_bench.paneCamera(m_side) : QString());
  m_zoom_bar->setLive(m_live);
  m_frame.reset();
  refreshChooser();
  m_canvas->setAge({});
  if (m_live) {
    refreshLive();
    return;
  }
  const auto snapshot = m_bench.document().paneSnapshot(m_side);
  if (snapshot) {
    m_canvas->setCamera(snapshot->view.camera);
    m_canvas->setPicture(snapshot->image);
    const QString source = QString::fromStdString(snapshot->source);
    m_info->setFullText(fromRobot(*snapshot) ? tr("taken at %1 by %2").arg(pictureTime(snapshot->wall_time_s), QString::fromStdString(snapshot->view.name))
                                             : tr("file %1").arg(source));
  } else {
    m_canvas->clearPicture(emptyText());
    m_info->setFullText({});
  }
  refreshOverlay();
  Q_EMIT shownChanged();
}

void SnapshotPane::refreshLive() {
  const QString camera = m_bench.paneCamera(m_side);
  const cv::Mat& picture = m_bench.live().picture(camera);
  if (picture.empty()) {
    m_canvas->clearPicture(emptyText());
    m_info->setFullText({});
  } else {
    const auto view = m_bench.live().view(camera);
    m_canvas->setCamera(view ? std::optional<vision::CameraModel>(view->camera) : std::nullopt);
    m_canvas->setPicture(picture);
    const QString why = m_bench.live().whyNoView(camera);
    m_info->setFullText(why.isEmpty() ? tr("live: double-click looks there, drag frames, arrow keys turn the head") : why);
  }
  refreshOverlay();
  Q_EMIT shownChanged();
}

void SnapshotPane::refreshOverlay() {
  if (!m_live) {
    m_canvas->setOverlay(m_bench.targeting().overlay(m_side));
    return;
  }
  const auto shown = view();
  vision::Overlay overlay = shown && m_canvas->hasPicture() ? m_bench.targeting().overlay(*shown) : vision::Overlay{};
  if (m_frame) {
    const auto& [a, b] = *m_frame;
    overlay.shapes.push_back({vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kSelected,
                              {a, {b.x(), a.y()}, b, {a.x(), b.y()}, a}, {}});
  }
  m_canvas->setOverlay(overlay);
}

void SnapshotPane::refreshAge() {
  if (!m_live || !m_canvas->hasPicture()) return;
  m_canvas->setAge(m_bench.live().age(m_bench.paneCamera(m_side)));
}

void SnapshotPane::refreshChooser() {
  const QSignalBlocker quiet(m_chooser);
  m_chooser->clear();
  const auto& document = m_bench.document();
  if (m_live) {
    if (document.workcell()) {
      for (const auto& camera : document.workcell()->cameras) {
        const QString name = QString::fromStdString(camera.name);
        m_chooser->addItem(name, name);
      }
    }
    m_chooser->setCurrentIndex(m_chooser->findData(m_bench.paneCamera(m_side)));
    m_chooser->setToolTip(tr("Which camera this pane shows"));
  } else {
    for (const auto& snapshot : document.snapshots()) {
      m_chooser->addItem(titleOf(*snapshot), QVariant::fromValue<qulonglong>(snapshot->id.value));
    }
    m_chooser->setCurrentIndex(m_chooser->findData(QVariant::fromValue<qulonglong>(document.paneSnapshotId(m_side).value)));
    m_chooser->setToolTip(tr("Which snapshot this pane shows"));
  }
  m_chooser->setEnabled(m_chooser->count() > 0);
}

void SnapshotPane::choose(int index) {
  const QVariant chosen = m_chooser->itemData(index);
  if (m_live) {
    showLive(chosen.toString());
  } else {
    m_bench.targeting().showSnapshot(m_side, SnapshotId{chosen.toULongLong()});
  }
}

void SnapshotPane::onPointer(const vision::PointerEvent& event) {
  if (!m_live) {
    m_bench.targeting().pointer(event);
    return;
  }
  onLivePointer(event);
}

void SnapshotPane::onLivePointer(const vision::PointerEvent& event) {
  using vision::PointerPhase;
  const bool press = event.phase == PointerPhase::kPress;
  const bool centre = event.phase == PointerPhase::kDoubleClick || (press && event.modifiers.control);
  if (centre && event.left) {
    m_frame.reset();
    m_bench.aim().aimAt(m_bench.paneCamera(m_side), event.pixel);
  } else if (press && event.left) {
    m_frame = {event.pixel, event.pixel};
  } else if (m_frame && event.phase == PointerPhase::kDrag) {
    (*m_frame)[1] = event.pixel;
    refreshOverlay();
  } else if (m_frame && event.phase == PointerPhase::kRelease) {
    endFrame(event);
  }
}

// What is hardly a frame was a click.
void SnapshotPane::endFrame(const vision::PointerEvent& event) {
  const auto frame = *std::exchange(m_frame, std::nullopt);
  refreshOverlay();
  const Eigen::Vector2d size = (event.pixel - frame[0]).cwiseAbs();
  if (size.minCoeff() < event.imageTolerance(kLeastFrame_px)) return;
  m_bench.aim().frameRegion(m_bench.paneCamera(m_side), frame[0], event.pixel);
}

void SnapshotPane::onKey(vision::SketchKey key, const vision::KeyModifiers& modifiers) {
  if (m_live && key == vision::SketchKey::kEscape) {
    m_frame.reset();
    refreshOverlay();
  } else if (m_live) {
    turnHead(key, modifiers.shift);
  } else {
    m_bench.targeting().key(key, modifiers);
  }
}

void SnapshotPane::turnHead(vision::SketchKey key, bool far) {
  const auto& workcell = m_bench.document().workcell();
  const auto* camera = workcell ? workcell->camera(m_bench.paneCamera(m_side).toStdString()) : nullptr;
  // Naming the same one again would forget where the last key step was going.
  const QString head = camera != nullptr ? QString::fromStdString(camera->pan_tilt) : QString();
  if (!head.isEmpty() && head != m_bench.aim().panTilt()) m_bench.aim().setPanTilt(head);
  const double turn = far ? kKeyTurnFar_rad : kKeyTurn_rad;
  switch (key) {
    case vision::SketchKey::kLeft: m_bench.aim().step(-turn, 0); break;
    case vision::SketchKey::kRight: m_bench.aim().step(turn, 0); break;
    case vision::SketchKey::kUp: m_bench.aim().step(0, turn); break;
    case vision::SketchKey::kDown: m_bench.aim().step(0, -turn); break;
    default: break;
  }
}

}  // namespace longarm::ui
