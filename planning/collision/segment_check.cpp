// The continuous check of CollisionWorld: see segmentFree() in collision_world.h.
#include <cmath>
#include <deque>

#include "planning/collision/collision_bodies.h"

namespace longarm::planning {
namespace {

using internal::Pair;
using internal::PlacedState;

constexpr double kUndecided = 1e-4;      // [m] of motion

// One pair on one interval: lower bounds of its distance at both ends, way it can move over the whole segment.
struct Doubt {
  const Pair* pair;
  double way;
  double at_start, at_end;
};

struct Interval {
  double start = 0, end = 1;
  std::vector<Doubt> doubts;
};

double wayOf(const Pair& pair, const Eigen::VectorXd& dq) {
  double way = 0;
  for (const auto& [index, reach] : pair.bound) way += reach * std::abs(dq[index]);
  return way;
}

}  // namespace

bool CollisionWorld::Impl::segmentFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact) const {
  const Eigen::VectorXd dq = b - a;
  PlacedState first, second;
  placeAll(a, first);
  placeAll(b, second);
  const auto meets = [&](const Pair& pair, double d) {
    if (d > padding(pair)) return false;
    report(pair, d, contact);
    return true;
  };
  Interval whole;
  for (const auto& pair : pairs) {
    if (!active(pair)) continue;
    const double pad = padding(pair);
    Doubt doubt{&pair, wayOf(pair, dq), bound(pair, first), bound(pair, second)};
    if (doubt.at_start > pad && doubt.at_end > pad && doubt.at_start + doubt.at_end - pad > doubt.way) continue;
    const double cap = doubt.way + 2 * pad + 1e-3;
    if (doubt.at_start <= cap) doubt.at_start = distance(pair, first, cap);
    if (meets(pair, doubt.at_start)) return false;
    if (doubt.at_start + std::max(doubt.at_end, pad) - pad > doubt.way && doubt.at_end > pad) continue;
    if (doubt.at_end <= cap) doubt.at_end = distance(pair, second, cap);
    if (meets(pair, doubt.at_end)) return false;
    if (doubt.at_start + doubt.at_end - pad > doubt.way) continue;
    whole.doubts.push_back(doubt);
  }
  std::deque<Interval> open;
  if (!whole.doubts.empty()) open.push_back(std::move(whole));
  PlacedState& state = scratch;
  while (!open.empty()) {                // widest first: a hit is found early
    const Interval interval = std::move(open.front());
    open.pop_front();
    const double middle = 0.5 * (interval.start + interval.end), half = 0.5 * (interval.end - interval.start);
    placeAll(a + middle * dq, state);
    Interval left{interval.start, middle, {}}, right{middle, interval.end, {}};
    for (const Doubt& doubt : interval.doubts) {
      const Pair& pair = *doubt.pair;
      const double pad = padding(pair), way = doubt.way * half;
      const auto undecided = [&](double outer, double d) { return outer + d - pad <= way; };
      double d = bound(pair, state);
      if (d <= pad || undecided(doubt.at_start, d) || undecided(doubt.at_end, d)) {
        d = distance(pair, state, way + 2 * pad + 1e-3);
        if (meets(pair, d)) return false;
      }
      const bool in_left = undecided(doubt.at_start, d), in_right = undecided(d, doubt.at_end);
      if ((in_left || in_right) && way < kUndecided) {
        report(pair, d, contact);
        return false;
      }
      if (in_left) left.doubts.push_back({&pair, doubt.way, doubt.at_start, d});
      if (in_right) right.doubts.push_back({&pair, doubt.way, d, doubt.at_end});
    }
    if (!left.doubts.empty()) open.push_back(std::move(left));
    if (!right.doubts.empty()) open.push_back(std::move(right));
  }
  return true;
}

}  // namespace longarm::planning
