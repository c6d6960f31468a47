// Lines whose ends do not correspond, mixed with matched ends, and pipes by their outlines.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/vision/stereo_rig.h"
#include "vision/snapshot/views_file.h"
#include "vision/stereo/line.h"
#include "vision/stereo/pipe.h"

namespace longarm::tests {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using vision::estimateLine;
using vision::LinePicks;
using vision::LineSighting;
using vision::PipeSighting;
using vision::View;

constexpr double kDegree = 0.017453292519943295;

struct TrueLine {
  Vector3d a, b;
  Vector3d at(double s) const { return a + s * (b - a); }
  Vector3d direction() const { return (b - a).normalized(); }
};

LineSighting seen(const View& view, const TrueLine& line, double s0, double s1, Dice* dice = nullptr) {
  const Vector2d noise0 = dice ? dice->normal2(0.5) : Vector2d::Zero(), noise1 = dice ? dice->normal2(0.5) : Vector2d::Zero();
  return {&view, view.project(line.at(s0)).value() + noise0, view.project(line.at(s1)).value() + noise1};
}

TEST(EdgeLine, MeetsThePlanesAndKeepsTheFirstViewsEnds) {
  const StereoRig rig;
  const TrueLine line{{0.05, -0.2, 1.4}, {0.12, 0.2, 1.6}};
  const auto feature = estimateLine("edge", LinePicks{{}, {}, {seen(rig.left, line, 0.1, 0.7), seen(rig.right, line, 0.3, 1)}});
  ASSERT_TRUE(feature.ok()) << feature.error().message;
  EXPECT_LT((feature->vertices[0].xyz - line.at(0.1)).norm(), 1e-9);
  EXPECT_LT((feature->vertices[1].xyz - line.at(0.7)).norm(), 1e-9);
  EXPECT_GT(feature->lengthSigma(), 0);
}

TEST(EdgeLine, AlongTheBaselineIsRefusedWithTheBaselineMessage) {
  const StereoRig rig(false);
  for (const double beta : {0.0, 5.0, 12.0}) {
    const double b = beta * kDegree;
    const TrueLine line{{-0.1 * std::cos(b), 0.05 - 0.2 * std::sin(b), 1.5}, {0.3 * std::cos(b), 0.05 + 0.2 * std::sin(b), 1.5}};
    const auto feature = estimateLine("edge", LinePicks{{}, {}, {seen(rig.left, line, 0, 1), seen(rig.right, line, 0.2, 0.8)}});
    ASSERT_FALSE(feature.ok()) << beta;
    EXPECT_EQ(feature.error().code, ErrorCode::kDegenerate);
    EXPECT_NE(feature.error().message.find("baseline"), std::string::npos) << feature.error().message;
  }
}

// Direction errors of a 0.4 m line at 1.5 m that encloses `beta` with the baseline, median [deg], by planes alone, and
// root mean square by matched ends.
std::pair<double, double> directionErrors(double beta) {
  const StereoRig rig(false);
  const Vector3d d(std::cos(beta), std::sin(beta), 0), c(0.1, 0.05, 1.5);
  const TrueLine line{c - 0.2 * d, c + 0.2 * d};
  Dice dice(17);
  std::vector<double> planes;
  double squares = 0;
  const int trials = 1000;
  for (int i = 0; i < trials; ++i) {
    const auto left = seen(rig.left, line, 0, 1, &dice);
    const auto unmatched = seen(rig.right, line, dice.uniform(-0.25, 0.25), 1 + dice.uniform(-0.25, 0.25), &dice);
    const auto matched = seen(rig.right, line, 0, 1, &dice);
    const auto by_planes = estimateLine("edge", LinePicks{{}, {}, {left, unmatched}});
    const auto by_ends = estimateLine("line", LinePicks{{{&rig.left, left.pixel_a, 0}, {&rig.right, matched.pixel_a, 0}},
                                                        {{&rig.left, left.pixel_b, 0}, {&rig.right, matched.pixel_b, 0}}, {}});
    const auto error = [&](const vision::Feature& f) { return std::acos(std::min(1.0, std::abs(f.direction().dot(line.direction())))) / kDegree; };
    if (by_planes.ok()) planes.push_back(error(*by_planes));
    squares += std::pow(error(*by_ends), 2) / trials;
  }
  if (planes.empty()) return {-1, std::sqrt(squares)};
  std::nth_element(planes.begin(), planes.begin() + static_cast<long>(planes.size() / 2), planes.end());
  return {planes[planes.size() / 2], std::sqrt(squares)};
}

TEST(EdgeLine, DirectionsAreAsGoodAsTheTableSays) {
  const std::pair<double, double> rows[] = {{90, 1.2}, {60, 1.3}};   // at 30 degrees half are refused
  for (const auto& [beta, median] : rows) {
    const auto [planes, ends] = directionErrors(beta * kDegree);
    EXPECT_NEAR(planes, median, 0.12 * median) << beta;
    EXPECT_NEAR(ends, 1.6, 0.16) << beta << ": matched ends do not depend on how the line lies";
  }
}

TEST(EdgeLine, AThirdViewsEdgeSharpensMatchedEndsAsStated) {
  const StereoRig rig;
  const View third = viewOf(lensCamera("third"), {0.1, 0.5, 0.2}, {0.3, 0, 0});
  const TrueLine line{{-0.15, 0.02, 1.5}, {0.2, 0.05, 1.55}};
  Dice dice(3);
  const int trials = 500;
  double with = 0, without = 0, stated = 0;
  for (int i = 0; i < trials; ++i) {
    const auto l = seen(rig.left, line, 0, 1, &dice), r = seen(rig.right, line, 0, 1, &dice);
    LinePicks picks{{{&rig.left, l.pixel_a, 0}, {&rig.right, r.pixel_a, 0}}, {{&rig.left, l.pixel_b, 0}, {&rig.right, r.pixel_b, 0}}, {}};
    without += (estimateLine("line", picks)->vertices[0].xyz - line.a).squaredNorm() / trials;
    picks.along.push_back(seen(third, line, 0.2, 0.9, &dice));
    const auto all = estimateLine("line", picks);
    ASSERT_TRUE(all.ok()) << all.error().message;
    with += (all->vertices[0].xyz - line.a).squaredNorm() / trials;
    stated += all->vertices[0].covariance.trace() / trials;
  }
  EXPECT_LT(with, 0.6 * without);
  EXPECT_NEAR(with, stated, 0.15 * stated);
}

// The outline of a cylinder as a camera sees it: the point of the surface whose normal is square to the viewing ray.
Vector2d outline(const View& view, const TrueLine& axis, double radius, double s, double side) {
  const Vector3d p = axis.at(s), d = axis.direction();
  Vector3d to = view.X_WC.translation() - p;
  to -= d * d.dot(to);
  const double distance = to.norm(), sine = radius / distance;
  const Vector3d across = d.cross(to / distance);
  return view.project(p + radius * (sine * to / distance + side * std::sqrt(1 - sine * sine) * across)).value();
}

PipeSighting pipeIn(const View& view, const TrueLine& axis, double radius, Dice* dice = nullptr) {
  const auto noise = [&]() -> Vector2d { return dice ? dice->normal2(0.5) : Vector2d::Zero(); };
  PipeSighting out{&view, outline(view, axis, radius, 0, 1) + noise(), outline(view, axis, radius, 1, 1) + noise(),
                   outline(view, axis, radius, 1, -1) + noise(), outline(view, axis, radius, 0, -1) + noise()};
  return out;
}

TEST(Pipe, AxisAndRadiusAreExactWithoutNoise) {
  const StereoRig rig;
  const TrueLine axis{{-0.02, -0.15, 1.1}, {0.08, 0.18, 1.25}};
  const auto pipe = vision::estimatePipe("pipe", {pipeIn(rig.left, axis, 0.03), pipeIn(rig.right, axis, 0.03)});
  ASSERT_TRUE(pipe.ok()) << pipe.error().message;
  ASSERT_TRUE(pipe->pipe);
  EXPECT_NEAR(pipe->pipe->radius, 0.03, 1e-8);
  EXPECT_LT(pipe->pipe->radius_spread, 1e-7);
  EXPECT_LT(axis.direction().cross(pipe->direction()).norm(), 1e-7);
  EXPECT_LT((pipe->vertices[0].xyz - axis.a).cross(axis.direction()).norm(), 1e-8) << "off the axis";
  EXPECT_TRUE(pipe->warnings.empty());
  const auto json = toJson(*pipe);
  EXPECT_EQ(json["kind"], "line");
  const auto back = vision::featureFromJson(json);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->pipe->radius, pipe->pipe->radius);
}

