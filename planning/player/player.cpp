#include "planning/player/player.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/text.h"
#include "planning/player/nearest_on_path.h"
#include "planning/player/path_table.h"
#include "planning/player/rate_profile.h"

namespace longarm::planning {
namespace {

using internal::PathTable;
using internal::RateProfile;
using internal::RateState;

// Share of the limits that a horizon may use; the rest covers what happens between two checked instants and
// what a receiver adds by interpolating between points.
constexpr double kLimitShare = 0.985;
constexpr double kCheckStep_s = 0.0025;
// Time constant with which the rate goes to the wanted one.
constexpr double kRateLag_s = 0.08;
// Points of a horizon are at least this far apart in time.
constexpr double kMinPointSpacing_s = 0.001;
// Slower than this the path is at rest [rad/s or m/s].
constexpr double kAtRest = 1e-9;

Error jointError(const Trajectory& trajectory, Eigen::Index j, double t, const std::string& what,
                 double value, double limit) {
  return {ErrorCode::kOutOfLimits, "trajectory at t = " + formatFixed(t, 3) + " s: joint " +
                                       trajectory.joint_names[static_cast<std::size_t>(j)] + " " + what +
                                       " " + formatNumber(value) + " beyond its limit " +
                                       formatNumber(limit) + "; plan it again with this workcell"};
}

Status checkPoint(const Trajectory& trajectory, const MotionLimits& limits, const TrajectoryPoint& p,
                  bool positions_only) {
  constexpr double kSlack = 1e-6;
  for (Eigen::Index j = 0; j < p.positions.size(); ++j) {
    if (p.positions[j] < limits.lower[j] - kSlack) {
      return jointError(trajectory, j, p.t, "goes to", p.positions[j], limits.lower[j]);
    }
    if (p.positions[j] > limits.upper[j] + kSlack) {
      return jointError(trajectory, j, p.t, "goes to", p.positions[j], limits.upper[j]);
    }
    if (positions_only) continue;
    if (std::abs(p.velocities[j]) > limits.max_velocity[j] * (1 + kSlack)) {
      return jointError(trajectory, j, p.t, "moves at", p.velocities[j], limits.max_velocity[j]);
    }
    if (std::abs(p.accelerations[j]) > limits.max_acceleration[j] * (1 + kSlack)) {
      return jointError(trajectory, j, p.t, "accelerates at", p.accelerations[j], limits.max_acceleration[j]);
    }
  }
  return {};
}

// Every point against all limits, and the path between them against the position limits.
Status checkLimits(const Trajectory& trajectory, const MotionLimits& limits) {
  constexpr int kBetween = 4;
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    if (auto status = checkPoint(trajectory, limits, trajectory.points[i], false); !status) return status;
    if (i == 0) continue;
    const double a = trajectory.points[i - 1].t, b = trajectory.points[i].t;
    for (int k = 1; k < kBetween; ++k) {
      const auto p = trajectory.sample(a + (b - a) * k / kBetween);
      if (auto status = checkPoint(trajectory, limits, p, true); !status) return status;
    }
  }
  return {};
}

bool sizesMatch(const MotionLimits& limits, Eigen::Index n) {
  return limits.lower.size() == n && limits.upper.size() == n && limits.max_velocity.size() == n &&
         limits.max_acceleration.size() == n;
}

}  // namespace

struct Player::Impl {
  MotionLimits limits;
  PlayerOptions options;
  Trajectory trajectory;
  PathTable table;
  RateProfile profile;
  PlayerState state = PlayerState::kEmpty;
  double speed = 1;
  double now = 0;
  std::optional<double> preview;  // Scrubbed cursor; the arm is where the profile is.
  internal::PathStretch stretch;  // How far to play.
  internal::PathStretch bounds;   // How far it may be played at all.
  std::uint64_t sequence = 0;

