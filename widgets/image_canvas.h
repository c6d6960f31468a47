#pragma once

/// @file
/// ImageCanvas: shows one picture with what is sketched on it, and tells where in it the operator points.

#include <memory>
#include <optional>

#include <QElapsedTimer>
#include <QImage>
#include <QWidget>
#include <opencv2/core/mat.hpp>

#include "vision/camera/camera_model.h"
#include "vision/sketch/pointer_event.h"
#include "widgets/canvas_view.h"
#include "widgets/lens_map.h"
#include "widgets/overlay_painter.h"
#include "widgets/picture_layer.h"
#include "widgets/theme.h"

namespace longarm::widgets {

/// How old a live picture is, as the operator must see it.
enum class Freshness { kFresh, kLate, kFrozen };
/// Late from 0.25 s, frozen from 1 s.
Freshness freshnessOf(double age_s);

/// A picture with overlays.  Everything that goes in and out is in raw pixels with the origin at the centre of
/// the first pixel, whatever the zoom and whether the straightened picture is shown.
///
/// Wheel zooms about the cursor; middle or right drag pans; middle double click or F fits.  The left button and
/// the keys of sketch tools are passed on by signals.  Takes values only; GUI thread only.
class ImageCanvas : public QWidget {
  Q_OBJECT

 public:
  explicit ImageCanvas(vision::PaneSide side, QWidget* parent = nullptr);
  ~ImageCanvas() override;

  void setTheme(const Theme& theme);
  /// 8-bit grey, BGR or BGRA.  The view is kept when the size stays, else fitted.
  void setPicture(const cv::Mat& picture);
  /// No picture; `why` is shown instead.
  void clearPicture(const QString& why);
  bool hasPicture() const { return !m_raw.empty(); }
  QSize pictureSize() const { return {m_raw.cols, m_raw.rows}; }
  /// Needed to show the straightened picture.
  void setCamera(const std::optional<vision::CameraModel>& camera);
  /// Shows the straightened picture; picks and overlays keep their meaning.  No effect without a camera.
  void setUndistorted(bool on);
  bool undistorted() const { return m_undistorted && m_lens.has_value(); }

  void setOverlay(const vision::Overlay& overlay);          ///< What is sketched.
  void setPathOverlay(const vision::Overlay& overlay);      ///< A motion, under the sketch.
  /// Age of a live picture [s]; nothing for a frozen snapshot, which never grows old.
  void setAge(std::optional<double> age_s);
  Freshness freshness() const { return m_freshness; }
  /// The loupe shows by itself while dragging; with Alt while hovering; and for a moment after a nudge.
  bool loupeVisible() const;

  double scale() const { return m_view.scale(); }
  /// Widget position of a raw pixel; nothing where the straightened picture does not reach.
  std::optional<QPointF> widgetOfPixel(const Eigen::Vector2d& raw) const;
  Eigen::Vector2d pixelOfWidget(const QPointF& position) const;
  int resampleCount() const { return m_layer.resampleCount(); }
  QSize sizeHint() const override { return {400, 300}; }

 public Q_SLOTS:
  void fit();
  /// One picture pixel per screen pixel about the widget's middle.
  void zoomTo100();
  void zoomAbout(const QPointF& position, double factor);

 Q_SIGNALS:
  void pointer(const longarm::vision::PointerEvent& event);
  void pointerLeft();
  void sketchKey(longarm::vision::SketchKey key, const longarm::vision::KeyModifiers& modifiers);
  void zoomChanged(double scale);
  void menuRequested(const QPoint& global_position);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void keyReleaseEvent(QKeyEvent* event) override;
  void focusOutEvent(QFocusEvent* event) override;
  bool focusNextPrevChild(bool next) override;

 private:
  enum class Gesture { kNone, kTool, kPan };

  void refreshShown();
  void viewChanged();
  void emitPointer(vision::PointerPhase phase, const QPointF& position);
  void repeatWithModifiers();
  std::optional<Eigen::Vector2d> shownOfRaw(const Eigen::Vector2d& raw) const;
  Eigen::Vector2d loupeCentre() const;
  void paintAge(QPainter& painter);
  void paintEmpty(QPainter& painter);
  void paintLoupeOver(QPainter& painter);
  OverlayLook overlayLook() const;
  void updateChanged(const vision::Overlay& before, const vision::Overlay& after);
  void updateLoupe();
  QRect loupeArea(const QPointF& middle) const;

  vision::PaneSide m_side;
  Theme m_theme = Theme::dark();
  cv::Mat m_raw;
  QString m_empty_text;
  std::optional<LensMap> m_lens;
  bool m_undistorted = false;
  PictureLayer m_layer;
  CanvasView m_view;
  bool m_fitted = true;                  // follows the widget's size until zoomed or panned
  vision::Overlay m_overlay, m_path;
  QRect m_loupe_painted;                 // where the loupe stands on screen, empty: nowhere
  std::optional<double> m_age;
  Freshness m_freshness = Freshness::kFresh;
  Gesture m_gesture = Gesture::kNone;
  QPointF m_position, m_press_position;
  Qt::MouseButtons m_buttons = Qt::NoButton;
  vision::KeyModifiers m_modifiers;
  bool m_inside = false;
  QElapsedTimer m_since_nudge;
};

}  // namespace longarm::widgets
