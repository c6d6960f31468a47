#pragma once

/// @file
/// How the path parameter runs over time: tau(t) with a continuous second derivative, ending at rest.

#include <cstddef>
#include <vector>

namespace longarm::planning::internal {

/// Path parameter, its rate and the rate's change at one instant.
struct RateState {
  double tau = 0;  ///< [s] of the trajectory's own time
  double r = 0;    ///< d tau / dt
  double u = 0;    ///< d r / dt [1/s]
};

/// A stretch of the path between two places where the path itself is at rest.
struct PathStretch {
  double low = 0, high = 0;  ///< [s]
};

/// u(t) is linear between knots; tau stays in the stretch.  Where tau meets an end of it, the profile
/// ends: the path itself is at rest there, so the joints are too, whatever r is.  Thread-compatible value.
class RateProfile {
 public:
  struct Knot {
    double t = 0;  ///< [s] on the caller's clock
    RateState state;
  };

  RateProfile() = default;
  RateProfile(const PathStretch& stretch, double t, const RateState& state);

  /// Another stretch for what is appended from now on.  @pre both hold all of the profile.
  void setStretch(const PathStretch& stretch) { m_stretch = stretch; }

  /// Adds a piece of `h` seconds over which u goes to `u_end`; cut short where tau meets an end of the path.
  /// Nothing is added to a profile that has met one.
  void append(double h, double u_end);
  /// Adds braking that ends at rest after `pieces` pieces of `h` seconds, at least 2: harder as r falls,
  /// since following the path's curvature then takes less of the joints' acceleration.
  void appendBraking(double h, int pieces);
  /// The first part, up to time t (a knot is put there).  At rest from the end on.
  RateProfile upTo(double t) const;
  /// Forgets knots that `t` has passed.
  void forgetBefore(double t);
  /// Appends the pieces of another profile that starts where this one ends.
  void extendBy(const RateProfile& other);

  /// State at time t: the first knot's before it, at rest after the last.
  RateState at(double t) const;
  RateState between(std::size_t piece, double s) const;  ///< s seconds into a piece.
  double endTime() const { return m_knots.back().t; }
  /// Where it comes to rest.
  double restTau() const { return restAtEnd().tau; }
  bool metEnd() const { return m_met_end; }
  const std::vector<Knot>& knots() const { return m_knots; }

 private:
  bool leavesPath(const RateState& state) const;
  RateState restAtEnd() const;

  PathStretch m_stretch;
  bool m_met_end = false;
  std::vector<Knot> m_knots{Knot{}};
};

}  // namespace longarm::planning::internal
