#include "planning/macros/macro.h"

#include <algorithm>

#include "planning/macros/canned_motion.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/grab_pipe.h"
#include "planning/macros/move_to.h"

namespace longarm::planning {

ReachAnswer Macro::reach(const PlanContext&, const vision::Feature&, const ReachSeed&) const { return {}; }

std::vector<std::unique_ptr<Macro>> makeMacros(const Workcell& workcell) {
  std::vector<std::unique_ptr<Macro>> out;
  // The usual ones in the order an operator uses them, then the workcell's own by name.
  std::vector<std::string> names{"home", "stow", "ready", "look_ahead"};
  const auto usual = static_cast<long>(names.size());
  for (const auto& [name, joints] : workcell.poses) {
    if (std::find(names.begin(), names.begin() + usual, name) == names.begin() + usual) names.push_back(name);
  }
  for (const auto& name : names) {
    const auto pose = workcell.poses.find(name);
    if (pose != workcell.poses.end()) out.push_back(std::make_unique<CannedMotion>(name, pose->second));
  }
  out.push_back(std::make_unique<MoveTo>(workcell));
  out.push_back(makeLookAt(workcell));
  out.push_back(makeTouch());
  out.push_back(makeMoveAbove());
  out.push_back(makePlaceHere());
  out.push_back(std::make_unique<GrabPipe>());
  out.push_back(makeMoveAroundAxis());
  out.push_back(makeApproachFromSide());
  out.push_back(makeMoveParallel());
  out.push_back(makeAimAlongAxis());
  out.push_back(makePlaceDisruptor());
  out.push_back(makeInsertAlong());
  out.push_back(makeExtractAlong());
  out.push_back(makeSurfaceScan());
  out.push_back(makeFollowPerimeter());
  out.push_back(makePress());
  out.push_back(makeWipe());
  out.push_back(makeGraspByFaces());
  out.push_back(makePushFace());
  out.push_back(makeScanFaces());
  out.push_back(makeLookAround());
  return out;
}

const Macro* findMacro(const std::vector<std::unique_ptr<Macro>>& macros, const std::string& name) {
  for (const auto& macro : macros) {
    if (macro->info().name == name) return macro.get();
  }
  return nullptr;
}

}  // namespace longarm::planning
