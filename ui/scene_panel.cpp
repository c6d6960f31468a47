#include "ui/scene_panel.h"

#include <cmath>

#include <QHBoxLayout>
#include <QLabel>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>

namespace longarm::ui {

using scene::CameraPreset;
using vision::PaneSide;

namespace {

constexpr int kPaneEvery_ms = 500;

}  // namespace

ScenePanel::ScenePanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent)
    : QFrame(parent), m_bench(bench), m_actions(actions), m_view(new widgets::SceneView(this)),
      m_contents(std::make_unique<SceneContents>(m_view->renderer())) {
  setObjectName(QStringLiteral("panel"));
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  column->setSpacing(3);
  column->addWidget(buildBar(actions));
  column->addWidget(m_view, 1);
  m_clearance = new QLabel(this);
  m_clearance->setTextFormat(Qt::RichText);
  m_clearance->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  m_clearance->setObjectName(QStringLiteral("clearance"));
  column->addWidget(m_clearance);
  showClearance();
  const auto style = [this, &appearance] { m_view->setTheme(appearance.theme()); };
  style();
  connect(&appearance, &Appearance::changed, this, style);
  bind(actions);
  onWorkcell();
  onSketch();
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) setPane(side, {}, {});
}

ScenePanel::~ScenePanel() { m_bench.document().unobserve(m_observer); }

QWidget* ScenePanel::buildBar(Actions& actions) {
  auto* bar = new QWidget(this);
  auto* row = new QHBoxLayout(bar);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(3);
  const auto add = [&](ActionId id, const QString& text) {
    auto* button = new QToolButton(bar);
    button->setDefaultAction(actions.at(id));
    button->setIconSize({18, 18});
    button->setFocusPolicy(Qt::TabFocus);
    if (!text.isEmpty()) {
      // A button shows its action's icon text; its own would go at the action's next change.
      actions.at(id)->setIconText(text);
      button->setToolButtonStyle(Qt::ToolButtonTextOnly);
    }
    row->addWidget(button);
  };
  add(ActionId::kSceneReset, {});
  add(ActionId::kSceneFit, {});
  add(ActionId::kSceneTop, tr("Top"));
  add(ActionId::kSceneSide, tr("Side"));
  add(ActionId::kSceneFront, tr("Front"));
  add(ActionId::kLookLeft, tr("From L"));
  add(ActionId::kLookRight, tr("From R"));
  row->addStretch(1);
  m_opacity = new QSlider(Qt::Horizontal, bar);
  m_opacity->setRange(0, 10);
  m_opacity->setValue(8);
  m_opacity->setFixedWidth(72);
  m_opacity->setFocusPolicy(Qt::ClickFocus);
  m_opacity->setToolTip(tr("Opacity of the pictures in the scene (keys [ and ])"));
  row->addWidget(m_opacity);
  return bar;
}

void ScenePanel::bind(Actions& actions) {
  const auto preset = [&](ActionId id, CameraPreset which) {
    connect(actions.at(id), &QAction::triggered, this, [this, which] { showAll(which); });
  };
  preset(ActionId::kSceneReset, CameraPreset::kIso);
  preset(ActionId::kSceneTop, CameraPreset::kTop);
  preset(ActionId::kSceneSide, CameraPreset::kRightSide);
  preset(ActionId::kSceneLeft, CameraPreset::kLeftSide);
  preset(ActionId::kSceneFront, CameraPreset::kFront);
  connect(actions.at(ActionId::kSceneFit), &QAction::triggered, this, &ScenePanel::frameSelection);
  connect(actions.at(ActionId::kLookLeft), &QAction::triggered, this, [this] { lookFrom(PaneSide::kLeft); });
  connect(actions.at(ActionId::kLookRight), &QAction::triggered, this, [this] { lookFrom(PaneSide::kRight); });
  connect(actions.at(ActionId::kMoreOpaque), &QAction::triggered, this, [this] { m_opacity->setValue(m_opacity->value() + 1); });
  connect(actions.at(ActionId::kLessOpaque), &QAction::triggered, this, [this] { m_opacity->setValue(m_opacity->value() - 1); });
  connect(m_opacity, &QSlider::valueChanged, this, [this](int tenths) {
    m_contents->setOpacity(tenths / 10.0);
    m_view->requestRender();
  });
  connect(m_view, &widgets::SceneView::picked, this, [this](quint64 id) {
    if (m_bench.targeting().tool() != session::ToolKind::kMeasure) m_bench.targeting().select(FeatureId{id});
  });
  connect(m_view, &widgets::SceneView::clicked, this, &ScenePanel::measureAt);
  connect(&m_bench.targeting(), &session::TargetingController::overlayChanged, this, [this] {
    if (m_contents->setDimension(m_bench.targeting().dimension())) m_view->requestRender();
  });
  connect(&m_bench.targeting(), &session::TargetingController::featuresChanged, this, &ScenePanel::onSketch);
  connect(&m_bench.targeting(), &session::TargetingController::worldChanged, this, &ScenePanel::onWorld);
  connect(&m_bench.held(), &session::HeldController::changed, this, &ScenePanel::onWorld);
  connect(&m_bench, &Workbench::baseRested, this, &ScenePanel::onWorld);
  connect(&m_bench.targeting(), &session::TargetingController::planChanged, this, &ScenePanel::onPlan);
  connect(&m_bench.play(), &session::PlayController::changed, this, [this] {
    m_contents->setCursor(m_bench.play().state().cursor_s);
    m_view->requestRender();
  });
  connect(&m_bench.robot(), &RobotSession::jointStateChanged, this, &ScenePanel::onJoints);
  m_observer = m_bench.document().observe([this](const session::Change& change) {
    if (change.kind == session::ChangeKind::kWorkcellChanged) onWorkcell();
  });
  m_pane_timer.setSingleShot(true);
  m_pane_timer.setInterval(kPaneEvery_ms);
  connect(&m_pane_timer, &QTimer::timeout, this, &ScenePanel::showPanes);
}

