#pragma once

/// @file
/// The VCR: plays a trajectory forwards and backwards at any speed, always one horizon from rest.

#include <memory>
#include <string>

#include "core/motion.h"
#include "core/result.h"

namespace longarm::planning {

struct PlayerOptions {
  /// Longest horizon; every one ends at rest on the path, so this is also the longest that a pause takes.
  double horizon_s = 0.19;
  double point_spacing_s = 0.02;
  double braking_spacing_s = 0.01;       ///< Of the points while braking: the harder it is, the finer.
  /// How long a horizon keeps to the one before it: one that arrives up to this much late still meets the arm.
  double commit_s = 0.04;
  double max_rate_change = 10;           ///< Of d tau / dt, besides the joint limits [1/s].
};

enum class PlayerState { kEmpty, kReady, kPlaying, kPausing, kPaused, kDone, kHalted };

/// Path parameter tau runs over [0, duration]; its rate follows the wanted speed within the limits.  Pure logic:
/// the caller supplies time.  Thread-compatible (owned by the motion thread).
class Player {
 public:
  explicit Player(MotionLimits limits, PlayerOptions options = {});
  ~Player();
  /// Loads a trajectory, cursor at 0, state kReady.  Fails as validate(), or kOutOfLimits.
  Status load(const Trajectory& trajectory);
  void clear();

  void play();                           ///< Towards the end at the set speed (sign of speed decides the way).
  /// As play(), as far as `tau`: the arm rests there, kPaused (kDone and kReady at the ends as ever).
  /// @returns kInvalidInput where the path itself is not at rest at tau, as between two stages it is;
  /// kRefused when
  ///   nothing is loaded, after a halt, at speed 0, or when tau lies behind, or nearer than the arm can come
  ///   to rest.
  Status playUntil(double tau);
  /// Keeps the motion within [low, high] of the path until the next load(), whatever is ordered: the arm comes to rest at
  /// either end, kPaused unless it is the path's own.
  /// @returns kInvalidInput: not an interval of the path that holds the arm, or the path is not at rest at its ends;
  ///   kRefused while moving, halted or empty.
  Status confine(double low, double high);
  /// Decelerates along the path within the limits, as soon as they allow: at rest within horizon_s of the last tick, at
  /// any instant and any speed.
  void pause();
  /// Wanted speed factor, -2 ... 2 (clamped); takes effect in motion.  Where a stop from there would take longer than a horizon
  /// has, the rate stays as far below it as that needs; the planned speed (1) always fits.
  void setSpeed(double factor);
  /// Moves the cursor while not moving (preview only; never moves the robot).  @returns kRefused while playing.
  Status scrub(double tau);
  /// Stands at `tau`, as after a pause: for a trajectory that passes where the arm stands, e.g. one with a correction in
  /// it.  The caller has made sure that it does.  @returns kRefused while moving, halted or empty, kInvalidInput.
  Status standAt(double tau);
  void halt();                           ///< STOP was pressed or a fault came: nothing moves until load() or resumeFrom().
  /// After a halt: re-attaches to the path at the measured joints if they lie within `tolerance` [rad] of it.
  Status resumeFrom(const Eigen::VectorXd& measured, double tolerance = 0.01);

  PlayerState state() const;
  double cursor() const;                 ///< tau [s]
  double armCursor() const;              ///< tau where the arm is; differs from cursor() after scrub().
  double rate() const;                   ///< d tau / dt now.
  double speed() const;                  ///< Wanted factor, as set.
  double duration() const;
  const Trajectory& trajectory() const;

  /// Advances to time `now_s` and returns the horizon to send (empty points when nothing needs to be sent).
  /// Its first point is the commanded state at now_s; it ends at rest on the path.
  Horizon tick(double now_s);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::planning
