#include "planning/trajectory/joint_path.h"

#include <algorithm>
#include <cmath>

#include "core/require.h"

namespace longarm::planning {
namespace {

constexpr double kStretch = 2.5;   // length of a corner in s per blend: its end tangent is 5 * blend / 2 per unit
constexpr int kCornerCells = 24;
constexpr int kLeastCells = 200;

// Quintic Bezier over w in [0, 1] with control points a, (a+c)/2, c, c, (c+b)/2, b.
PathState corner(const Eigen::VectorXd& a, const Eigen::VectorXd& c, const Eigen::VectorXd& b, double w) {
  const Eigen::VectorXd p1 = 0.5 * (a + c), p4 = 0.5 * (c + b);
  const double v = 1 - w;
  PathState out;
  out.q = v * v * v * v * v * a + 5 * v * v * v * v * w * p1 + 10 * v * v * v * w * w * c +
          10 * v * v * w * w * w * c + 5 * v * w * w * w * w * p4 + w * w * w * w * w * b;
  // Control points of the derivatives; the middle one of the first vanishes.
  const Eigen::VectorXd d0 = p1 - a, d1 = c - p1, d3 = p4 - c, d4 = b - p4;
  out.dq = 5 * (v * v * v * v * d0 + 4 * v * v * v * w * d1 + 4 * v * w * w * w * d3 + w * w * w * w * d4);
  out.ddq = 20 * (v * v * v * (d1 - d0) - 3 * v * v * w * d1 + 3 * v * w * w * d3 + w * w * w * (d4 - d3));
  return out;
}

// Points from `from` (left out) to `to` (included), at most `step` apart.
void fill(std::vector<double>& grid, double from, double to, double step) {
  const int cells = std::max(1, static_cast<int>(std::ceil((to - from) / step - 1e-9)));
  for (int i = 1; i <= cells; ++i) grid.push_back(i == cells ? to : from + (to - from) * i / cells);
}

}  // namespace

BlendedPolyline::BlendedPolyline(std::vector<Eigen::VectorXd> waypoints, const std::vector<double>& blends) {
  LONGARM_REQUIRE(waypoints.size() >= 2 && blends.size() + 2 >= waypoints.size(), "path needs waypoints and blends");
  const std::size_t segments = waypoints.size() - 1;
  Eigen::VectorXd from = waypoints[0];
  for (std::size_t i = 0; i < segments; ++i) {
    const Eigen::VectorXd delta = waypoints[i + 1] - waypoints[i];
    const double length = delta.norm();
    const Eigen::VectorXd u = delta / length;
    double blend = 0;
    if (i + 1 < segments) {
      const double next = (waypoints[i + 2] - waypoints[i + 1]).norm();
      const double shorter = std::min(length, next);
      blend = std::clamp(blends[i], 1e-4 * shorter, 0.49 * shorter);
    }
    const Eigen::VectorXd to = waypoints[i + 1] - blend * u;
    Piece line;
    line.start = m_length;
    line.length = (to - from).norm();
    line.from = from;
    line.direction = u;
    m_length += line.length;
    m_pieces.push_back(line);
    if (blend == 0) continue;
    Piece round;
    round.corner = true;
    round.start = m_length;
    round.length = kStretch * blend;
    round.before = to;
    round.at = waypoints[i + 1];
    round.after = waypoints[i + 1] + blend * (waypoints[i + 2] - waypoints[i + 1]).normalized();
    m_length += round.length;
    from = round.after;
    m_pieces.push_back(round);
  }
}

PathState BlendedPolyline::at(double s) const {
  s = std::clamp(s, 0.0, m_length);
  auto it = std::upper_bound(m_pieces.begin(), m_pieces.end(), s,
                             [](double value, const Piece& piece) { return value < piece.start; });
  const Piece& piece = *(it == m_pieces.begin() ? it : it - 1);
  const double along = std::min(s - piece.start, piece.length);
  if (!piece.corner) {
    return {piece.from + along * piece.direction, piece.direction, Eigen::VectorXd::Zero(piece.from.size())};
  }
  PathState state = corner(piece.before, piece.at, piece.after, along / piece.length);
  state.dq /= piece.length;
  state.ddq /= piece.length * piece.length;
  return state;
}

std::vector<double> BlendedPolyline::grid() const {
  std::vector<double> grid{0};
  const double step = m_length / kLeastCells;
  for (const auto& piece : m_pieces) {
    if (piece.length < 1e-12) continue;
    fill(grid, piece.start, piece.start + piece.length,
         piece.corner ? std::min(step, piece.length / kCornerCells) : step);
  }
  return grid;
}

SplinePath::SplinePath(std::vector<double> parameters, std::vector<Eigen::VectorXd> waypoints)
    : m_s(std::move(parameters)), m_q(std::move(waypoints)) {
  LONGARM_REQUIRE(m_s.size() == m_q.size() && m_s.size() >= 2, "spline needs as many parameters as waypoints");
  const std::size_t n = m_s.size();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(m_q[0].size());
  m_second.assign(n, zero);
  // Thomas algorithm on h[i-1] M[i-1] + 2 (h[i-1] + h[i]) M[i] + h[i] M[i+1] = 6 (slope[i] - slope[i-1]).
  std::vector<double> upper(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double h0 = m_s[i] - m_s[i - 1], h1 = m_s[i + 1] - m_s[i];
    const Eigen::VectorXd right = 6 * ((m_q[i + 1] - m_q[i]) / h1 - (m_q[i] - m_q[i - 1]) / h0);
    const double pivot = 2 * (h0 + h1) - h0 * upper[i - 1];
    upper[i] = h1 / pivot;
    m_second[i] = (right - h0 * m_second[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) m_second[i] -= upper[i] * m_second[i + 1];
}

PathState SplinePath::at(double s) const {
  s = std::clamp(s, 0.0, m_s.back());
  const auto it = std::upper_bound(m_s.begin(), m_s.end(), s);
  const std::size_t i = std::min(static_cast<std::size_t>(std::max<long>(it - m_s.begin() - 1, 0)), m_s.size() - 2);
  const double h = m_s[i + 1] - m_s[i];
  const double b = (s - m_s[i]) / h, a = 1 - b;
  PathState out;
  out.q = a * m_q[i] + b * m_q[i + 1] +
          ((a * a * a - a) * m_second[i] + (b * b * b - b) * m_second[i + 1]) * (h * h / 6);
  out.dq = (m_q[i + 1] - m_q[i]) / h +
           ((3 * b * b - 1) * m_second[i + 1] - (3 * a * a - 1) * m_second[i]) * (h / 6);
  out.ddq = a * m_second[i] + b * m_second[i + 1];
  return out;
}

std::vector<double> SplinePath::grid() const {
  std::vector<double> grid{0};
  const double step = m_s.back() / kLeastCells;
  for (std::size_t i = 1; i < m_s.size(); ++i) fill(grid, m_s[i - 1], m_s[i], step);
  return grid;
}

}  // namespace longarm::planning
