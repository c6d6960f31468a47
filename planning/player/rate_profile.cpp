#include "planning/player/rate_profile.h"

#include <algorithm>
#include <cmath>

namespace longarm::planning::internal {
namespace {

// State s seconds after `a` when u changes at the rate `jerk`.
RateState advance(const RateState& a, double jerk, double s) {
  RateState b;
  b.u = a.u + jerk * s;
  b.r = a.r + s * (a.u + 0.5 * jerk * s);
  b.tau = a.tau + s * (a.r + s * (0.5 * a.u + jerk * s / 6));
  return b;
}

// Share of the acceleration limit that a plan uses at rate 1, as the planner's nominal limits have it.
constexpr double kPlannedShare = 0.125;

// How hard to brake when `left` (0 ... 1) of the braking time remains.  Following the path at rate r takes up
// to share r^2 of the acceleration limit, so r' = -(1 - share r^2) / beta uses what is left, whose solution
// is r = tanh(.) / sqrt(share); its derivative is this, up to a factor.
double brakingWeight(double r, double left) {
  const double root = std::sqrt(kPlannedShare);
  const double argument = std::atanh(std::min(std::abs(r) * root, 0.9)) * left;
  return 1 / (std::cosh(argument) * std::cosh(argument));
}

}  // namespace

RateProfile::RateProfile(const PathStretch& stretch, double t, const RateState& state)
    : m_stretch(stretch), m_knots{{t, state}} {}

bool RateProfile::leavesPath(const RateState& state) const {
  return (state.tau < m_stretch.low && state.r < 0) || (state.tau > m_stretch.high && state.r > 0);
}

void RateProfile::append(double h, double u_end) {
  if (m_met_end) return;
  const Knot start = m_knots.back();
  const double jerk = (u_end - start.state.u) / h;
  constexpr int kParts = 8;
  for (int i = 1; i <= kParts; ++i) {
    double high = h * i / kParts;
    if (!leavesPath(advance(start.state, jerk, high))) continue;
    double low = h * (i - 1) / kParts;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (leavesPath(advance(start.state, jerk, middle)) ? high : low) = middle;
    }
    RateState end = advance(start.state, jerk, high);
    end.tau = end.r < 0 ? m_stretch.low : m_stretch.high;
    m_knots.push_back({start.t + high, end});
    m_met_end = true;
    return;
  }
  RateState end = advance(start.state, jerk, h);
  end.u = u_end;
  m_knots.push_back({start.t + h, end});
}

void RateProfile::appendBraking(double h, int pieces) {
  if (m_met_end) return;
  const RateState start = m_knots.back().state;
  std::vector<double> weights;
  double sum = 0;
  for (int i = 1; i < pieces; ++i) {
    weights.push_back(brakingWeight(start.r, 1 - static_cast<double>(i) / pieces));
    sum += weights.back();
  }
  const double b = (start.r / h + 0.5 * start.u) / sum;  // Area under the linear pieces takes r to 0.
  for (const double weight : weights) append(h, -b * weight);
  append(h, 0);
  if (!m_met_end) m_knots.back().state.r = 0;
}

RateState RateProfile::restAtEnd() const {
  RateState rest;
  rest.tau = std::clamp(m_knots.back().state.tau, m_stretch.low, m_stretch.high);
  return rest;
}

RateState RateProfile::between(std::size_t piece, double s) const {
  const Knot& a = m_knots[piece];
  const Knot& b = m_knots[piece + 1];
  return advance(a.state, (b.state.u - a.state.u) / (b.t - a.t), s);
}

RateState RateProfile::at(double t) const {
  if (t >= m_knots.back().t) return restAtEnd();
  if (t <= m_knots.front().t) return m_knots.front().state;
  const auto next = std::upper_bound(m_knots.begin(), m_knots.end(), t,
                                     [](double value, const Knot& knot) { return value < knot.t; });
  const auto piece = static_cast<std::size_t>(next - m_knots.begin() - 1);
  return between(piece, t - m_knots[piece].t);
}

RateProfile RateProfile::upTo(double t) const {
  RateProfile part(m_stretch, m_knots.front().t, m_knots.front().state);
  for (std::size_t i = 1; i < m_knots.size() && m_knots[i].t < t - 1e-6; ++i)
    part.m_knots.push_back(m_knots[i]);
  if (t > part.endTime()) part.m_knots.push_back({t, at(t)});
  return part;
}

void RateProfile::forgetBefore(double t) {
  const auto next = std::upper_bound(m_knots.begin(), m_knots.end(), t,
                                     [](double value, const Knot& knot) { return value < knot.t; });
  if (next - m_knots.begin() > 1) m_knots.erase(m_knots.begin(), next - 1);
}

void RateProfile::extendBy(const RateProfile& other) {
  m_knots.insert(m_knots.end(), other.m_knots.begin() + 1, other.m_knots.end());
  m_met_end = other.m_met_end;
}

}  // namespace longarm::planning::internal
