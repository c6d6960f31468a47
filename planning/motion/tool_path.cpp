#include "planning/motion/tool_path.h"

#include <algorithm>
#include <cmath>

namespace longarm::planning {
namespace {

constexpr double kNothing = 1e-9;
constexpr double kWayPerTurn = 0.1;      // [m/rad]

}  // namespace

Pose ToolPath::Piece::at(double share) const {
  if (!arc) return interpolate(X_start, X_end, share);
  const Eigen::Matrix3d R = expSO3(share * angle * axis);
  Pose X = X_start;
  X.translation() = point + R * (X_start.translation() - point);
  if (turns_tool) X.linear() = R * X_start.linear();
  return X;
}

void ToolPath::append(Piece piece) {
  piece.from = length();
  m_end = piece.at(1);
  m_pieces.push_back(std::move(piece));
}

ToolPath& ToolPath::lineTo(const Pose& X_RT) {
  Piece piece;
  piece.X_start = m_end;
  piece.X_end = X_RT;
  piece.turn = angleBetween(m_end.linear(), X_RT.linear());
  piece.length = std::max((X_RT.translation() - m_end.translation()).norm(), kWayPerTurn * piece.turn);
  if (piece.length > kNothing) append(std::move(piece));
  return *this;
}

ToolPath& ToolPath::lineTo(const Eigen::Vector3d& p_RT) {
  Pose X = m_end;
  X.translation() = p_RT;
  return lineTo(X);
}

ToolPath& ToolPath::arc(const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle, bool turns_tool) {
  Piece piece;
  piece.arc = true;
  piece.X_start = m_end;
  piece.point = point;
  piece.axis = axis;
  piece.angle = angle;
  piece.turns_tool = turns_tool;
  piece.turn = std::abs(angle);
  const double radius = axis.cross(m_end.translation() - point).norm();
  piece.length = std::max(radius, kWayPerTurn * (turns_tool ? 1 : 0)) * std::abs(angle);
  if (piece.length > kNothing) append(std::move(piece));
  return *this;
}

Pose ToolPath::at(double s) const {
  if (m_pieces.empty()) return m_start;
  const auto it = std::upper_bound(m_pieces.begin(), m_pieces.end(), s,
                                   [](double value, const Piece& piece) { return value < piece.from; });
  const Piece& piece = *(it == m_pieces.begin() ? it : it - 1);
  return piece.at(std::clamp((s - piece.from) / piece.length, 0.0, 1.0));
}

std::vector<double> ToolPath::stations(double step, double turn) const {
  std::vector<double> out{0};
  for (const auto& piece : m_pieces) {
    const int cells = std::max({1, static_cast<int>(std::ceil(piece.length / step - 1e-9)),
                                static_cast<int>(std::ceil(piece.turn / turn - 1e-9))});
    for (int i = 1; i <= cells; ++i) out.push_back(piece.from + piece.length * i / cells);
  }
  return out;
}

}  // namespace longarm::planning
