#include "widgets/image_canvas.h"

#include <cmath>

#include <QMouseEvent>
#include <QPainter>
#include <QTimer>
#include <QWheelEvent>
#include <opencv2/imgproc.hpp>

#include "widgets/loupe.h"
#include "widgets/overlay_region.h"

namespace longarm::widgets {

namespace {

constexpr double kLateFrom_s = 0.25, kFrozenFrom_s = 1.0;
constexpr double kReachMargin = 40;            // so much of the picture stays inside the widget [screen px]
constexpr int kNudgeLoupe_ms = 1500;
constexpr double kClickSlack = 4;              // a right press that moves less is a click [screen px]

vision::KeyModifiers modifiersOf(Qt::KeyboardModifiers modifiers) {
  vision::KeyModifiers result;
  result.shift = modifiers.testFlag(Qt::ShiftModifier);
  result.control = modifiers.testFlag(Qt::ControlModifier);
  result.alt = modifiers.testFlag(Qt::AltModifier);
  return result;
}

std::optional<vision::SketchKey> sketchKeyOf(int key) {
  switch (key) {
    case Qt::Key_Escape: return vision::SketchKey::kEscape;
    case Qt::Key_Delete:
    case Qt::Key_Backspace: return vision::SketchKey::kDelete;
    case Qt::Key_Left: return vision::SketchKey::kLeft;
    case Qt::Key_Right: return vision::SketchKey::kRight;
    case Qt::Key_Up: return vision::SketchKey::kUp;
    case Qt::Key_Down: return vision::SketchKey::kDown;
    case Qt::Key_Tab: return vision::SketchKey::kTab;
    case Qt::Key_Return:
    case Qt::Key_Enter: return vision::SketchKey::kReturn;
    default: return {};
  }
}

bool isModifier(int key) { return key == Qt::Key_Shift || key == Qt::Key_Control || key == Qt::Key_Alt; }

}  // namespace

Freshness freshnessOf(double age_s) {
  if (age_s >= kFrozenFrom_s) return Freshness::kFrozen;
  return age_s >= kLateFrom_s ? Freshness::kLate : Freshness::kFresh;
}

ImageCanvas::ImageCanvas(vision::PaneSide side, QWidget* parent) : QWidget(parent), m_side(side) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  setAttribute(Qt::WA_OpaquePaintEvent);
  setMinimumSize(160, 120);
  setCursor(Qt::CrossCursor);
}

ImageCanvas::~ImageCanvas() = default;

void ImageCanvas::setTheme(const Theme& theme) {
  m_theme = theme;
  update();
}

void ImageCanvas::setPicture(const cv::Mat& picture) {
  const bool same_size = picture.size() == m_raw.size();
  m_raw = picture;
  refreshShown();
  if (!same_size) fit();
}

void ImageCanvas::clearPicture(const QString& why) {
  m_raw.release();
  m_empty_text = why;
  m_layer.setPicture({});
  m_freshness = Freshness::kFresh;
  m_age.reset();
  update();
}

void ImageCanvas::setCamera(const std::optional<vision::CameraModel>& camera) {
  m_lens.reset();
  if (camera) m_lens.emplace(*camera);
  if (m_undistorted) refreshShown();
}

void ImageCanvas::setUndistorted(bool on) {
  if (m_undistorted == on) return;
  m_undistorted = on;
  refreshShown();
}

void ImageCanvas::refreshShown() {
  cv::Mat shown = undistorted() && !m_raw.empty() ? m_lens->straighten(m_raw) : m_raw;
  if (m_freshness == Freshness::kFrozen && shown.channels() == 3) {
    cv::Mat grey;
    cv::cvtColor(shown, grey, cv::COLOR_BGR2GRAY);
    shown = grey;
  }
  m_layer.setPicture(toQImage(shown));
  update();
}

void ImageCanvas::setOverlay(const vision::Overlay& overlay) {
  updateChanged(m_overlay, overlay);
  m_overlay = overlay;
  updateLoupe();
}

void ImageCanvas::setPathOverlay(const vision::Overlay& overlay) {
  if (overlay.shapes.empty() && m_path.shapes.empty()) return;
  updateChanged(m_path, overlay);
  m_path = overlay;
}

