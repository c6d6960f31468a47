#include "planning/trajectory/time_law.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/require.h"

namespace longarm::planning {
namespace {

constexpr double kUnbounded = 1e12;

double squaredSpeedCap(const PathConstraint& c, const Eigen::VectorXd& v) {
  double cap = c.max_speed * c.max_speed;
  for (Eigen::Index j = 0; j < v.size(); ++j) {
    const double slope = std::abs(c.dq[j]);
    if (slope > 1e-12) cap = std::min(cap, v[j] / slope * (v[j] / slope));
  }
  return cap;
}

// One cell of the grid: the accelerations u it allows for a given x at its left end.
class Cell {
 public:
  Cell(const PathConstraint& left, const PathConstraint& right, double ds, const Eigen::VectorXd& a)
      : m_left(left), m_right(right), m_ds(ds), m_a(a) {}

  // Empty when first > second.
  std::pair<double, double> accelerations(double x) const {
    std::pair<double, double> range{-kUnbounded, kUnbounded};
    for (Eigen::Index j = 0; j < m_a.size(); ++j) {
      narrow(range, m_left.dq[j], m_left.ddq[j] * x, m_a[j]);
      narrow(range, m_right.dq[j] + 2 * m_ds * m_right.ddq[j], m_right.ddq[j] * x, m_a[j]);
    }
    return range;
  }
  // Whether some allowed u leads from x to within [0, next].
  bool reaches(double x, double next) const {
    const auto [low, high] = accelerations(x);
    return low <= high && x + 2 * m_ds * low <= next && x + 2 * m_ds * high >= 0;
  }

 private:
  // |slope u + offset| <= a
  static void narrow(std::pair<double, double>& range, double slope, double offset, double a) {
    if (std::abs(slope) < 1e-12) {
      if (std::abs(offset) > a * (1 + 1e-9)) range = {1, 0};
      return;
    }
    double low = (-a - offset) / slope, high = (a - offset) / slope;
    if (low > high) std::swap(low, high);
    range.first = std::max(range.first, low);
    range.second = std::min(range.second, high);
  }

  const PathConstraint& m_left;
  const PathConstraint& m_right;
  double m_ds;
  const Eigen::VectorXd& m_a;
};

// Largest x <= cap from which the cell reaches [0, next]: the set is an interval that holds 0.
double controllable(const Cell& cell, double cap, double next) {
  if (cell.reaches(cap, next)) return cap;
  double low = 0, high = cap;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (cell.reaches(middle, next) ? low : high) = middle;
  }
  return low;
}

}  // namespace

TimeLaw::TimeLaw(std::vector<double> s, std::vector<double> squared) : m_s(std::move(s)), m_x(std::move(squared)) {
  LONGARM_REQUIRE(m_s.size() == m_x.size() && m_s.size() >= 2, "time law needs a grid");
  m_t.assign(m_s.size(), 0);
  m_integral.assign(m_s.size(), 0);
  for (std::size_t i = 0; i + 1 < m_s.size(); ++i) {
    const double ds = m_s[i + 1] - m_s[i];
    const double v0 = std::sqrt(m_x[i]), v1 = std::sqrt(m_x[i + 1]);
    const double h = 2 * ds / std::max(v0 + v1, 1e-12);
    const double u = (v1 - v0) / h;
    m_t[i + 1] = m_t[i] + h;
    m_integral[i + 1] = m_integral[i] + m_s[i] * h + v0 * h * h / 2 + u * h * h * h / 6;
  }
}

TimeLaw::Motion TimeLaw::motionAt(double t) const {
  if (t <= 0) return {m_s.front() * t, m_s.front(), 0};
  if (t >= m_t.back()) return {m_integral.back() + m_s.back() * (t - m_t.back()), m_s.back(), 0};
  const auto it = std::upper_bound(m_t.begin(), m_t.end(), t);
  const auto i = static_cast<std::size_t>(it - m_t.begin()) - 1;
  const double h = m_t[i + 1] - m_t[i], dt = t - m_t[i];
  const double v0 = std::sqrt(m_x[i]);
  const double u = (std::sqrt(m_x[i + 1]) - v0) / h;
  return {m_integral[i] + m_s[i] * dt + v0 * dt * dt / 2 + u * dt * dt * dt / 6, m_s[i] + v0 * dt + u * dt * dt / 2,
          v0 + u * dt};
}

TimeLaw::State TimeLaw::at(double t) const {
  const Motion m = motionAt(t);
  if (t < 0 || t > m_t.back()) return {m.s, 0, 0};
  const auto it = std::upper_bound(m_t.begin(), m_t.end() - 1, t);
  const auto i = static_cast<std::size_t>(it - m_t.begin()) - 1;
  return {m.s, m.ds, (m_x[i + 1] - m_x[i]) / (2 * (m_s[i + 1] - m_s[i]))};
}

TimeLaw::State TimeLaw::smoothedAt(double t, double window) const {
  if (window <= 0) return at(t);
  const Motion a = motionAt(t - window), b = motionAt(t);
  return {(b.integral - a.integral) / window, (b.s - a.s) / window, (b.ds - a.ds) / window};
}

TimeLaw fastestTimeLaw(const std::vector<double>& s, const std::vector<PathConstraint>& constraints,
                       const Eigen::VectorXd& max_velocity, const Eigen::VectorXd& max_acceleration) {
  const std::size_t n = s.size();
  LONGARM_REQUIRE(n >= 2 && constraints.size() == n, "time law needs a constraint per grid point");
  std::vector<double> most(n, 0);
  for (std::size_t i = n - 1; i-- > 0;) {
    const Cell cell(constraints[i], constraints[i + 1], s[i + 1] - s[i], max_acceleration);
    most[i] = controllable(cell, squaredSpeedCap(constraints[i], max_velocity), most[i + 1]);
  }
  std::vector<double> x(n, 0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double ds = s[i + 1] - s[i];
    const Cell cell(constraints[i], constraints[i + 1], ds, max_acceleration);
    const auto [low, high] = cell.accelerations(x[i]);
    const double u = low <= high ? high : 0.5 * (low + high);
    x[i + 1] = std::clamp(x[i] + 2 * ds * u, 0.0, most[i + 1]);
    // Two neighbours at rest would take for ever: creep instead.
    if (i + 2 < n && x[i + 1] < 1e-12) x[i + 1] = std::min(1e-12, most[i + 1]);
  }
  return {s, x};
}

}  // namespace longarm::planning