  RateState current() const { return profile.at(now); }
  bool atRest() const { return now >= profile.endTime(); }
  double commandedRate() const { return atRest() ? 0 : current().r; }
  bool atWantedEnd() const {
    const double tau = current().tau;
    return (speed > 0 && tau >= stretch.high) || (speed < 0 && tau <= stretch.low);
  }
  int brakingPieces() const {
    const double left = options.horizon_s - options.commit_s - options.point_spacing_s;
    return std::max(3, static_cast<int>(left / options.braking_spacing_s + 1e-9));
  }

  void standAt(double tau) {
    RateState rest;
    rest.tau = tau;
    profile = RateProfile(stretch, now, rest);
    preview.reset();
  }

  // One decision: u goes to `level` within a piece, then braking to rest.
  RateProfile candidate(const RateProfile::Knot& from, double level) const {
    RateProfile next(stretch, from.t, from.state);
    next.append(options.point_spacing_s, level);
    next.appendBraking(options.braking_spacing_s, brakingPieces());
    return next;
  }

  bool keepsLimits(const RateProfile& next) const {
    const auto& knots = next.knots();
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      const double h = knots[i + 1].t - knots[i].t;
      const int parts = std::max(1, static_cast<int>(std::ceil(h / kCheckStep_s - 1e-9)));
      for (int k = 1; k <= parts; ++k) {
        const RateState s = k < parts ? next.between(i, h * k / parts) : knots[i + 1].state;
        if (!table.keepsLimits(s.tau, s.r, s.u, kLimitShare)) return false;
      }
    }
    return true;
  }

  // The change of rate that brings the rate to the set speed without passing it.
  double wantedLevel(const RateState& from) const {
    const double left = speed - from.r - 0.5 * options.point_spacing_s * from.u;
    const double exact = left / options.point_spacing_s;  // Lands on it when u then goes to 0.
    if (std::abs(exact) < 0.3) return exact;
    return std::clamp(left / kRateLag_s, -options.max_rate_change, options.max_rate_change);
  }

  // The level nearest to the wanted one, on the way to the braking that is in force anyway, that keeps the
  // limits up to rest; none when only the braking does.
  std::optional<RateProfile> choose(const RateProfile::Knot& from) const {
    constexpr int kLevels = 8, kRefinements = 8;
    const double wanted = wantedLevel(from.state);
    const double braking = profile.at(from.t + options.point_spacing_s).u;
    double refused = wanted;
    for (int k = 0; k <= kLevels; ++k) {
      double level = wanted + (braking - wanted) * k / kLevels;
      RateProfile best = candidate(from, level);
      if (!keepsLimits(best)) {
        refused = level;
        continue;
      }
      for (int i = 0; k > 0 && i < kRefinements; ++i) {
        const double middle = 0.5 * (level + refused);
        RateProfile next = candidate(from, middle);
        const bool kept = keepsLimits(next);
        (kept ? level : refused) = middle;
        if (kept) best = std::move(next);
      }
      return best;
    }
    return std::nullopt;
  }

  // Replaces what follows the committed part of the horizon in force by a decision of this instant.  When
  // there is none that keeps the limits, the horizon in force stays: it was checked to its end.
  void decide() {
    const double from = now + options.commit_s;
    if (profile.metEnd() && profile.endTime() <= from) return;
    RateProfile committed = profile.upTo(from);
    const RateState end = committed.knots().back().state;
    if (speed == 0 && std::abs(end.r) < 1e-9 && std::abs(end.u) < 1e-9) return;
    if (auto next = choose(committed.knots().back())) {
      committed.extendBy(*next);
      profile = std::move(committed);
    }
  }

  void settle() {
    if (!atRest()) return;
    if (state == PlayerState::kPausing) state = PlayerState::kPaused;
    if (state == PlayerState::kPlaying && speed != 0 && atWantedEnd()) {
      state = endState();
    }
  }

  PlayerState endState() const {
    const double tau = current().tau;
    if (tau > 0 && tau < table.duration()) return PlayerState::kPaused;
    return speed > 0 ? PlayerState::kDone : PlayerState::kReady;
  }

  // All that may be played is open again.
  void openStretch() { setStretch(bounds); }
  void setStretch(const internal::PathStretch& wanted) {
    stretch = wanted;
    profile.setStretch(wanted);
  }

  // In place of the rest of the horizon in force the shortest braking that keeps the limits.
  void brakeSooner() {
    constexpr int kLeastPieces = 6;
    const double h = options.braking_spacing_s, from = now + options.commit_s;
    for (int pieces = kLeastPieces; from + pieces * h < profile.endTime() - 1e-6; ++pieces) {
      RateProfile committed = profile.upTo(from);
      const RateProfile::Knot start = committed.knots().back();
      RateProfile braking(stretch, start.t, start.state);
      braking.appendBraking(h, pieces);
      if (!keepsLimits(braking)) continue;
      committed.extendBy(braking);
      profile = std::move(committed);
      return;
    }
  }

  TrajectoryPoint pointAt(double t, const RateState& s, bool at_rest) const {
    TrajectoryPoint p = trajectory.sample(s.tau);
    p.t = t;
    p.accelerations = p.accelerations * (s.r * s.r) + p.velocities * s.u;
    p.velocities *= s.r;
    if (at_rest) p.velocities.setZero();
    return p;
  }

  // Points between the last one and time t, where the profile has a longer piece than receivers expect.
  void fillUpTo(double t, Horizon& out) const {
    const double from = out.points.back().t;
    const int parts = static_cast<int>(std::ceil((t - from) / options.point_spacing_s - 0.05));
    for (int k = 1; k < parts; ++k) {
      const double between = from + (t - from) * k / parts;
      out.points.push_back(pointAt(between, profile.at(now + between), false));
    }
  }

  Horizon horizon() {
    Horizon out;
    out.owner = "player";
    out.start_s = now;
    out.joint_names = trajectory.joint_names;
    const auto& knots = profile.knots();
    out.points.push_back(pointAt(0, current(), false));
    for (std::size_t i = 1; i < knots.size(); ++i) {
      const double t = knots[i].t - now;
      if (t - out.points.back().t < kMinPointSpacing_s) continue;
      fillUpTo(t, out);
      if (i + 1 < knots.size()) out.points.push_back(pointAt(t, knots[i].state, false));
    }
    const double end = knots.back().t - now;
    if (out.points.size() > 1 && end - out.points.back().t < kMinPointSpacing_s) out.points.pop_back();
    out.points.push_back(pointAt(std::max(end, kMinPointSpacing_s), knots.back().state, true));
    // Stands a while at its end: one that arrives late must not be over before.
    while (out.points.back().t < options.commit_s - kMinPointSpacing_s) {
      out.points.push_back(pointAt(std::min(options.commit_s, out.points.back().t + options.point_spacing_s), knots.back().state, true));
    }
    out.sequence = ++sequence;
    return out;
  }
};

