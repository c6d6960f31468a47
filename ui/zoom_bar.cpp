#include "ui/zoom_bar.h"

#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>

namespace longarm::ui {
namespace {

constexpr int kSteps = 1000;             // of the slider

}  // namespace

ZoomBar::ZoomBar(vision::PaneSide side, Workbench& bench, QWidget* keys, QWidget* parent)
    : QWidget(parent), m_side(side), m_bench(bench) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(3);
  using Drive = session::ZoomDrive;
  m_wider = heldButton(QStringLiteral("\u2212"), tr("Zooms out while it is held (Page down in the picture)"), &Drive::holdZoom, -1);
  m_slider = new QSlider(Qt::Horizontal, this);
  m_slider->setRange(0, kSteps);
  m_slider->setPageStep(kSteps / 20);
  m_slider->setMinimumWidth(40);
  m_slider->setFocusPolicy(Qt::TabFocus);
  m_slider->setToolTip(tr("Zoom, from wide to narrow; the lens follows at its own rate"));
  m_closer = heldButton(QStringLiteral("+"), tr("Zooms in while it is held (Page up in the picture)"), &Drive::holdZoom, 1);
  m_value = new QLabel(this);
  m_value->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("00.0\u00d7")));
  m_near = heldButton(tr("near"), tr("Focuses nearer while it is held (Shift+Page down in the picture)"), &Drive::holdFocus, -1);
  m_far = heldButton(tr("far"), tr("Focuses farther while it is held (Shift+Page up in the picture)"), &Drive::holdFocus, 1);
  m_auto = new QToolButton(this);
  m_auto->setText(tr("AF"));
  m_auto->setToolTip(tr("Lets the camera focus by itself"));
  m_auto->setFocusPolicy(Qt::TabFocus);
  row->addWidget(m_wider);
  row->addWidget(m_slider, 1);
  for (QWidget* each : {static_cast<QWidget*>(m_closer), static_cast<QWidget*>(m_value), static_cast<QWidget*>(m_near),
                        static_cast<QWidget*>(m_far), static_cast<QWidget*>(m_auto)}) {
    row->addWidget(each);
  }
  connect(m_slider, &QSlider::valueChanged, this, [this](int value) {
    m_bench.zoomDrive().setZoom(camera(), static_cast<double>(value) / kSteps);
  });
  connect(m_auto, &QToolButton::clicked, this, [this] { m_bench.zoomDrive().focusItself(camera()); });
  connect(&m_bench.robot(), &RobotSession::polledSlowly, this, &ZoomBar::refresh);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, &ZoomBar::refresh);
  connect(&m_bench, &Workbench::paneCameraChanged, this, &ZoomBar::refresh);
  keys->installEventFilter(this);
  refresh();
}

QToolButton* ZoomBar::heldButton(const QString& text, const QString& tip,
                                 void (session::ZoomDrive::*hold)(const QString&, int), int direction) {
  auto* button = new QToolButton(this);
  button->setText(text);
  button->setToolTip(tip);
  button->setFocusPolicy(Qt::TabFocus);
  connect(button, &QToolButton::pressed, this, [this, hold, direction] { (m_bench.zoomDrive().*hold)(camera(), direction); });
  connect(button, &QToolButton::released, this, [this] { m_bench.zoomDrive().release(); });
  return button;
}

void ZoomBar::setLive(bool live) {
  m_live = live;
  refresh();
}

void ZoomBar::refresh() {
  auto& drive = m_bench.zoomDrive();
  setVisible(m_live && drive.zooms(camera()));
  if (isHidden()) return;
  const QString why = drive.whyNot(camera());
  for (QWidget* each : findChildren<QWidget*>()) each->setEnabled(why.isEmpty());
  setToolTip(why);
  const auto zoom = drive.zoom(camera());
  if (zoom && !m_slider->isSliderDown()) {
    const QSignalBlocker quiet(m_slider);
    m_slider->setValue(qRound(kSteps * *zoom));
  }
  const auto larger = drive.magnification(camera());
  m_value->setText(larger ? tr("%1\u00d7").arg(*larger, 0, 'f', 1) : tr("?"));
  m_value->setToolTip(larger ? tr("How much larger things are than at the wide end; setting %1").arg(zoom.value_or(0), 0, 'f', 2)
                             : tr("The camera is not calibrated at this zoom: look, do not measure"));
}

bool ZoomBar::eventFilter(QObject* watched, QEvent* event) {
  auto& drive = m_bench.zoomDrive();
  if (event->type() == QEvent::FocusOut) drive.release();
  const bool press = event->type() == QEvent::KeyPress;
  if (isHidden() || (!press && event->type() != QEvent::KeyRelease)) return QWidget::eventFilter(watched, event);
  const auto* key = static_cast<QKeyEvent*>(event);
  if (key->key() != Qt::Key_PageUp && key->key() != Qt::Key_PageDown) return QWidget::eventFilter(watched, event);
  if (key->isAutoRepeat()) return true;
  const int direction = key->key() == Qt::Key_PageUp ? 1 : -1;
  if (!press) {
    drive.release();
  } else if (key->modifiers() & Qt::ShiftModifier) {
    drive.holdFocus(camera(), direction);
  } else {
    drive.holdZoom(camera(), direction);
  }
  return true;
}

}  // namespace longarm::ui
