#pragma once

/// @file
/// KnownGeometry: surfaces whose place is known, for calibration points to stick to.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/calibration/landmarks.h"
#include "session/document/world_item.h"

namespace longarm::session {

/// Where a ray meets known geometry.
struct GeometryPoint {
  enum class Kind { kCorner, kEdge, kSurface };
  Kind kind = Kind::kSurface;
  Landmark landmark;                       ///< Without a name.
  double distance_m = 0;                   ///< From where the ray begins.
};
const char* toString(GeometryPoint::Kind kind);   ///< "corner", "edge", "surface"

/// Bodies of a workcell, the links of its robot as they are drawn, and what was sketched into the world.  Corners and edges
/// are those of boxes, the rims of cylinders, and where neighbouring facets of a mesh meet at more than 25 degrees.
/// Immutable but for what moves: const methods are thread-safe.
class KnownGeometry {
 public:
  using Serves = std::function<bool(const std::string& thing, const std::string& link)>;
  using Segment = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

  KnownGeometry() = default;
  /// @param sketched Those in the robot's root frame count.
  KnownGeometry(std::shared_ptr<const planning::Workcell> workcell, const std::vector<WorldItem>& sketched);

  /// An object of the workcell stands elsewhere than its file says.
  void place(const std::string& object, const Pose& X_WO);

  /// What a ray of the root frame points at: a corner in sight within `snap_rad` of the ray, else an edge, else the first
  /// surface that it meets.  What is nearer than 30 mm hides nothing: the housing around a lens.
  /// @param along Unit vector.  @param serves Which bodies a point may stick to; the others only hide.
  std::optional<GeometryPoint> pointOn(const Eigen::Vector3d& from, const Eigen::Vector3d& along, double snap_rad, const Eigen::VectorXd& q,
                                       const Serves& serves) const;
  /// Sharp edges in the root frame.  @param serves Of which bodies.
  std::vector<Segment> edges(const Eigen::VectorXd& q, const Serves& serves) const;

 private:
  struct Body {
    std::string thing, link;
    Pose X_LO = Pose::Identity();
    planning::Shape shape;
    double radius = 0;                     // around the shape's origin
    std::vector<Eigen::Vector3d> corners;  // in the shape's frame
    std::vector<Segment> edges;
  };
  struct Sight;
  void add(const std::string& thing, const std::string& link, const Pose& X_LO, const planning::Shape& shape);
  std::vector<Pose> places(const Eigen::VectorXd& q) const;
  std::optional<std::pair<std::size_t, double>> firstHit(const Sight& sight, const Eigen::Vector3d& along) const;
  bool inSight(const Sight& sight, const Eigen::Vector3d& p_W) const;

  std::shared_ptr<const planning::Workcell> m_workcell;
  std::vector<Body> m_bodies;
};

}  // namespace longarm::session