TEST(Pipe, ScattersAsStated) {
  const StereoRig rig;
  const TrueLine axis{{-0.02, -0.15, 1.1}, {0.08, 0.18, 1.25}};
  Dice dice(29);
  const int trials = 600;
  double radius2 = 0, radius_stated = 0, across2 = 0, across_stated = 0;
  int warned = 0;
  const Matrix3d across = Matrix3d::Identity() - axis.direction() * axis.direction().transpose();
  for (int i = 0; i < trials; ++i) {
    const auto pipe = vision::estimatePipe("pipe", {pipeIn(rig.left, axis, 0.03, &dice), pipeIn(rig.right, axis, 0.03, &dice)});
    ASSERT_TRUE(pipe.ok()) << pipe.error().message;
    radius2 += std::pow(pipe->pipe->radius - 0.03, 2) / trials;
    radius_stated += std::pow(pipe->pipe->radius_sigma, 2) / trials;
    across2 += (across * (pipe->vertices[0].xyz - axis.a)).squaredNorm() / trials;
    across_stated += (across * pipe->vertices[0].covariance * across).trace() / trials;
    warned += pipe->warnings.empty() ? 0 : 1;
  }
  EXPECT_NEAR(std::sqrt(radius2 / radius_stated), 1, 0.1);
  EXPECT_NEAR(std::sqrt(across2 / across_stated), 1, 0.1);
  EXPECT_LE(warned, 6) << "a warning at 99.9 %";
}

