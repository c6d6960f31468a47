#include "planning/motion/plan.h"

namespace longarm::planning {

const char* toString(PlanStatus status) {
  switch (status) {
    case PlanStatus::kOk: return "ok";
    case PlanStatus::kBadFeature: return "bad_feature";
    case PlanStatus::kUnreachable: return "unreachable";
    case PlanStatus::kStartInCollision: return "start_in_collision";
    case PlanStatus::kGoalInCollision: return "goal_in_collision";
    case PlanStatus::kApproachBlocked: return "approach_blocked";
    case PlanStatus::kNoPath: return "no_path";
    case PlanStatus::kLimits: return "limits";
    case PlanStatus::kTimeout: return "timeout";
    case PlanStatus::kCancelled: return "cancelled";
  }
  return "unknown";
}

}  // namespace longarm::planning