Player::Player(MotionLimits limits, PlayerOptions options) : m_impl(std::make_unique<Impl>()) {
  m_impl->limits = std::move(limits);
  m_impl->options = options;
}

Player::~Player() = default;

Status Player::load(const Trajectory& trajectory) {
  if (auto status = validate(trajectory); !status) return status;
  const auto n = static_cast<Eigen::Index>(trajectory.joint_names.size());
  if (!sizesMatch(m_impl->limits, n)) {
    return {ErrorCode::kInvalidInput, "trajectory: has " + std::to_string(n) +
                                          " joints, the arm has limits for " +
                                          std::to_string(m_impl->limits.max_velocity.size())};
  }
  if (auto status = checkLimits(trajectory, m_impl->limits); !status) return status;
  m_impl->trajectory = trajectory;
  m_impl->table = PathTable(trajectory, m_impl->limits);
  m_impl->bounds = {0, m_impl->table.duration()};
  m_impl->openStretch();
  m_impl->standAt(0);
  m_impl->state = PlayerState::kReady;
  return {};
}

void Player::clear() {
  m_impl->trajectory = {};
  m_impl->table = {};
  m_impl->bounds = {};
  m_impl->openStretch();
  m_impl->standAt(0);
  m_impl->state = PlayerState::kEmpty;
}

