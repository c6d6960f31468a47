#pragma once

/// @file
/// Draws a plan: the trail of the tool, the elbows' trail, ghosts along it, and one ghost at the cursor.

#include <memory>
#include <string>
#include <vector>

#include "core/pose.h"
#include "planning/motion/plan.h"
#include "planning/robot/robot_model.h"
#include "widgets/scene/representation.h"

namespace longarm::scene {

struct PlanLook {
  double ghost_opacity = 0.35;
  Eigen::Vector3d ghost_tint{0.35, 0.75, 1.0};      ///< RGB 0 ... 1
  Eigen::Vector3d trail_color{0.361, 0.941, 0.549};   ///< Of a plan that does not tell its clearance.
  int trail_samples = 160;                          ///< Points of the tool's trail.
  int swept_ghosts = 0;                             ///< Still ghosts spread over the path (the swept trail); 0: none.
  bool axes_at_stages = true;                       ///< Small tool axes where a stage begins and ends.
};

/// A preview of a plan.  The trail has the colours of its clearance (clearance_look.h).
class PlanRep final : public Representation {
 public:
  /// @param tip_link the tool frame whose trail is drawn.  Unknown: no trail.
  PlanRep(std::shared_ptr<const planning::RobotModel> model, const std::string& tip_link);
  ~PlanRep() override;

  void addTo(vtkRenderer* renderer) override;
  void removeFrom(vtkRenderer* renderer) override;
  void setVisible(bool visible) override;
  /// A plan that is not ok draws only its failed pose: axes in an amber cage.
  void update(const planning::Plan& plan);
  void clear();
  /// Puts the ghost at time t of the trajectory [s] (clamped).
  void scrub(double t);
  void setGhostVisible(bool visible);
  void setLook(const PlanLook& look);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Tool poses X_WT at `samples` equal steps of the trajectory; empty if it is.  Pure function.
std::vector<Pose> toolTrail(const planning::RobotModel& model, const std::string& tip_link,
                            const planning::Plan& plan, int samples);

}  // namespace longarm::scene
