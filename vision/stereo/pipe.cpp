#include "vision/stereo/pipe.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "core/text.h"
#include "vision/stereo/chi_square.h"
#include "vision/stereo/fit_terms.h"
#include "vision/stereo/measure.h"
#include "vision/stereo/view_plane.h"

namespace longarm::vision {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using internal::labelOf;
using internal::ViewPlane;

// State: the two ends of the axis and the radius.
constexpr int kStates = 7;

// One view's tangent planes, normals pointing inwards, and the plane between them.
struct PipeView {
  const View* view;
  std::array<Vector2d, 4> pixels;        // first a, b, second a, b; both from end a to end b
  std::array<Vector3d, 2> tangents;
  Vector3d bisector;

  Vector3d centre() const { return view->X_WC.translation(); }
  Vector2d middle(int end) const {
    return 0.5 * (pixels[static_cast<std::size_t>(end)] + pixels[static_cast<std::size_t>(2 + end)]);
  }
};

Result<PipeView> viewOf(const PipeSighting& sighting) {
  if (sighting.view == nullptr) return Error{ErrorCode::kInvalidInput, "a pipe's picks belong to no view"};
  PipeView out{sighting.view, {sighting.first_a, sighting.first_b, sighting.second_a, sighting.second_b}, {}, {}};
  for (const auto& pixel : out.pixels) {
    if (auto status = internal::checkOnPicture({sighting.view, pixel, 0}); !status) return status.error();
  }
  if ((out.pixels[1] - out.pixels[0]).dot(out.pixels[3] - out.pixels[2]) < 0) std::swap(out.pixels[2], out.pixels[3]);
  const auto first = internal::planeOf({sighting.view, out.pixels[0], out.pixels[1]});
  if (!first) return first.error();
  const auto second = internal::planeOf({sighting.view, out.pixels[2], out.pixels[3]});
  if (!second) return second.error();
  const Vector3d inwards = first->ray_a + first->ray_b + second->ray_a + second->ray_b;
  out.tangents = {first->normal, second->normal};
  for (auto& normal : out.tangents) {
    if (normal.dot(inwards) < 0) normal = -normal;
    const double distance_px = std::abs(normal.dot(inwards.normalized())) * std::min(sighting.view->camera.fx, sighting.view->camera.fy);
    if (!(distance_px >= 1)) {
      return Error{ErrorCode::kDegenerate, labelOf(*sighting.view) + ": the two outlines of the pipe coincide: mark one on "
                                                                     "each side of it, or go nearer"};
    }
  }
  out.bisector = (out.tangents[0] - out.tangents[1]).normalized();
  return out;
}

// The view whose bisector plane meets that of the first most steeply.
Result<const PipeView*> partnerOf(const std::vector<PipeView>& views) {
  const PipeView* best = nullptr;
  double quality = 0;
  for (const auto& view : views) {
    const double sine = views.front().bisector.cross(view.bisector).norm();
    if (sine <= quality) continue;
    quality = sine;
    best = &view;
  }
  if (!(quality >= internal::kMinPlaneQuality)) return internal::alongBaseline(quality);
  return best;
}

Result<VectorXd> startOf(const std::vector<PipeView>& views) {
  const auto partner = partnerOf(views);
  if (!partner) return partner.error();
  const PipeView& first = views.front();
  VectorXd state(kStates);
  for (int end = 0; end < 2; ++end) {
    const auto ray = first.view->camera.rayOfPixel(first.middle(end));
    if (!ray) return Error{ErrorCode::kInvalidInput, labelOf(*first.view) + ": " + ray.error().message};
    const Vector3d direction = first.view->X_WC.linear() * *ray;
    const Vector3d& normal = (*partner)->bisector;
    const double distance = normal.dot((*partner)->centre() - first.centre()) / normal.dot(direction);
    if (!(distance > 0 && distance < 1e9)) {
      return Error{ErrorCode::kDegenerate, "the axis of the pipe meets a viewing ray behind " + labelOf(*first.view) +
                                               ": the pictures do not show the same pipe, or a view's pose is wrong"};
    }
    state.segment<3>(3 * end) = first.centre() + distance * direction;
  }
  const Vector3d middle = 0.5 * (state.head<3>() + state.segment<3>(3));
  state[6] = 0.5 * (std::abs(first.tangents[0].dot(middle - first.centre())) + std::abs(first.tangents[1].dot(middle - first.centre())));
  return state;
}

// Signed distance between the axis and a viewing ray; its sign tells the side.
double distanceToRay(const VectorXd& state, const Vector3d& centre, const Vector3d& ray) {
  const Vector3d across = (state.segment<3>(3) - state.head<3>()).cross(ray);
  return (state.head<3>() - centre).dot(across) / across.norm();
}

// A pick on an outline: its ray must touch the cylinder.  Derivatives by central differences of the closed form.
class OutlinePick {
 public:
  OutlinePick(const View& view, const Vector2d& pixel, double side) : m_view(view), m_pixel(pixel), m_side(side) {
    m_n = view.camera.normalisedOfPixel(pixel).value();   // checked by planeOf
  }