void Player::play() {
  if (m_impl->state == PlayerState::kEmpty || m_impl->state == PlayerState::kHalted) return;
  m_impl->preview.reset();
  m_impl->openStretch();
  m_impl->state = PlayerState::kPlaying;
  m_impl->settle();
}

Status Player::playUntil(double tau) {
  Impl& m = *m_impl;
  if (m.state == PlayerState::kEmpty || m.state == PlayerState::kHalted) {
    return {ErrorCode::kRefused, "play: no motion is loaded, or it was halted"};
  }
  if (!std::isfinite(tau) || tau < 0 || tau > duration()) {
    return {ErrorCode::kInvalidInput, "play: the time " + formatNumber(tau) + " is not within 0 ... " +
                                          formatNumber(duration()) + " s"};
  }
  if (tau < m.bounds.low || tau > m.bounds.high) {
    return {ErrorCode::kRefused, "play: " + formatFixed(tau, 3) + " s lies beyond where the motion may go now, " +
                                     formatFixed(m.bounds.low, 3) + " ... " + formatFixed(m.bounds.high, 3) + " s"};
  }
  if (m.trajectory.sample(tau).velocities.cwiseAbs().maxCoeff() > kAtRest) {
    return {ErrorCode::kInvalidInput,
            "play: the path is not at rest at " + formatFixed(tau, 3) + " s; choose the end of a stage"};
  }
  const double rests = m.profile.restTau();
  if (m.speed == 0 || (m.speed > 0 ? rests >= tau : rests <= tau)) {
    return {ErrorCode::kRefused, "play: " + formatFixed(tau, 3) + " s is behind, or too near to stop there"};
  }
  m.preview.reset();
  m.setStretch(m.speed > 0 ? internal::PathStretch{m.bounds.low, tau} : internal::PathStretch{tau, m.bounds.high});
  m.state = PlayerState::kPlaying;
  return {};
}

Status Player::confine(double low, double high) {
  Impl& m = *m_impl;
  const bool still = m.state == PlayerState::kReady || m.state == PlayerState::kPaused || m.state == PlayerState::kDone;
  if (!still) return {ErrorCode::kRefused, "confine: nothing is loaded, or the arm does not stand on it"};
  constexpr double kSlack_s = 1e-6;
  const double here = m.current().tau;
  const bool holds = std::isfinite(low) && std::isfinite(high) && low >= 0 && high <= duration() && low <= here + kSlack_s && here <= high + kSlack_s;
  if (!holds) {
    return {ErrorCode::kInvalidInput, "confine: " + formatNumber(low) + " ... " + formatNumber(high) + " s is no part of 0 ... " +
                                          formatNumber(duration()) + " s that holds the arm at " + formatNumber(here) + " s"};
  }
  for (const double end : {low, high}) {
    if (m.trajectory.sample(end).velocities.cwiseAbs().maxCoeff() > kAtRest) {
      return {ErrorCode::kInvalidInput, "confine: the path is not at rest at " + formatFixed(end, 3) + " s; choose the end of a stage"};
    }
  }
  m.bounds = {low, high};
  m.openStretch();
  m.standAt(std::clamp(here, low, high));
  return {};
}

void Player::pause() {
  if (m_impl->state != PlayerState::kPlaying) return;
  m_impl->state = PlayerState::kPausing;
  m_impl->settle();
}

void Player::setSpeed(double factor) {
  if (std::isfinite(factor)) m_impl->speed = std::clamp(factor, -2.0, 2.0);
}

Status Player::scrub(double tau) {
  if (m_impl->state == PlayerState::kEmpty) return {ErrorCode::kRefused, "scrub: no trajectory is loaded"};
  if (m_impl->state == PlayerState::kPlaying || m_impl->state == PlayerState::kPausing) {
    return {ErrorCode::kRefused, "scrub: the arm is moving; pause first"};
  }
  if (!std::isfinite(tau)) return {ErrorCode::kInvalidInput, "scrub: the time is not a finite number"};
  m_impl->preview = std::clamp(tau, 0.0, duration());
  return {};
}

