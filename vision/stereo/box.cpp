#include "vision/stereo/box.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "core/text.h"
#include "vision/stereo/chi_square.h"
#include "vision/stereo/fit_terms.h"

namespace longarm::vision {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vertices = std::vector<std::vector<Sighting>>;

constexpr double kDegree = 0.017453292519943295;

// A corner, an attitude and three lengths; the box axis that each edge lies on.
struct BoxState {
  Vector3d corner = Vector3d::Zero();
  Matrix3d R = Matrix3d::Identity();
  Vector3d lengths = Vector3d::Zero();
};

VectorXd pack(const BoxState& box) {
  VectorXd state(15);
  state << box.corner, box.lengths, Eigen::Map<const Eigen::Matrix<double, 9, 1>>(box.R.data());
  return state;
}

BoxState unpack(const VectorXd& state) {
  BoxState box;
  box.corner = state.head<3>();
  box.lengths = state.segment<3>(3);
  box.R = Eigen::Map<const Matrix3d>(state.data() + 6);
  return box;
}

// Steps are (corner, rotation from the left, lengths).
VectorXd moved(const VectorXd& state, const VectorXd& step) {
  BoxState box = unpack(state);
  box.corner += step.head<3>();
  box.R = Eigen::Quaterniond(expSO3(step.segment<3>(3)) * box.R).normalized().toRotationMatrix();
  box.lengths += step.tail<3>();
  return pack(box);
}

// Edge i of the sketch lies on axis axes[i].
using Axes = std::array<int, 3>;

Matrix3Xd pointsOf(const BoxState& box, const Axes& axes) {
  Matrix3Xd points(3, 4);
  points.col(0) = box.corner;
  for (int edge = 0; edge < 3; ++edge) {
    const int axis = axes[static_cast<std::size_t>(edge)];
    points.col(edge + 1) = box.corner + box.lengths[axis] * box.R.col(axis);
  }
  return points;
}

MatrixXd derivativeOf(const BoxState& box, const Axes& axes) {
  MatrixXd d = MatrixXd::Zero(12, 9);
  for (int vertex = 0; vertex < 4; ++vertex) d.block<3, 3>(3 * vertex, 0).setIdentity();
  for (int edge = 0; edge < 3; ++edge) {
    const int axis = axes[static_cast<std::size_t>(edge)];
    d.block<3, 3>(3 * (edge + 1), 3) = -skew(box.lengths[axis] * box.R.col(axis));
    d.block<3, 1>(3 * (edge + 1), 6 + axis) = box.R.col(axis);
  }
  return d;
}

std::string edgeName(int edge) { return "edge " + std::to_string(edge + 1) + " of the triad"; }

// Each edge must be long enough to be seen in two views.
Status checkEdgesSeen(const Vertices& vertices, const BoxOptions& options) {
  for (int edge = 0; edge < 3; ++edge) {
    int seen = 0;
    double shortest = 1e300;
    std::string where;
    for (const auto& corner : vertices[0]) {
      for (const auto& end : vertices[static_cast<std::size_t>(edge) + 1]) {
        if (end.view != corner.view) continue;
        const double length = (end.pixel - corner.pixel).norm();
        if (length >= options.min_edge_px) ++seen;
        if (length < shortest) {
          shortest = length;
          where = internal::labelOf(*end.view);
        }
      }
    }
    if (seen >= 2) continue;
    if (where.empty()) {
      return {ErrorCode::kDegenerate, edgeName(edge) + " is not seen whole in any view: mark both its ends in two views"};
    }
    return {ErrorCode::kDegenerate, edgeName(edge) + " is only " + formatFixed(shortest, 1) + " px long in " + where + " (need " +
                                        formatFixed(options.min_edge_px, 0) +
                                        " px in two views): it points at the camera or is too short. Take a view from "
                                        "the side or nearer, or mark a longer edge"};
  }
  return {};
}

Result<Matrix3d> unitEdges(const std::vector<TriangulatedPoint>& points, const BoxOptions& options) {
  Matrix3d E;
  for (int edge = 0; edge < 3; ++edge) {
    const Vector3d along = points[static_cast<std::size_t>(edge) + 1].xyz - points[0].xyz;
    if (!(along.norm() > 1e-9)) {
      return Error{ErrorCode::kDegenerate, edgeName(edge) + " has no length: mark its end away from the corner"};
    }
    E.col(edge) = along.normalized();
  }
  const double volume = std::abs(E.determinant());
  if (!(volume > options.min_volume)) {
    return Error{ErrorCode::kDegenerate, "the three edges of the triad lie nearly in one plane (volume of the unit edges " +
                                             formatFixed(volume, 2) + ", need more than " + formatFixed(options.min_volume, 2) +
                                             "): mark three edges that meet at right angles in one corner"};
  }
  return E;
}

double orthogonalityError(const Matrix3d& E) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const double cosine = std::clamp(E.col(i).dot(E.col((i + 1) % 3)), -1.0, 1.0);
    worst = std::max(worst, std::abs(std::asin(cosine)));
  }
  return worst;
}

