#pragma once

/// @file
/// Move Tool To: a free motion to a typed pose of the tool.

#include <map>
#include <string>

#include "planning/macros/macro.h"
#include "planning/macros/standing_defaults.h"

namespace longarm::planning {

/// Takes no feature.  The tool's origin goes to x, y, z [m] in the robot's root frame, turned by roll, pitch, yaw [rad] about the
/// root's fixed axes x, y, z in this order (as poseFromRpy()).  Each that is not given stays as it is at the start.
class MoveTo final : public Macro, public StandingDefaults {
 public:
  explicit MoveTo(const Workcell& workcell);
  MacroInfo info() const override;
  /// kUnreachable and kGoalInCollision come with advice that was tried out: how the tool can be held there instead, and how far it
  /// gets with that orientation.
  Plan plan(const PlanContext& context, const vision::Feature* feature) const override;
  std::map<std::string, double> defaultsAt(const Workcell& workcell, const Eigen::VectorXd& q) const override;

 private:
  std::map<std::string, double> m_usual;   // defaults where nothing tells where the tool is
};

}  // namespace longarm::planning