TEST(Pipe, OutlinesOfDifferentRadiiAreWarned) {
  const StereoRig rig;
  const TrueLine axis{{-0.02, -0.15, 1.1}, {0.08, 0.18, 1.25}};
  const auto pipe = vision::estimatePipe("pipe", {pipeIn(rig.left, axis, 0.03), pipeIn(rig.right, axis, 0.04)});
  ASSERT_TRUE(pipe.ok()) << pipe.error().message;
  EXPECT_GT(pipe->pipe->radius_spread, 0.005);
  ASSERT_FALSE(pipe->warnings.empty());
  EXPECT_NE(pipe->warnings.front().find("differ by"), std::string::npos) << pipe->warnings.front();
}

TEST(Pipe, AlongTheBaselineOrWithOneOutlineIsRefused) {
  const StereoRig rig(false);
  const TrueLine along{{-0.1, 0.05, 1.2}, {0.2, 0.05, 1.2}}, upright{{0.05, -0.15, 1.2}, {0.05, 0.15, 1.2}};
  const auto flat = vision::estimatePipe("pipe", {pipeIn(rig.left, along, 0.03), pipeIn(rig.right, along, 0.03)});
  ASSERT_FALSE(flat.ok());
  EXPECT_NE(flat.error().message.find("baseline"), std::string::npos) << flat.error().message;
  auto left = pipeIn(rig.left, upright, 0.03);
  left.second_a = left.first_a;
  left.second_b = left.first_b;
  const auto single = vision::estimatePipe("pipe", {left, pipeIn(rig.right, upright, 0.03)});
  ASSERT_FALSE(single.ok());
  EXPECT_NE(single.error().message.find("coincide"), std::string::npos) << single.error().message;
  EXPECT_FALSE(vision::estimatePipe("pipe", {pipeIn(rig.left, upright, 0.03)}).ok());
}

std::string row(const std::string& feature, const std::string& kind, int vertex, const std::string& view, const Vector2d& p) {
  return feature + "," + kind + "," + std::to_string(vertex) + "," + view + "," + std::to_string(p.x()) + "," + std::to_string(p.y()) + "\n";
}

TEST(PicksFile, EdgesAndPipesMeasureLines) {
  const StereoRig rig;
  const TrueLine line{{0.05, -0.2, 1.4}, {0.12, 0.2, 1.6}};
  std::string text = "feature,kind,vertex,view,u,v\n";
  for (const auto* view : {&rig.left, &rig.right}) {
    const auto edge = seen(*view, line, view == &rig.left ? 0.0 : 0.2, 0.9);
    text += row("shelf", "edge", 0, view->name, edge.pixel_a) + row("shelf", "edge", 1, view->name, edge.pixel_b);
    const auto pipe = pipeIn(*view, line, 0.04);
    text += row("rail", "pipe", 0, view->name, pipe.first_a) + row("rail", "pipe", 1, view->name, pipe.first_b) +
            row("rail", "pipe", 2, view->name, pipe.second_a) + row("rail", "pipe", 3, view->name, pipe.second_b);
  }
  vision::ViewSet views;
  for (const auto* view : {&rig.left, &rig.right}) views.entries.push_back({*view, "", "", {}});
  const auto picks = vision::parsePicks(text, "picks.csv");
  ASSERT_TRUE(picks.ok()) << picks.error().message;
  const auto features = vision::measureAll(views, *picks);
  ASSERT_TRUE(features.ok()) << features.error().message;
  ASSERT_EQ(features->size(), 2u);
  ASSERT_TRUE((*features)[0].outcome.ok()) << (*features)[0].outcome.error().message;
  EXPECT_LT(line.direction().cross((*features)[0].outcome->direction()).norm(), 1e-4);
  ASSERT_TRUE((*features)[1].outcome.ok()) << (*features)[1].outcome.error().message;
  EXPECT_NEAR((*features)[1].outcome->pipe->radius, 0.04, 1e-5);
  const auto half = vision::measureAll(views, {picks->begin(), picks->end() - 1});
  ASSERT_TRUE(half.ok());
  ASSERT_FALSE((*half)[1].outcome.ok());
  EXPECT_NE((*half)[1].outcome.error().message.find("vertex 3"), std::string::npos) << (*half)[1].outcome.error().message;
}

}  // namespace
}  // namespace longarm::tests