  // Distance of the ray from the cylinder [m], positive outside, with the camera moved and turned.
  double gap(const VectorXd& state, const Vector2d& n, const Vector6d& pose) const {
    const Vector3d ray = expSO3(pose.head<3>()) * (m_view.X_WC.linear() * Vector3d(n.x(), n.y(), 1));
    return m_side * distanceToRay(state, m_view.X_WC.translation() + pose.tail<3>(), ray) - state[6];
  }

  void fill(const VectorXd& state, int row, internal::FitRows* rows) const {
    constexpr double kStep = 1e-6;
    const Vector6d still = Vector6d::Zero();
    const auto slope = [&](auto value) { return (value(kStep) - value(-kStep)) / (2 * kStep); };
    Vector2d by_pixel;
    for (int i = 0; i < 2; ++i) {   // one pixel is 1 / f in normalised coordinates
      by_pixel[i] = slope([&](double h) {
        const auto n = m_view.camera.normalisedOfPixel(m_pixel + 1e3 * h * Vector2d::Unit(i));
        return n ? gap(state, *n, still) : std::nan("");
      }) / 1e3;
    }
    const double scale = by_pixel.norm();
    rows->residual[row] = -gap(state, m_n, still) / scale;
    for (int i = 0; i < kStates; ++i) {
      rows->d_state(row, i) = slope([&](double h) { return gap(state + h * VectorXd::Unit(kStates, i), m_n, still); }) / scale;
    }
    for (int i = 0; i < 6; ++i) {
      rows->d_pose(row, i) = slope([&](double h) { return gap(state, m_n, h * Vector6d::Unit(i)); }) / scale;
    }
    rows->d_intrinsics.row(row) = -(by_pixel / scale).transpose() * pixelByIntrinsics(m_view.camera, m_n);
    rows->sigma[row] = m_view.sigma_px;
    rows->views[static_cast<std::size_t>(row)] = &m_view;
  }