OverlayLook ImageCanvas::overlayLook() const {
  OverlayLook look;
  look.max_step_px = undistorted() ? 16 : 0;
  return look;
}

// Both as they look in the present view: whatever changes the view repaints everything.
void ImageCanvas::updateChanged(const vision::Overlay& before, const vision::Overlay& after) {
  if (!hasPicture()) return;
  const auto map = [this](const Eigen::Vector2d& raw) { return widgetOfPixel(raw); };
  update(changedRegion(before, after, m_theme, map, overlayLook(), QFontMetricsF(font()), size()));
}

// Where the loupe was and where it is now.
void ImageCanvas::updateLoupe() {
  if (!m_loupe_painted.isEmpty()) update(m_loupe_painted);
  if (!loupeVisible()) return;
  if (const auto middle = widgetOfPixel(loupeCentre())) update(loupeArea(*middle));
}

QRect ImageCanvas::loupeArea(const QPointF& middle) const {
  return loupeRect(middle, QSizeF(size())).toAlignedRect().adjusted(-1, -1, 1, 1);
}

void ImageCanvas::setAge(std::optional<double> age_s) {
  const Freshness before = m_freshness;
  const auto tenth = [](const std::optional<double>& age) { return age ? std::floor(*age * 10) : -1; };
  const bool text_changed = tenth(age_s) != tenth(m_age);
  m_age = age_s;
  m_freshness = age_s ? freshnessOf(*age_s) : Freshness::kFresh;
  if ((before == Freshness::kFrozen) != (m_freshness == Freshness::kFrozen)) refreshShown();
  if (before != m_freshness || (m_freshness != Freshness::kFresh && text_changed)) update();
}

bool ImageCanvas::loupeVisible() const {
  if (!hasPicture()) return false;
  if (m_gesture == Gesture::kTool) return true;
  if (m_since_nudge.isValid() && m_since_nudge.elapsed() < kNudgeLoupe_ms) return true;
  return m_inside && m_modifiers.alt && m_gesture == Gesture::kNone;
}

std::optional<Eigen::Vector2d> ImageCanvas::shownOfRaw(const Eigen::Vector2d& raw) const {
  return undistorted() ? m_lens->shownOfRaw(raw) : std::optional<Eigen::Vector2d>(raw);
}

std::optional<QPointF> ImageCanvas::widgetOfPixel(const Eigen::Vector2d& raw) const {
  const auto shown = shownOfRaw(raw);
  return shown ? std::optional<QPointF>(m_view.toWidget(*shown)) : std::nullopt;
}

Eigen::Vector2d ImageCanvas::pixelOfWidget(const QPointF& position) const {
  const Eigen::Vector2d shown = m_view.toPicture(position);
  return undistorted() ? m_lens->rawOfShown(shown) : shown;
}

void ImageCanvas::viewChanged() {
  m_view.keepReachable(QSizeF(pictureSize()), QSizeF(size()), kReachMargin);
  update();
  Q_EMIT zoomChanged(m_view.scale());
}

void ImageCanvas::fit() {
  m_fitted = true;
  if (hasPicture()) m_view.fit(QSizeF(pictureSize()), QSizeF(size()));
  viewChanged();
}

void ImageCanvas::zoomTo100() {
  m_fitted = false;
  m_view.setScaleAbout(QRectF(rect()).center(), 1 / devicePixelRatioF());
  m_view.snapOffset(devicePixelRatioF());
  viewChanged();
}

void ImageCanvas::zoomAbout(const QPointF& position, double factor) {
  m_fitted = false;
  m_view.zoomAbout(position, factor);
  viewChanged();
}

void ImageCanvas::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  if (m_fitted) {
    fit();
  } else {
    // The middle of the view stays in the middle.
    m_view.pan(QPointF(event->size().width() - event->oldSize().width(),
                       event->size().height() - event->oldSize().height()) / 2);
    viewChanged();
  }
}