void ScenePanel::onWorkcell() {
  const auto& workcell = m_bench.document().workcell();
  const bool same_robot = workcell && m_contents->robot() == workcell->model;
  m_contents->setWorkcell(workcell);
  onJoints();
  if (!same_robot) showAll(CameraPreset::kIso);
}

void ScenePanel::onJoints() {
  const auto* runtime = m_bench.robot().runtime();
  const auto joints = runtime != nullptr ? runtime->jointState() : nullptr;
  if (!m_contents->setJoints(joints.get())) return;
  if (!m_framed && joints) {
    m_framed = true;
    showAll(CameraPreset::kIso);
  }
  m_view->requestRender();
}

void ScenePanel::onWorld() {
  m_contents->setWorld(m_bench.document(), m_bench.held().held());
  m_view->requestRender();
}

void ScenePanel::onSketch() {
  m_contents->setSketch(m_bench.document());
  m_view->setPickables(m_contents->pickables(m_bench.document()));
  m_view->requestRender();
}

// The measure tool works in the scene as it does in the pictures.
void ScenePanel::measureAt(const QPointF& position) {
  if (m_bench.targeting().tool() != session::ToolKind::kMeasure) return;
  const auto point = m_view->pickPoint(position);
  if (point) m_bench.targeting().takeVertex({FeatureId{point->first}, point->second});
}

void ScenePanel::onPlan() {
  showClearance();
  m_contents->setPlan(m_bench.document());
  m_contents->setCursor(m_bench.play().state().cursor_s);
  m_view->requestRender();
}

void ScenePanel::showClearance() {
  const auto& record = m_bench.document().plan();
  const bool told = record && record->plan.ok() && !record->plan.clearance.empty();
  m_clearance->setVisible(told);
  if (!told) return;
  using Band = planning::ClearanceBand;
  const auto patch = [](Band band, const QString& text) {
    return QStringLiteral("<span style=\"background:%1\">&nbsp;&nbsp;&nbsp;</span>&nbsp;%2 ").arg(widgets::clearanceColour(band).name(), text.toHtmlEscaped());
  };
  const auto mm = [](double metres) { return QString::number(metres * 1000, 'f', 0); };
  const auto& least = planning::leastClearance(record->plan.clearance);
  const QString where = least.distance >= planning::kClearanceTold ? tr("nowhere under %1 mm").arg(mm(planning::kClearanceTold))
                                                                   : tr("least %1 mm at %2 s").arg(QString::number(std::floor(least.distance * 1000)), QString::number(least.t_s, 'f', 1));
  m_clearance->setText(patch(Band::kTight, tr("< %1").arg(mm(planning::kTightClearance))) + patch(Band::kNear, tr("< %1 mm").arg(mm(planning::kNearClearance))) +
                       patch(Band::kFree, tr("more")) + QStringLiteral("\u00b7 ") + where);
  m_clearance->setToolTip(tr("Clearance along the path: the least distance of robot, and what it holds, from everything that the motion keeps away from."));
}

void ScenePanel::setPane(PaneSide side, const std::optional<vision::View>& view, const cv::Mat& picture) {
  Pane& pane = m_panes[static_cast<std::size_t>(side)];
  pane.view = view;
  pane.picture = picture;
  pane.changed = true;
  m_actions.setWhyNot(side == PaneSide::kLeft ? ActionId::kLookLeft : ActionId::kLookRight,
                      view ? QString() : tr("There is no picture in this pane, or its camera's place is not known."));
  if (!m_pane_timer.isActive()) m_pane_timer.start();
}

void ScenePanel::showPanes() {
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    Pane& pane = m_panes[static_cast<std::size_t>(side)];
    if (!pane.changed) continue;
    pane.changed = false;
    m_contents->setPicture(side, pane.view, pane.picture);
    if (pane.view && !m_framed && !m_bench.document().workcell()) {
      m_framed = true;
      showAll(CameraPreset::kIso);
    }
  }
  m_view->requestRender();
}

void ScenePanel::showAll(CameraPreset preset) {
  m_view->showPreset(preset);
  const auto box = m_contents->everything();
  if (!box.isEmpty()) scene::applyPreset(m_view->renderer(), preset, box);
  m_view->requestRender();
}

void ScenePanel::frameSelection() {
  m_view->fit();
  auto box = m_contents->selection(m_bench.document());
  if (box.isEmpty()) box = m_contents->everything();
  if (!box.isEmpty()) scene::fitView(m_view->renderer(), box);
  m_view->requestRender();
}

void ScenePanel::lookFrom(PaneSide side) {
  const Pane& pane = m_panes[static_cast<std::size_t>(side)];
  if (pane.view) m_view->lookFromView(*pane.view);
}

}  // namespace longarm::ui
