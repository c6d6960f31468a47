#pragma once

/// @file
/// Which of the robot's own links a camera sees, and where: predicted from the model, so that nobody measures the arm by mistake.

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "planning/robot/robot_model.h"
#include "vision/snapshot/view.h"

namespace longarm::planning {

/// A coarse picture of the links, one cell for a square of raw pixels.
struct LinkMask {
  int cell_px = 4;                       ///< Edge of a cell [raw px].
  int columns = 0, rows = 0;
  std::vector<std::int16_t> links;       ///< Nearest link per cell, row by row: its index in the model, or -1.
  std::vector<float> depths;             ///< z of it in the camera [m]; infinite where there is none.

  bool empty() const { return links.empty(); }
  /// Link at a raw pixel ((0, 0): centre of the first); -1: none, or off the picture.
  int linkAt(const Eigen::Vector2d& pixel) const;
  /// Its depth [m]; infinite where there is none.
  double depthAt(const Eigen::Vector2d& pixel) const;
  /// Share of the disc about a pixel that links cover which are nearer than `depth` [m], 0 ... 1; of what lies on the picture.
  double coveredAbout(const Eigen::Vector2d& pixel, double radius_px, double depth) const;

 private:
  int cellAt(const Eigen::Vector2d& pixel) const;
};

/// Triangles of a robot's visible shapes (collision shapes where a link has no others), made once.  Thread-safe.
class LinkSilhouettes {
 public:
  explicit LinkSilhouettes(std::shared_ptr<const RobotModel> model);

  const RobotModel& model() const { return *m_model; }
  /// Nearest link per cell, through the camera's full lens.  Surfaces nearer than 20 mm are not seen, as the back of a closed
  /// primitive is not: a camera may sit in its own housing.
  /// @param q Configuration at the exposure, dof() values.  @param view Placed in the model's root link.
  /// @returns kInvalidInput: another parent frame, a camera without a size, or a configuration of another length.
  Result<LinkMask> maskOf(const Eigen::VectorXd& q, const vision::View& view, int cell_px = 4) const;

 private:
  struct Part {
    int link = 0;
    bool closed = false;                 // A primitive, whose back is never seen.
    std::shared_ptr<const TriangleMesh> mesh;
    Pose X_LS = Pose::Identity();
  };
  std::shared_ptr<const RobotModel> m_model;
  std::vector<Part> m_parts;
};

}  // namespace longarm::planning
