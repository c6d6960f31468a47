#pragma once

/// @file
/// PictureLayer: a picture resampled to the widget once, so that repaints while dragging only copy it.

#include <vector>

#include <QColor>
#include <QImage>
#include <QPainter>
#include <opencv2/core/mat.hpp>

#include "widgets/canvas_view.h"

namespace longarm::widgets {

/// Grey, BGR or BGRA, 8 bit, to an image of format RGB32.  Any other kind gives a null image.
QImage toQImage(const cv::Mat& picture);
/// BGRA view onto a Format_RGB32 image; shares its memory.
cv::Mat matOf(QImage& image);

/// Draws a picture under a CanvasView.  GUI thread only.
class PictureLayer {
 public:
  /// @param picture Format_RGB32, or null for none.
  void setPicture(QImage picture);
  const QImage& picture() const { return m_picture; }
  bool empty() const { return m_picture.isNull(); }

  /// Paints the picture and the background around it over the whole widget.  Resamples only when picture,
  /// view, size, background or device pixel ratio changed since the last call.
  void paint(QPainter& painter, const CanvasView& view, const QSize& widget, double device_pixel_ratio,
             const QColor& background);
  /// How often the picture was resampled: lets a test see that a drag does not.
  int resampleCount() const { return m_resampled; }

 private:
  const QImage& level(double device_scale, double& level_scale);
  void resample(const CanvasView& view, const QSize& device_size, double ratio, const QColor& background);

  QImage m_picture;
  std::vector<QImage> m_halves;          // 1/2, 1/4, ... of the picture, made when needed
  QImage m_layer;
  double m_scale = 0, m_ratio = 0;
  QPointF m_offset;
  QRgb m_background = 0;
  bool m_dirty = true;
  int m_resampled = 0;
};

}  // namespace longarm::widgets
