#include "calibration/intrinsics/plumb_line.h"

#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr int kMaxIterations = 50;
constexpr double kStep = 1e-5;             // of numeric derivatives; coefficients are of order 0.1
constexpr double kConvergence = 1e-10;     // of the relative decrease
constexpr double kTenth_px = 0.05;          // a tenth of a coefficient must move the points by more than this in all
constexpr double kOpen_px = 3;             // a coefficient that moves points by more than this is worth a word
constexpr double kSpread_px = 0.05;        // a misfit below it, with hardly any bend before, is no distortion

double rms(const Eigen::VectorXd& r) { return r.size() > 0 ? std::sqrt(r.squaredNorm() / static_cast<double>(r.size())) : 0; }

vision::CameraModel moved(vision::CameraModel camera, const Eigen::VectorXd& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) camera.distortion[static_cast<std::size_t>(i)] = values[i];
  return camera;
}

std::optional<Eigen::VectorXd> residuals(const vision::CameraModel& camera, const std::vector<PlumbLine>& lines) {
  std::vector<double> all;
  for (const auto& line : lines) {
    const auto distances = straightness(camera, line);
    if (distances.empty()) return std::nullopt;
    all.insert(all.end(), distances.begin(), distances.end());
  }
  return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())));
}

std::optional<Eigen::MatrixXd> jacobian(const vision::CameraModel& camera, const std::vector<PlumbLine>& lines, const Eigen::VectorXd& at) {
  Eigen::MatrixXd J;
  for (Eigen::Index p = 0; p < at.size(); ++p) {
    Eigen::VectorXd low = at, high = at;
    low[p] -= kStep;
    high[p] += kStep;
    const auto below = residuals(moved(camera, low), lines), above = residuals(moved(camera, high), lines);
    if (!below || !above) return std::nullopt;
    if (J.size() == 0) J.resize(above->size(), at.size());
    J.col(p) = (*above - *below) / (2 * kStep);
  }
  return J;
}

Status checkLines(const std::vector<PlumbLine>& lines, int coefficients) {
  if (coefficients != 1 && coefficients != 2 && coefficients != 4) {
    return {ErrorCode::kInvalidInput, std::to_string(coefficients) + " coefficients cannot be estimated from lines; expected 1, 2 or 4"};
  }
  int spare = -coefficients;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].size() < 3) {
      return {ErrorCode::kDegenerate, "line " + std::to_string(i + 1) + " has " + std::to_string(lines[i].size()) +
                                          " points; three or more are needed to see whether it is bent"};
    }
    spare += static_cast<int>(lines[i].size()) - 2;
  }
  if (spare >= 1) return {};
  return {ErrorCode::kDegenerate, std::to_string(lines.size()) + " lines with these points cannot determine " + std::to_string(coefficients) +
                                      " coefficients; add points along edges that are straight in the world, far from the middle of the picture"};
}

struct Search {
  Eigen::VectorXd at, r;
  int iterations = 0;
};

struct Open {
  int parameter = kK1;
  double pixels = 0;
};

// The coefficient whose sigma moves a point of the lines furthest.
Open openPart(const PlumbLineResult& result, const std::vector<PlumbLine>& lines) {
  Open out;
  for (const auto& line : lines) {
    for (const auto& pixel : line) {
      const auto n = result.camera.normalisedOfPixel(pixel);
      LensProjection at;
      if (!n || !projectWithDerivatives(result.camera, n->homogeneous(), &at)) continue;
      for (int i = kK1; i < kK1 + result.coefficients; ++i) {
        const double moved_px = at.d_lens.col(i).norm() * std::sqrt(result.covariance(i, i));
        if (moved_px > out.pixels) out = {i, moved_px};
      }
    }
  }
  return out;
}

