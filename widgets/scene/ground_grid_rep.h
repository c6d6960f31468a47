#pragma once

/// @file
/// The ground as a grid, and coordinate axes.

#include <memory>
#include <string>

#include "core/pose.h"
#include "widgets/scene/representation.h"

namespace longarm::scene {

/// Lines on z = 0 (or another height), every metre stronger.
class GroundGridRep final : public Representation {
 public:
  GroundGridRep();
  ~GroundGridRep() override;
  /// @param half_size from the origin to the edge [m], 0 < it <= 100; @param spacing of the lines [m], >= half_size / 500.
  void update(double half_size, double spacing, double height = 0,
              const Eigen::Vector3d& color = Eigen::Vector3d(0.42, 0.45, 0.5));

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Red x, green y, blue z.
class AxesRep final : public Representation {
 public:
  AxesRep();
  ~AxesRep() override;
  void update(const Pose& X_WA, double length, double line_width = 2);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::scene
