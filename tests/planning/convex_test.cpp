// Our distances of primitives against FCL's, and against points of both bodies, which no distance may exceed.
#include <random>

#include <gtest/gtest.h>

#include "planning/collision/convex.h"
#include "planning/collision/fcl_shapes.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;

class Draw {
 public:
  double number(double low, double high) { return std::uniform_real_distribution<>(low, high)(m_random); }
  Vector3d vector(double most) { return {number(-most, most), number(-most, most), number(-most, most)}; }
  Shape shape() {
    const int kind = std::uniform_int_distribution<>(0, 2)(m_random);
    if (kind == 0) return Box{{number(0.01, 0.6), number(0.01, 0.6), number(0.01, 0.6)}};
    if (kind == 1) return Cylinder{number(0.005, 0.2), number(0.01, 0.8)};
    return Sphere{number(0.005, 0.3)};
  }
  Pose pose(double most) {
    Pose X = Pose::Identity();
    X.linear() = Eigen::Quaterniond(number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)).normalized().toRotationMatrix();
    X.translation() = vector(most);
    return X;
  }
  // A point of the body.
  Vector3d inside(const Shape& shape) {
    if (const auto* box = std::get_if<Box>(&shape)) return 0.5 * box->size.cwiseProduct(Vector3d(end(), end(), end()));
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
      const double angle = number(-M_PI, M_PI);
      return {cylinder->radius * std::cos(angle), cylinder->radius * std::sin(angle), 0.5 * cylinder->length * end()};
    }
    return std::get<Sphere>(shape).radius * vector(1).normalized();
  }

 private:
  double end() { return number(0, 1) < 0.5 ? number(-1, 1) : (number(0, 1) < 0.5 ? -1 : 1); }
  std::mt19937 m_random{5};
};

TEST(Convex, DistancesAreFclsAndNeverMoreThanThatOfTwoPoints) {
  Draw draw;
  int touching = 0, undecided = 0;
  for (int i = 0; i < 20000; ++i) {
    const Shape first = draw.shape(), second = draw.shape();
    const Pose X_A = draw.pose(0.4), X_B = draw.pose(0.4);
    const auto a = *internal::convexOf(first), b = *internal::convexOf(second);
    const auto ours = internal::convexDistance(a, X_A, b, X_B, 10);
    if (!ours) {
      ++undecided;
      continue;
    }
    const double theirs = internal::fclDistance(*internal::toFcl(first), X_A, *internal::toFcl(second), X_B, 10);
    ASSERT_NEAR(*ours, theirs, 1e-3) << "pair " << i << " (theirs stops early on round bodies)";
    touching += *ours == 0;
    for (int k = 0; k < 8; ++k) {
      ASSERT_LE(*ours, (X_A * draw.inside(first) - X_B * draw.inside(second)).norm() + 1e-9) << "pair " << i;
    }
    for (const double limit : {0.0, 0.005, 0.1}) {
      const auto within = internal::convexWithin(a, X_A, b, X_B, limit);
      if (within && std::abs(*ours - limit) > 1e-6) {
        ASSERT_EQ(*within, *ours <= limit) << "pair " << i << ", " << limit;
      }
    }
    const auto capped = internal::convexDistance(a, X_A, b, X_B, 0.05);
    ASSERT_TRUE(capped);
    ASSERT_TRUE(*ours < 0.05 ? std::abs(*capped - *ours) < 1e-6 : *capped >= 0.05 && *capped <= *ours + 1e-9) << "pair " << i;
  }
  EXPECT_GT(touching, 2000);
  EXPECT_LT(undecided, 20);
}

TEST(Convex, KnownDistancesAreMet) {
  const auto box = *internal::convexOf(Box{{0.2, 0.2, 0.2}});
  const auto cylinder = *internal::convexOf(Cylinder{0.05, 0.4});
  const auto ball = *internal::convexOf(Sphere{0.1});
  Pose X = Pose::Identity();
  EXPECT_EQ(*internal::convexDistance(box, X, box, X, 1), 0) << "one in the other";
  X.translation() = Vector3d(0.5, 0, 0);
  EXPECT_NEAR(*internal::convexDistance(box, Pose::Identity(), box, X, 1), 0.3, 1e-9);
  EXPECT_NEAR(*internal::convexDistance(box, Pose::Identity(), cylinder, X, 1), 0.35, 1e-9);
  EXPECT_NEAR(*internal::convexDistance(ball, Pose::Identity(), cylinder, X, 1), 0.35, 1e-9);
  X.translation() = Vector3d(0.2, 0, 0);
  EXPECT_NEAR(*internal::convexDistance(box, Pose::Identity(), box, X, 1), 0, 1e-9) << "faces that meet";
  X.translation() = Vector3d(0.3, 0.4, 0.6);
  EXPECT_NEAR(*internal::convexDistance(ball, Pose::Identity(), ball, X, 1), std::sqrt(0.61) - 0.2, 1e-12);
  EXPECT_FALSE(internal::convexOf(Box{{0.2, 0, 0.2}}));
  EXPECT_FALSE(internal::convexOf(Sphere{std::nan("")}));
}

}  // namespace
}  // namespace longarm::planning
