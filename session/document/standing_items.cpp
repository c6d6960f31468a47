#include "session/document/standing_items.h"

#include <algorithm>

#include "core/base_motion.h"

namespace longarm::session {
namespace {

WorldItem standing(WorldItem item, const BaseState& now) {
  const Pose X_now_then = poseOf(now).inverse() * poseOf(*item.base);
  item.X_WO = X_now_then * item.X_WO;
  double reach = item.points.empty() ? item.X_WO.translation().norm() : 0;
  for (auto& point : item.points) {
    point = X_now_then * point;
    reach = std::max(reach, point.norm());
  }
  const BaseShift shift = shiftBetween(*item.base, now);
  item.margin_m += kOdometryShare * (shift.way + shift.turn * reach);
  return item;
}

}  // namespace

std::vector<WorldItem> standingItems(const Document& document) {
  std::vector<WorldItem> items = document.world();
  for (auto& item : items) {
    if (document.stale(item)) item = standing(std::move(item), *document.base());
  }
  return items;
}

}  // namespace longarm::session
