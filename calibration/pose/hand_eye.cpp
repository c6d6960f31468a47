#include "calibration/pose/hand_eye.h"

#include <Eigen/Dense>

namespace longarm::calibration {
namespace {

Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d S = Eigen::Matrix3d::Identity();
  S(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * S * svd.matrixV().transpose();
}

}  // namespace

std::optional<HandEyeStart> handEyeStart(const std::vector<HandEyePair>& pairs) {
  if (pairs.size() < 2) return std::nullopt;
  std::vector<Pose> seen, moved;
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      seen.push_back(pairs[i].P * pairs[j].P.inverse());
      moved.push_back(pairs[i].K * pairs[j].K.inverse());
      M += logSO3(seen.back().linear()) * logSO3(moved.back().linear()).transpose();
    }
  }
  HandEyeStart out{Pose::Identity(), Pose::Identity()};
  out.T_ext.linear() = nearestRotation(M);
  Eigen::MatrixXd A(3 * static_cast<Eigen::Index>(seen.size()), 3);
  Eigen::VectorXd b(A.rows());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    A.middleRows<3>(row) = seen[i].linear() - Eigen::Matrix3d::Identity();
    b.segment<3>(row) = out.T_ext.linear() * moved[i].translation() - seen[i].translation();
  }
  out.T_ext.translation() = A.completeOrthogonalDecomposition().solve(b);
  Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero();
  Eigen::Vector3d places = Eigen::Vector3d::Zero();
  for (const auto& pair : pairs) {
    const Pose Y = (out.T_ext * pair.K).inverse() * pair.P;
    rotations += Y.linear();
    places += Y.translation() / static_cast<double>(pairs.size());
  }
  out.Y.linear() = nearestRotation(rotations);
  out.Y.translation() = places;
  return out;
}

}  // namespace longarm::calibration