// Nearest rotation to the edges (Procrustes).  Edges marked left-handed are taken in the order 1, 3, 2: a box has no
// handedness of its own, so nothing is mirrored.
BoxState startFrom(const std::vector<TriangulatedPoint>& points, const Matrix3d& unit, Axes* axes) {
  *axes = unit.determinant() > 0 ? Axes{0, 1, 2} : Axes{0, 2, 1};
  Matrix3d E;
  for (int edge = 0; edge < 3; ++edge) E.col((*axes)[static_cast<std::size_t>(edge)]) = unit.col(edge);
  const Eigen::JacobiSVD<Matrix3d> svd(E, Eigen::ComputeFullU | Eigen::ComputeFullV);
  BoxState box;
  box.corner = points[0].xyz;
  box.R = svd.matrixU() * svd.matrixV().transpose();
  for (int edge = 0; edge < 3; ++edge) {
    const int axis = (*axes)[static_cast<std::size_t>(edge)];
    box.lengths[axis] = box.R.col(axis).dot(points[static_cast<std::size_t>(edge) + 1].xyz - box.corner);
  }
  return box;
}

BoxShape shapeOf(const BoxState& box, const MatrixXd& covariance) {
  BoxShape shape;
  const Vector3d half = 0.5 * box.lengths;
  shape.X_WB.linear() = box.R;
  shape.X_WB.translation() = box.corner + box.R * half;
  shape.size = box.lengths;
  MatrixXd J = MatrixXd::Identity(9, 9);   // from (corner, rotation, lengths) to (centre, rotation, lengths)
  J.block<3, 3>(0, 3) = -skew(box.R * half);
  J.block<3, 3>(0, 6) = 0.5 * box.R;
  shape.covariance = J * covariance * J.transpose();
  return shape;
}

Status checkLengths(const BoxShape& shape, const Axes& axes, const BoxOptions& options) {
  const Vector3d sigma = shape.sizeSigma();
  for (int edge = 0; edge < 3; ++edge) {
    const int axis = axes[static_cast<std::size_t>(edge)];
    if (shape.size[axis] > options.min_length_sigmas * sigma[axis]) continue;
    return {ErrorCode::kDegenerate, edgeName(edge) + " measures " + formatFixed(1e3 * shape.size[axis], 1) + " mm with a sigma of " +
                                        formatFixed(1e3 * sigma[axis], 1) + " mm: too short for these views. Go nearer, "
                                        "or use views farther apart"};
  }
  return {};
}

std::vector<internal::FitTerm> termsOf(const Vertices& vertices) {
  std::vector<internal::FitTerm> terms;
  for (std::size_t vertex = 0; vertex < vertices.size(); ++vertex) {
    for (const auto& pick : vertices[vertex]) terms.push_back({pick, static_cast<int>(vertex), -1});
  }
  return terms;
}

// The vertices as the box has them, with their share of its covariance and residuals.
void takeVertices(const internal::FitResult& fitted, const Axes& axes, const std::vector<internal::FitTerm>& terms,
                  Feature* feature) {
  const BoxState box = unpack(fitted.state);
  const Matrix3Xd points = pointsOf(box, axes);
  const MatrixXd d = derivativeOf(box, axes);
  const MatrixXd covariance = d * fitted.covariance() * d.transpose();
  std::array<double, 4> squares{};
  std::array<int, 4> counts{};
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const auto vertex = static_cast<std::size_t>(terms[i].point);
    squares[vertex] += fitted.rows.residual.segment<2>(static_cast<Eigen::Index>(2 * i)).squaredNorm();
    counts[vertex] += 2;
  }
  for (int i = 0; i < 4; ++i) {
    auto& vertex = feature->vertices[static_cast<std::size_t>(i)];
    vertex.xyz = points.col(i);
    vertex.covariance = covariance.block<3, 3>(3 * i, 3 * i);
    vertex.reprojection_rms_px = std::sqrt(squares[static_cast<std::size_t>(i)] / std::max(1, counts[static_cast<std::size_t>(i)]));
  }
  feature->cross_covariance = covariance.block<3, 3>(0, 3);
}

std::string notABox(const BoxShape& shape, double limit) {
  return "the picks do not fit right angles (chi-square " + formatFixed(shape.chi2, 1) + ", limit " + formatFixed(limit, 1) +
         "; the edges deviate by up to " + formatFixed(shape.orthogonality_error / kDegree, 1) +
         " degrees): check the picks; if they are right the object is a parallelepiped and its vertices are measured freely";
}

}  // namespace

Status fitBox(const Vertices& vertices, const std::vector<TriangulatedPoint>& points, Feature* feature,
              const BoxOptions& options) {
  if (auto status = checkEdgesSeen(vertices, options); !status) return status;
  const auto unit = unitEdges(points, options);
  if (!unit) return unit.error();
  Axes axes{};
  const BoxState start = startFrom(points, *unit, &axes);
  const auto terms = termsOf(vertices);
  if (auto status = internal::checkTerms(terms); !status) return status;
  internal::FitProblem problem;
  problem.plus = moved;
  problem.rows = [&](const VectorXd& state) {
    const BoxState box = unpack(state);
    return internal::rowsOfTerms(terms, pointsOf(box, axes), derivativeOf(box, axes));
  };
  const auto fitted = internal::fit(problem, pack(start));
  if (!fitted) return fitted.error();
  BoxShape shape = shapeOf(unpack(fitted->state), fitted->covariance());
  if (auto status = checkLengths(shape, axes, options); !status) return status;
  shape.orthogonality_error = orthogonalityError(*unit);
  shape.chi2 = fitted->chi2;
  shape.degrees_of_freedom = fitted->degrees_of_freedom;
  const double limit = chi2Limit(std::max(1, shape.degrees_of_freedom), kChi2Usual);
  shape.is_box = shape.chi2 <= limit;
  if (shape.is_box) {
    takeVertices(*fitted, axes, terms, feature);
  } else {
    feature->warnings.push_back(notABox(shape, limit));
  }
  feature->box = shape;
  return {};
}

}  // namespace longarm::vision
