#include "widgets/picture_layer.h"

#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace longarm::widgets {

namespace {

constexpr double kShowPixelsFrom = 6;      // scale from which single pixels are shown as squares

// No detach: a shared picture is read where it is.
cv::Mat constMatOf(const QImage& image) {
  return {image.height(), image.width(), CV_8UC4, const_cast<uchar*>(image.constBits()),
          static_cast<std::size_t>(image.bytesPerLine())};
}

bool isWhole(double value) { return std::abs(value - std::round(value)) < 1e-6; }

}  // namespace

cv::Mat matOf(QImage& image) {
  return {image.height(), image.width(), CV_8UC4, image.bits(), static_cast<std::size_t>(image.bytesPerLine())};
}

QImage toQImage(const cv::Mat& picture) {
  if (picture.empty() || picture.depth() != CV_8U) return {};
  QImage image(picture.cols, picture.rows, QImage::Format_RGB32);
  cv::Mat target = matOf(image);
  switch (picture.channels()) {
    case 1: cv::cvtColor(picture, target, cv::COLOR_GRAY2BGRA); return image;
    case 3: cv::cvtColor(picture, target, cv::COLOR_BGR2BGRA); return image;
    case 4: picture.copyTo(target); return image;
    default: return {};
  }
}

void PictureLayer::setPicture(QImage picture) {
  m_picture = std::move(picture);
  m_halves.clear();
  m_dirty = true;
}

// Below half size a linear filter would skip pixels: start from a picture that was halved by averaging.
const QImage& PictureLayer::level(double device_scale, double& level_scale) {
  level_scale = 1;
  const QImage* chosen = &m_picture;
  for (std::size_t i = 0; device_scale / level_scale <= 0.5 && chosen->width() > 2 && chosen->height() > 2; ++i) {
    if (i == m_halves.size()) {
      QImage half((chosen->width() + 1) / 2, (chosen->height() + 1) / 2, QImage::Format_RGB32);
      cv::Mat target = matOf(half);
      cv::resize(constMatOf(*chosen), target, target.size(), 0, 0, cv::INTER_AREA);
      m_halves.push_back(half);
    }
    chosen = &m_halves[i];
    level_scale /= 2;
  }
  return *chosen;
}

void PictureLayer::resample(const CanvasView& view, const QSize& device_size, double ratio,
                            const QColor& background) {
  ++m_resampled;
  if (m_layer.size() != device_size) m_layer = QImage(device_size, QImage::Format_RGB32);
  const double device_scale = view.scale() * ratio;
  double nominal = 1;
  const QImage& source = level(device_scale, nominal);
  const double scale_u = device_scale * m_picture.width() / source.width();
  const double scale_v = device_scale * m_picture.height() / source.height();
  // Centre-origin positions on both sides: source = (target + 0.5 - offset) / scale - 0.5.
  const cv::Matx23d inverse(1 / scale_u, 0, (0.5 - view.offset().x() * ratio) / scale_u - 0.5,
                            0, 1 / scale_v, (0.5 - view.offset().y() * ratio) / scale_v - 0.5);
  cv::Mat target = matOf(m_layer);
  const int filter = device_scale >= kShowPixelsFrom ? cv::INTER_NEAREST : cv::INTER_LINEAR;
  cv::warpAffine(constMatOf(source), target, inverse, target.size(),
                 filter | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT,
                 cv::Scalar(background.blue(), background.green(), background.red(), 255));
  m_layer.setDevicePixelRatio(ratio);
}

void PictureLayer::paint(QPainter& painter, const CanvasView& view, const QSize& widget,
                         double device_pixel_ratio, const QColor& background) {
  if (m_picture.isNull()) {
    painter.fillRect(QRect(QPoint(0, 0), widget), background);
    return;
  }
  const QPointF corner = view.offset() * device_pixel_ratio;
  const bool one_to_one = std::abs(view.scale() * device_pixel_ratio - 1) < 1e-9 && isWhole(corner.x()) && isWhole(corner.y());
  if (one_to_one) {
    const QRectF area(view.offset(), QSizeF(m_picture.size()) / device_pixel_ratio);
    if (!area.contains(QRectF(QPointF(0, 0), QSizeF(widget)))) {
      painter.fillRect(QRect(QPoint(0, 0), widget), background);
    }
    painter.drawImage(area, m_picture);
    return;
  }
  const QSize device_size = (QSizeF(widget) * device_pixel_ratio).toSize();
  const bool same = !m_dirty && m_layer.size() == device_size && m_scale == view.scale() && m_offset == view.offset() &&
                    m_ratio == device_pixel_ratio && m_background == background.rgb();
  if (!same && !device_size.isEmpty()) {
    resample(view, device_size, device_pixel_ratio, background);
    m_scale = view.scale();
    m_offset = view.offset();
    m_ratio = device_pixel_ratio;
    m_background = background.rgb();
    m_dirty = false;
  }
  painter.drawImage(QPointF(0, 0), m_layer);
}

}  // namespace longarm::widgets