Status Player::standAt(double tau) {
  const bool still = m_impl->state == PlayerState::kReady || m_impl->state == PlayerState::kPaused || m_impl->state == PlayerState::kDone;
  if (!still) return {ErrorCode::kRefused, "stand: nothing is loaded, or the arm does not stand on it"};
  if (!std::isfinite(tau) || tau < 0 || tau > duration()) {
    return {ErrorCode::kInvalidInput, "stand: the time " + formatNumber(tau) + " is not within 0 ... " + formatNumber(duration()) + " s"};
  }
  m_impl->openStretch();
  m_impl->standAt(tau);
  m_impl->state = PlayerState::kPaused;
  return {};
}

void Player::halt() {
  if (m_impl->state == PlayerState::kEmpty) return;
  m_impl->openStretch();
  m_impl->standAt(m_impl->current().tau);
  m_impl->state = PlayerState::kHalted;
}

Status Player::resumeFrom(const Eigen::VectorXd& measured, double tolerance) {
  if (m_impl->state == PlayerState::kEmpty) return {ErrorCode::kRefused, "resume: no trajectory is loaded"};
  if (!m_impl->atRest()) return {ErrorCode::kRefused, "resume: the arm is moving; pause first"};
  const auto n = m_impl->limits.max_velocity.size();
  if (measured.size() != n || !measured.allFinite()) {
    return {ErrorCode::kInvalidInput, "resume: needs " + std::to_string(n) + " finite measured joints"};
  }
  const auto place = internal::nearestOnPath(m_impl->trajectory, measured, m_impl->current().tau, tolerance);
  if (place.distance > tolerance) {
    const auto joint = m_impl->trajectory.joint_names[static_cast<std::size_t>(place.worst_joint)];
    return {ErrorCode::kStale, "resume: joint " + joint + " is " + formatFixed(place.distance, 4) +
                                   " off the path (limit " + formatNumber(tolerance) +
                                   "); plan again from here"};
  }
  // Where the arm rests at a bound, noise has it on either side.
  const double tau = std::clamp(place.tau, m_impl->bounds.low, m_impl->bounds.high);
  if ((m_impl->trajectory.sample(tau).positions - measured).cwiseAbs().maxCoeff() > tolerance) {
    return {ErrorCode::kStale, "resume: the arm stands at " + formatFixed(place.tau, 3) + " s of the path, beyond where the motion may go now, " +
                                   formatFixed(m_impl->bounds.low, 3) + " ... " + formatFixed(m_impl->bounds.high, 3) + " s; plan again from here"};
  }
  m_impl->openStretch();
  m_impl->standAt(tau);
  m_impl->state = PlayerState::kPaused;
  return {};
}

PlayerState Player::state() const { return m_impl->state; }
double Player::cursor() const { return m_impl->preview.value_or(m_impl->current().tau); }
double Player::armCursor() const { return m_impl->current().tau; }
double Player::rate() const { return m_impl->commandedRate(); }
double Player::speed() const { return m_impl->speed; }
double Player::duration() const { return m_impl->trajectory.duration(); }
const Trajectory& Player::trajectory() const { return m_impl->trajectory; }

Horizon Player::tick(double now_s) {
  Impl& m = *m_impl;
  m.now = std::max(m.now, now_s);
  if (m.state == PlayerState::kEmpty || m.state == PlayerState::kHalted) return {};
  m.settle();
  if (m.state == PlayerState::kPlaying) {
    if (m.atRest()) m.standAt(m.current().tau);
    if (!m.atRest() || m.speed != 0) m.decide();
  }
  if (m.state == PlayerState::kPausing) m.brakeSooner();
  if (m.atRest()) return {};
  m.profile.forgetBefore(m.now);
  return m.horizon();
}

}  // namespace longarm::planning
