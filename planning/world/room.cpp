#include "planning/world/room.h"

#include <algorithm>

namespace longarm::planning {

bool hasRoom(const Workcell& workcell) {
  return std::any_of(workcell.objects.begin(), workcell.objects.end(),
                     [](const WorldObject& object) { return object.attached_link.empty(); });
}

std::shared_ptr<const Workcell> withBaseAt(const std::shared_ptr<const Workcell>& workcell, const Pose& X_OB) {
  if (!workcell || !hasRoom(*workcell) || X_OB.matrix() == Pose::Identity().matrix()) return workcell;
  auto moved = std::make_shared<Workcell>(*workcell);
  const Pose X_BO = X_OB.inverse();
  for (auto& object : moved->objects) {
    if (object.attached_link.empty()) object.X_WO = X_BO * object.X_WO;
  }
  return moved;
}

}  // namespace longarm::planning
