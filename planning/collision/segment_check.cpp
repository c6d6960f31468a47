// The continuous check of CollisionWorld: see segmentFree() in collision_world.h.
#include <cmath>
#include <deque>
#include <utility>

#include "planning/collision/collision_bodies.h"

namespace longarm::planning {
namespace {

using internal::Pair;
using internal::PlacedState;

constexpr double kUndecided = 1e-4;      // [m] of motion
constexpr double kPiece = 0.3;           // longest motion of a joint that is looked at in one go [rad or m]
constexpr double kMostPieces = 64;

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

}  // namespace

bool CollisionWorld::Impl::pieceFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact) const {
  const Eigen::VectorXd dq = b - a;
  placeAll(a, at_start);
  placeAll(b, at_end);
  const auto meets = [&](const Pair& pair, double d) {
    if (d > padding(pair)) return false;
    report(pair, d, contact);
    return true;
  };
  Interval whole;
  const internal::LookedAt& look = lookedAt();
  const Eigen::VectorXd ways = look.reach * dq.cwiseAbs();
  for (std::size_t i = 0; i < look.pairs.size(); ++i) {
    const Pair& pair = pairs[static_cast<std::size_t>(look.pairs[i])];
    const double pad = look.self[i] != 0 ? options.self_padding : options.padding, way = ways[static_cast<Eigen::Index>(i)];
    if (coverBound(pair.a, pair.b, at_start) > way + pad) continue;     // whatever the end is like
    Doubt doubt{&pair, way, bound(pair, at_start), bound(pair, at_end)};
    if (doubt.at_start > pad && doubt.at_end > pad && doubt.at_start + doubt.at_end - pad > doubt.way) continue;
    const double cap = doubt.way + 2 * pad + 1e-3;
    if (doubt.at_start <= cap) doubt.at_start = clearance(pair, at_start, cap);
    if (meets(pair, doubt.at_start)) return false;
    if (doubt.at_start + std::max(doubt.at_end, pad) - pad > doubt.way && doubt.at_end > pad) continue;
    if (doubt.at_end <= cap) doubt.at_end = clearance(pair, at_end, cap);
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
        d = clearance(pair, state, way + 2 * pad + 1e-3);
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

// States first, those in the middle before the others: most motions that touch are found out so.
bool CollisionWorld::segmentFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact) const {
  const Eigen::VectorXd way = b - a;
  const double pieces_wanted = std::min(std::ceil(way.cwiseAbs().maxCoeff() / kPiece), kMostPieces);
  int pieces = 1;
  while (pieces < pieces_wanted) pieces *= 2;
  const auto at = [&](int i) { return Eigen::VectorXd(a + way * (static_cast<double>(i) / pieces)); };
  for (int step = pieces / 2; step > 0; step /= 2) {
    for (int i = step; i < pieces; i += 2 * step) {
      if (inCollision(at(i), contact)) return false;
    }
  }
  for (int i = 0; i < pieces; ++i) {
    if (!m_impl->pieceFree(i == 0 ? a : at(i), i + 1 == pieces ? b : at(i + 1), contact)) return false;
    std::swap(m_impl->at_start, m_impl->at_end);         // the next piece begins there
  }
  return true;
}

}  // namespace longarm::planning
