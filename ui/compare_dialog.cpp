#include "ui/compare_dialog.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>
#include <opencv2/imgproc.hpp>

namespace longarm::ui {

namespace {

constexpr int kBlink_ms = 500;

cv::Mat coloured(const cv::Mat& picture) {
  if (picture.channels() == 3) return picture;
  cv::Mat colour;
  cv::cvtColor(picture, colour, picture.channels() == 4 ? cv::COLOR_BGRA2BGR : cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace

CompareDialog::CompareDialog(const vision::SnapshotPtr& a, const vision::SnapshotPtr& b, const widgets::Theme& theme, QWidget* parent)
    : QDialog(parent), m_a(coloured(a->image)), m_b(coloured(b->image)), m_canvas(new widgets::ImageCanvas(vision::PaneSide::kLeft, this)),
      m_slider(new QSlider(Qt::Horizontal, this)), m_blink(new QToolButton(this)) {
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
  row->addWidget(m_blink);
  m_blink->setText(tr("Blink"));
  m_blink->setCheckable(true);
  m_blink->setToolTip(tr("Show the two in turn: what has moved jumps"));
  connect(m_blink, &QToolButton::toggled, this, &CompareDialog::setBlinking);
  m_timer.setInterval(kBlink_ms);
  connect(&m_timer, &QTimer::timeout, this, [this] { m_slider->setValue(m_slider->value() < 50 ? 100 : 0); });
  m_slider->setRange(0, 100);
  m_slider->setValue(50);
  connect(m_slider, &QSlider::valueChanged, this, &CompareDialog::blend);
  blend(50);
}

void CompareDialog::setBlinking(bool on) {
  m_slider->setEnabled(!on);
  if (!on) return m_timer.stop();
  m_slider->setValue(0);
  m_timer.start();
}

void CompareDialog::blend(int percent) {
  cv::Mat mixed;
  cv::addWeighted(m_a, 1 - percent / 100.0, m_b, percent / 100.0, 0, mixed);
  m_shown = mixed;
  m_canvas->setPicture(m_shown);
}

}  // namespace longarm::ui