void ImageCanvas::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  m_layer.paint(painter, m_view, size(), devicePixelRatioF(), m_theme.canvas);
  if (!hasPicture()) {
    paintEmpty(painter);
    return;
  }
  const OverlayLook look = overlayLook();
  const auto map = [this](const Eigen::Vector2d& raw) { return widgetOfPixel(raw); };
  paintOverlay(painter, m_path, m_theme, map, look);
  paintOverlay(painter, m_overlay, m_theme, map, look);
  paintAge(painter);
  m_loupe_painted = {};
  if (loupeVisible()) paintLoupeOver(painter);
  if (hasFocus()) {
    painter.setPen(QPen(m_theme.role(vision::OverlayRole::kSelected).color, 2));
    painter.drawRect(rect().adjusted(1, 1, -1, -1));
  }
}

void ImageCanvas::paintEmpty(QPainter& painter) {
  painter.setPen(m_theme.text);
  painter.drawText(rect().adjusted(16, 16, -16, -16), Qt::AlignCenter | Qt::TextWordWrap, m_empty_text);
}

void ImageCanvas::paintAge(QPainter& painter) {
  if (!m_age || m_freshness == Freshness::kFresh) return;
  const bool frozen = m_freshness == Freshness::kFrozen;
  if (frozen) painter.fillRect(rect(), QBrush(QColor(0, 0, 0, 90), Qt::BDiagPattern));
  const QString age = QString::number(*m_age, 'f', 1);
  const QString text = frozen ? QStringLiteral("FROZEN %1 s").arg(age) : QStringLiteral("LATE %1 s").arg(age);
  QFont font = painter.font();
  font.setBold(true);
  painter.setFont(font);
  const QRect box = painter.fontMetrics().boundingRect(text).adjusted(-8, -4, 8, 4);
  const QRect badge(QPoint(8, 8), box.size());
  painter.fillRect(badge, frozen ? m_theme.stop : m_theme.amber);
  painter.setPen(frozen ? m_theme.on_stop : m_theme.on_amber);
  painter.drawText(badge, Qt::AlignCenter, text);
}

// The handle, which may be held to the epipolar curve while the cursor is elsewhere; else the cursor.
Eigen::Vector2d ImageCanvas::loupeCentre() const {
  for (const auto& shape : m_overlay.shapes) {
    const bool handle = shape.kind == vision::OverlayShape::Kind::kMarker && shape.role == vision::OverlayRole::kActiveHandle;
    if (handle && !shape.points.empty() && !m_modifiers.alt) return shape.points.front();
  }
  return pixelOfWidget(m_position);
}

void ImageCanvas::paintLoupeOver(QPainter& painter) {
  LoupeContent content;
  content.picture = &m_layer.picture();
  content.raw = loupeCentre();
  const auto shown = shownOfRaw(content.raw);
  if (!shown) return;
  content.centre = *shown;
  const QPointF middle = m_view.toWidget(*shown);
  m_loupe_painted = loupeArea(middle);
  paintLoupe(painter, loupeRect(middle, QSizeF(size())), content, m_overlay, m_theme,
             [this](const Eigen::Vector2d& raw) { return shownOfRaw(raw); });
}

void ImageCanvas::emitPointer(vision::PointerPhase phase, const QPointF& position) {
  if (!hasPicture()) return;
  vision::PointerEvent event;
  event.side = m_side;
  event.phase = phase;
  event.pixel = pixelOfWidget(position);
  event.pixels_per_image_px = m_view.scale();
  event.left = m_buttons.testFlag(Qt::LeftButton);
  event.middle = m_buttons.testFlag(Qt::MiddleButton);
  event.right = m_buttons.testFlag(Qt::RightButton);
  event.modifiers = m_modifiers;
  Q_EMIT pointer(event);
}

void ImageCanvas::wheelEvent(QWheelEvent* event) {
  if (!hasPicture() || m_gesture == Gesture::kTool) return;
  constexpr double kPerNotch = 1.2;            // 120 units are one notch of a wheel; touch pads send fewer
  zoomAbout(event->position(), std::pow(kPerNotch, event->angleDelta().y() / 120.0));
  event->accept();
}

void ImageCanvas::mousePressEvent(QMouseEvent* event) {
  setFocus(Qt::MouseFocusReason);
  if (m_gesture != Gesture::kNone) return;
  m_position = m_press_position = event->localPos();
  m_modifiers = modifiersOf(event->modifiers());
  m_buttons = event->buttons() | event->button();
  if (event->button() == Qt::LeftButton) {
    m_gesture = Gesture::kTool;
    emitPointer(vision::PointerPhase::kPress, m_position);
    updateLoupe();
  } else {
    m_gesture = Gesture::kPan;
    setCursor(Qt::ClosedHandCursor);
  }
}