// Levenberg-Marquardt; the lines are fitted inside each evaluation.
Status search(const vision::CameraModel& camera, const std::vector<PlumbLine>& lines, Search* s) {
  double lambda = 1e-6;
  for (; s->iterations < kMaxIterations; ++s->iterations) {
    const auto J = jacobian(camera, lines, s->at);
    if (!J) return {ErrorCode::kDegenerate, "the lens cannot be inverted at the points; begin with less distortion"};
    const Eigen::MatrixXd H = J->transpose() * *J;
    const Eigen::VectorXd g = J->transpose() * s->r;
    bool better = false;
    double decrease = 0;
    for (int trial = 0; trial < 10 && !better; ++trial, lambda = better ? lambda : 10 * lambda) {
      Eigen::MatrixXd damped = H;
      damped.diagonal() *= 1 + lambda;
      const Eigen::VectorXd next = s->at - damped.ldlt().solve(g);
      const auto r = next.allFinite() ? residuals(moved(camera, next), lines) : std::nullopt;
      if (!r || r->squaredNorm() > s->r.squaredNorm()) continue;
      better = true;
      decrease = s->r.squaredNorm() - r->squaredNorm();
      s->at = next;
      s->r = *r;
    }
    lambda = std::max(1e-12, lambda / 10);
    if (!better || decrease <= kConvergence * s->r.squaredNorm()) break;
  }
  return {};
}

}  // namespace

std::vector<double> straightness(const vision::CameraModel& camera, const PlumbLine& line) {
  Eigen::Matrix2Xd ideal(2, static_cast<Eigen::Index>(line.size()));
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto n = camera.normalisedOfPixel(line[i]);
    if (!n) return {};
    ideal.col(static_cast<Eigen::Index>(i)) = *n;
  }
  const Eigen::Vector2d middle = ideal.rowwise().mean();
  const Eigen::Matrix2Xd off = ideal.colwise() - middle;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(off * off.transpose());
  const Eigen::Vector2d normal = eigen.eigenvectors().col(0), along = eigen.eigenvectors().col(1);
  std::vector<double> out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector2d foot = middle + along * along.dot(off.col(static_cast<Eigen::Index>(i)));
    const double side = normal.dot(off.col(static_cast<Eigen::Index>(i))) < 0 ? -1 : 1;
    out.push_back(side * (line[i] - camera.pixelOfNormalised(foot)).norm());
  }
  return out;
}

Result<PlumbLineResult> straightenLines(const vision::CameraModel& start, const std::vector<PlumbLine>& lines, int coefficients) {
  if (auto status = checkLines(lines, coefficients); !status) return status.error();
  Search s;
  s.at = Eigen::Map<const Eigen::VectorXd>(start.distortion.data(), coefficients);
  const auto before = residuals(start, lines);
  if (!before) s.at.setZero();
  const vision::CameraModel camera = before ? start : moved(start, s.at);
  const auto first = before ? before : residuals(camera, lines);
  if (!first) return Error{ErrorCode::kDegenerate, "a point has no ray through this lens; set the other coefficients back to zero"};
  s.r = *first;
  PlumbLineResult out;
  out.rms_before_px = rms(s.r);
  if (auto status = search(camera, lines, &s); !status) return status.error();
  out.camera = moved(camera, s.at);
  out.coefficients = coefficients;
  out.iterations = s.iterations;
  out.rms_px = rms(s.r);
  const auto J = jacobian(camera, lines, s.at);
  if (!J) return Error{ErrorCode::kDegenerate, "the lens that straightens the lines cannot be inverted; lay fewer or longer lines"};
  if (0.1 * J->bdcSvd().singularValues().minCoeff() < kTenth_px) {
    return Error{ErrorCode::kDegenerate, "these lines do not determine " + std::to_string(coefficients) +
                                             " coefficients: lines through the middle of the picture stay straight whatever the lens does"};
  }
  const double dof = static_cast<double>(s.r.size()) - 2.0 * static_cast<double>(lines.size()) - coefficients;
  out.sigma_px = std::sqrt(s.r.squaredNorm() / dof);
  out.covariance.block(kK1, kK1, coefficients, coefficients) = (J->transpose() * *J).inverse() * out.sigma_px * out.sigma_px;
  if (const Open open = openPart(out, lines); open.pixels > kOpen_px) {
    out.warnings.push_back(std::string(lensParameterName(open.parameter)) + " is hardly determined by these lines: its sigma moves their points by up to " + formatFixed(open.pixels, 1) +
                           " px. Lay lines that run the other way too, or estimate fewer coefficients");
  }
  for (const auto& line : lines) {
    const auto d = straightness(out.camera, line);
    out.line_rms_px.push_back(rms(Eigen::Map<const Eigen::VectorXd>(d.data(), static_cast<Eigen::Index>(d.size()))));
  }
  if (out.rms_before_px < kSpread_px) out.warnings.push_back("the lines are straight already: there is hardly any distortion to find");
  return out;
}

}  // namespace longarm::calibration
