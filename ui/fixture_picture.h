#pragma once

/// @file
/// FixturePicture: a fixture's points in 3-D, to tell which is which.

#include <set>

#include <QWidget>

#include "calibration/fixture/fixture_file.h"
#include "core/pose.h"
#include "ui/appearance.h"

namespace longarm::ui {

/// Drawn in parallel projection; drag turns it, a click chooses the nearest point.  GUI thread only.
class FixturePicture final : public QWidget {
  Q_OBJECT

 public:
  explicit FixturePicture(Appearance& appearance, QWidget* parent = nullptr);
  void setFixture(const calibration::Fixture& fixture);
  void setMarks(int chosen, const std::set<std::size_t>& placed);
  QSize sizeHint() const override { return {300, 150}; }
  QPointF placeOf(std::size_t point) const;

 Q_SIGNALS:
  void chosen(int point);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;

 private:
  Appearance& m_appearance;
  calibration::Fixture m_fixture;
  Eigen::Vector3d m_middle = Eigen::Vector3d::Zero();
  double m_radius = 1, m_turn = 0.6, m_tilt = 0.5;
  int m_chosen = -1;
  std::set<std::size_t> m_placed;
  QPoint m_press, m_last;
};

}  // namespace longarm::ui