void ImageCanvas::mouseMoveEvent(QMouseEvent* event) {
  const QPointF before = m_position;
  m_position = event->localPos();
  m_modifiers = modifiersOf(event->modifiers());
  m_buttons = event->buttons();
  m_inside = true;
  switch (m_gesture) {
    case Gesture::kPan:
      m_fitted = false;
      m_view.pan(m_position - before);
      viewChanged();
      break;
    case Gesture::kTool: emitPointer(vision::PointerPhase::kDrag, m_position); updateLoupe(); break;
    case Gesture::kNone:
      emitPointer(vision::PointerPhase::kHover, m_position);
      updateLoupe();
      break;
  }
}

void ImageCanvas::mouseReleaseEvent(QMouseEvent* event) {
  m_position = event->localPos();
  m_modifiers = modifiersOf(event->modifiers());
  if (m_gesture == Gesture::kTool && event->button() == Qt::LeftButton) {
    m_gesture = Gesture::kNone;
    emitPointer(vision::PointerPhase::kRelease, m_position);
    m_buttons = event->buttons();
    updateLoupe();
  } else if (m_gesture == Gesture::kPan && event->button() != Qt::LeftButton) {
    m_gesture = Gesture::kNone;
    setCursor(Qt::CrossCursor);
    const QPointF moved = m_position - m_press_position;
    if (event->button() == Qt::RightButton && std::hypot(moved.x(), moved.y()) <= kClickSlack) {
      Q_EMIT menuRequested(event->globalPos());
    }
    m_buttons = event->buttons();
  }
}

void ImageCanvas::mouseDoubleClickEvent(QMouseEvent* event) {
  m_position = m_press_position = event->localPos();
  m_modifiers = modifiersOf(event->modifiers());
  m_buttons = event->buttons() | event->button();
  if (event->button() == Qt::LeftButton) {
    emitPointer(vision::PointerPhase::kDoubleClick, m_position);
  } else if (event->button() == Qt::MiddleButton) {
    fit();
  }
}

void ImageCanvas::leaveEvent(QEvent* event) {
  QWidget::leaveEvent(event);
  m_inside = false;
  updateLoupe();
  Q_EMIT pointerLeft();
}

// Pressing or letting go of the key that frees a handle must act at once, not at the next move.
void ImageCanvas::repeatWithModifiers() {
  if (m_gesture == Gesture::kTool) emitPointer(vision::PointerPhase::kDrag, m_position);
  updateLoupe();
}

void ImageCanvas::keyPressEvent(QKeyEvent* event) {
  if (isModifier(event->key())) {
    vision::KeyModifiers& m = m_modifiers;
    (event->key() == Qt::Key_Shift ? m.shift : event->key() == Qt::Key_Control ? m.control : m.alt) = true;
    repeatWithModifiers();
    return;
  }
  const auto key = sketchKeyOf(event->key());
  if (!key) {
    QWidget::keyPressEvent(event);
    return;
  }
  const bool arrow = event->key() >= Qt::Key_Left && event->key() <= Qt::Key_Down;
  if (arrow) {
    m_since_nudge.start();
    QTimer::singleShot(kNudgeLoupe_ms + 20, this, [this] { updateLoupe(); });
  }
  Q_EMIT sketchKey(*key, modifiersOf(event->modifiers()));
  updateLoupe();
}

void ImageCanvas::keyReleaseEvent(QKeyEvent* event) {
  if (!isModifier(event->key())) {
    QWidget::keyReleaseEvent(event);
    return;
  }
  vision::KeyModifiers& m = m_modifiers;
  (event->key() == Qt::Key_Shift ? m.shift : event->key() == Qt::Key_Control ? m.control : m.alt) = false;
  repeatWithModifiers();
}

void ImageCanvas::focusOutEvent(QFocusEvent* event) {
  QWidget::focusOutEvent(event);
  m_modifiers = {};
  update();
}

// Tab goes to the next handle; Shift+Tab still leaves the canvas.
bool ImageCanvas::focusNextPrevChild(bool next) { return next ? false : QWidget::focusNextPrevChild(next); }

}  // namespace longarm::widgets
