#include "ui/cameras_panel.h"

#include <QLabel>
#include <QScrollArea>
#include <QShortcut>
#include <QVBoxLayout>

#include "planning/world/workcell.h"

namespace longarm::ui {

using vision::PaneSide;

CamerasPanel::CamerasPanel(Workbench& bench, Appearance& appearance, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  m_scroll = new QScrollArea(this);
  m_scroll->setWidgetResizable(true);
  m_scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  m_strip = new widgets::CameraStrip;
  m_scroll->setWidget(m_strip);
  column->addWidget(m_scroll);
  m_empty = new QLabel(tr("No cameras:\nthere is no workcell."), this);
  m_empty->setAlignment(Qt::AlignCenter);
  m_empty->setWordWrap(true);
  m_empty->setObjectName(QStringLiteral("muted"));
  column->addWidget(m_empty);
  setMinimumWidth(120);
  const auto style = [this, &appearance] { m_strip->setTheme(appearance.theme()); };
  style();
  connect(&appearance, &Appearance::changed, this, style);
  connect(m_strip, &widgets::CameraStrip::chosen, this, [this](const QString& camera, bool right) {
    Q_EMIT chosen(camera, right ? PaneSide::kRight : PaneSide::kLeft);
  });
  connect(&m_bench.live(), &LivePictures::thumbnailArrived, this, [this](const QString& camera) {
    if (auto* tile = m_strip->tile(camera)) tile->setPicture(m_bench.live().thumbnail(camera));
  });
  connect(&m_bench.health(), &session::HealthController::changed, this, &CamerasPanel::refreshHealth);
  connect(&m_bench.robot(), &RobotSession::polledSlowly, this, &CamerasPanel::refreshAges);
  m_observer = m_bench.document().observe([this](const session::Change& change) {
    if (change.kind == session::ChangeKind::kWorkcellChanged) rebuild();
  });
  bindKeys();
  rebuild();
}

CamerasPanel::~CamerasPanel() { m_bench.document().unobserve(m_observer); }

void CamerasPanel::bindKeys() {
  for (int number = 1; number <= 9; ++number) {
    auto* left = new QShortcut(QKeySequence(Qt::Key_0 + number), this);
    connect(left, &QShortcut::activated, this, [this, number] { chooseNumber(number, PaneSide::kLeft); });
    auto* right = new QShortcut(QKeySequence(Qt::ALT + Qt::Key_0 + number), this);
    connect(right, &QShortcut::activated, this, [this, number] { chooseNumber(number, PaneSide::kRight); });
  }
}

void CamerasPanel::chooseNumber(int number, PaneSide side) {
  if (number > static_cast<int>(m_cameras.size())) return;
  Q_EMIT chosen(m_cameras[static_cast<std::size_t>(number - 1)], side);
}

void CamerasPanel::rebuild() {
  m_cameras.clear();
  if (m_bench.document().workcell()) {
    for (const auto& camera : m_bench.document().workcell()->cameras) m_cameras.push_back(QString::fromStdString(camera.name));
  }
  m_strip->setCameras(m_cameras);
  m_empty->setVisible(m_cameras.empty());
  m_scroll->setVisible(!m_cameras.empty());
  refreshHealth();
}

void CamerasPanel::refreshHealth() {
  using calibration::HealthLevel;
  using widgets::StatusLamp;
  for (const auto& camera : m_cameras) {
    const auto health = m_bench.health().of(camera.toStdString());
    const auto level = health.level == HealthLevel::kKnocked    ? StatusLamp::Level::kFault
                       : health.level == HealthLevel::kDoubtful ? StatusLamp::Level::kDegraded
                                                                : StatusLamp::Level::kOk;
    if (auto* tile = m_strip->tile(camera)) tile->setHealth(level, QString::fromStdString(health.why));
  }
}

void CamerasPanel::refreshAges() {
  for (const auto& camera : m_cameras) {
    if (auto* tile = m_strip->tile(camera)) tile->setAge(m_bench.live().age(camera));
  }
}

}  // namespace longarm::ui