 private:
  const View& m_view;
  Vector2d m_pixel, m_n;
  double m_side;
};

// The first view's picks say where the axis ends: one row along its image.
Status endRow(const PipeView& first, const VectorXd& state, int end, int row, internal::FitRows* rows) {
  const View& view = *first.view;
  const Vector3d from_centre = state.segment<3>(3 * end) - first.centre();
  const Vector3d p_C = view.X_WC.linear().transpose() * from_centre;
  const auto projection = view.camera.projectWithJacobian(p_C);
  if (!projection) return {ErrorCode::kDegenerate, labelOf(view) + ": " + projection.error().message};
  const Eigen::Matrix<double, 2, 3> J = projection->d_point * view.X_WC.linear().transpose();
  const Vector2d along = (J * (state.segment<3>(3) - state.head<3>())).normalized();
  rows->residual[row] = along.dot(first.middle(end) - projection->pixel);
  rows->d_state.block<1, 3>(row, 3 * end) = along.transpose() * J;
  rows->d_pose.row(row) = along.transpose() * pixelByPose(J, from_centre);
  rows->d_intrinsics.row(row) = along.transpose() * pixelByIntrinsics(view.camera, p_C.head<2>() / p_C.z());
  rows->sigma[row] = view.sigma_px / std::sqrt(2.0);   // the middle of two picks
  rows->views[static_cast<std::size_t>(row)] = &view;
  return {};
}

internal::FitProblem problemOf(const std::vector<PipeView>& views, const VectorXd& start) {
  std::vector<OutlinePick> picks;
  for (const auto& view : views) {
    for (const auto& pixel : view.pixels) {
      const Vector3d ray = view.view->X_WC.linear() * view.view->camera.rayOfPixel(pixel).value();
      picks.emplace_back(*view.view, pixel, distanceToRay(start, view.centre(), ray) < 0 ? -1.0 : 1.0);
    }
  }
  internal::FitProblem problem;
  problem.plus = [](const VectorXd& state, const VectorXd& step) -> VectorXd { return state + step; };
  problem.rows = [picks, &views](const VectorXd& state) -> Result<internal::FitRows> {
    internal::FitRows rows;
    const int outlines = static_cast<int>(picks.size());
    rows.resize(outlines + 2, kStates);
    for (int i = 0; i < outlines; ++i) picks[static_cast<std::size_t>(i)].fill(state, i, &rows);
    for (int end = 0; end < 2; ++end) {
      if (auto status = endRow(views.front(), state, end, outlines + end, &rows); !status) return status.error();
    }
    if (!rows.residual.allFinite() || !rows.d_state.allFinite()) {
      return Error{ErrorCode::kDegenerate, "the outlines of the pipe do not determine its axis: mark longer pieces of them"};
    }
    return rows;
  };
  return problem;
}

double spreadOf(const std::vector<PipeView>& views, const VectorXd& state) {
  const Vector3d middle = 0.5 * (state.head<3>() + state.segment<3>(3));
  double least = 1e300, most = 0;
  for (const auto& view : views) {
    for (const auto& tangent : view.tangents) {
      const double distance = std::abs(tangent.dot(middle - view.centre()));
      least = std::min(least, distance);
      most = std::max(most, distance);
    }
  }
  return most - least;
}

Status checkInFront(const std::vector<PipeView>& views, const VectorXd& state) {
  for (const auto& view : views) {
    for (int end = 0; end < 2; ++end) {
      if ((state.segment<3>(3 * end) - view.centre()).dot(view.view->X_WC.linear().col(2)) > 0) continue;
      return {ErrorCode::kDegenerate, "the axis of the pipe passes behind " + labelOf(*view.view) +
                                          ": the pictures do not show the same pipe, or a view's pose is wrong"};
    }
  }
  return {};
}

Feature featureOf(const std::string& name, const std::vector<PipeView>& views, const internal::FitResult& fitted) {
  const MatrixXd covariance = fitted.covariance();
  Feature feature;
  feature.name = name;
  feature.kind = FeatureKind::kLine;
  feature.parent = views.front().view->parent;
  for (int end = 0; end < 2; ++end) {
    FeatureVertex vertex;
    vertex.xyz = fitted.state.segment<3>(3 * end);
    vertex.covariance = covariance.block<3, 3>(3 * end, 3 * end);
    vertex.reprojection_rms_px = fitted.rmsPx();
    for (const auto& view : views) vertex.views.push_back(view.view->name);
    feature.vertices.push_back(std::move(vertex));
  }
  feature.cross_covariance = covariance.block<3, 3>(0, 3);
  feature.pipe = PipeShape{fitted.state[6], std::sqrt(std::max(0.0, covariance(6, 6))), spreadOf(views, fitted.state)};
  if (fitted.chi2 > chi2Limit(fitted.degrees_of_freedom, kChi2Gross)) {
    feature.warnings.push_back("the outlines do not fit one round pipe: its radius is " + formatFixed(1e3 * feature.pipe->radius, 1) +
                               " mm but the outlines differ by " + formatFixed(1e3 * feature.pipe->radius_spread, 1) +
                               " mm; check the picks, then the calibration");
  }
  return feature;
}

}  // namespace

Result<Feature> estimatePipe(const std::string& name, const std::vector<PipeSighting>& sightings) {
  if (sightings.size() < 2 || sightings.size() > 100) {
    return Error{ErrorCode::kInvalidInput, "a pipe needs its outlines in two or more views (at most 100); there are " +
                                               std::to_string(sightings.size())};
  }
  std::vector<PipeView> views;
  for (const auto& sighting : sightings) {
    auto view = viewOf(sighting);
    if (!view) return view.error();
    if (view->view->parent != sightings.front().view->parent) {
      return Error{ErrorCode::kInvalidInput, labelOf(*sightings.front().view) + " and " + labelOf(*view->view) +
                                                 " have different parent frames; views must share one"};
    }
    views.push_back(std::move(*view));
  }
  const auto start = startOf(views);
  if (!start) return start.error();
  const auto fitted = internal::fit(problemOf(views, *start), *start);
  if (!fitted) return fitted.error();
  if (auto status = checkInFront(views, fitted->state); !status) return status.error();
  if (!(fitted->state[6] > 0)) {
    return Error{ErrorCode::kDegenerate, "the outlines of the pipe leave no radius: mark one on each side of it"};
  }
  return featureOf(name, views, *fitted);
}

}  // namespace longarm::vision
