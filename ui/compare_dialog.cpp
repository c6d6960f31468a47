#include "ui/compare_dialog.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QSlider>
#include <QVBoxLayout>
#include <opencv2/imgproc.hpp>

namespace longarm::ui {

namespace {

cv::Mat coloured(const cv::Mat& picture) {
  if (picture.channels() == 3) return picture;
  cv::Mat colour;
  cv::cvtColor(picture, colour, picture.channels() == 4 ? cv::COLOR_BGRA2BGR : cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace

CompareDialog::CompareDialog(const vision::SnapshotPtr& a, const vision::SnapshotPtr& b, const widgets::Theme& theme, QWidget* parent)
    : QDialog(parent), m_a(coloured(a->image)), m_b(coloured(b->image)), m_canvas(new widgets::ImageCanvas(vision::PaneSide::kLeft, this)),
      m_slider(new QSlider(Qt::Horizontal, this)) {
  setModal(false);
  setWindowTitle(tr("Compare"));
  resize(760, 620);
  m_canvas->setTheme(theme);
  auto* column = new QVBoxLayout(this);
  column->addWidget(m_canvas, 1);
  auto* row = new QHBoxLayout;
  column->addLayout(row);
  row->addWidget(new QLabel(QString::fromStdString(a->view.name), this));
  row->addWidget(m_slider, 1);
  row->addWidget(new QLabel(QString::fromStdString(b->view.name), this));
  m_slider->setRange(0, 100);
  m_slider->setValue(50);
  connect(m_slider, &QSlider::valueChanged, this, &CompareDialog::blend);
  blend(50);
}

void CompareDialog::blend(int percent) {
  cv::Mat mixed;
  cv::addWeighted(m_a, 1 - percent / 100.0, m_b, percent / 100.0, 0, mixed);
  m_shown = mixed;
  m_canvas->setPicture(m_shown);
}

}  // namespace longarm::ui
