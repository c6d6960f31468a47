#pragma once

/// @file
/// CompareDialog: fades between two pictures, or blinks, so that what has moved shows.

#include <QDialog>
#include <QTimer>
#include <opencv2/core/mat.hpp>

#include "vision/snapshot/view.h"
#include "widgets/image_canvas.h"

class QSlider;
class QToolButton;

namespace longarm::ui {

/// Not modal.  GUI thread only.
class CompareDialog final : public QDialog {
  Q_OBJECT

 public:
  /// @pre both are there and of one size
  CompareDialog(const vision::SnapshotPtr& a, const vision::SnapshotPtr& b, const widgets::Theme& theme, QWidget* parent = nullptr);
  QSlider* slider() const { return m_slider; }
  /// While it is down the two are shown in turn, twice a second.
  QToolButton* blinkButton() const { return m_blink; }
  /// What is shown: a share of b over a, as grey or colour.
  const cv::Mat& shown() const { return m_shown; }

 private:
  void blend(int percent);
  void setBlinking(bool on);

  cv::Mat m_a, m_b, m_shown;
  widgets::ImageCanvas* m_canvas;
  QSlider* m_slider;
  QToolButton* m_blink;
  QTimer m_timer;
};

}  // namespace longarm::ui
