// Suggested matches in real photographs whose truth is known.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/test_data.h"
#include "tests/vision/middlebury_data.h"
#include "vision/match/suggest.h"
#include "vision/snapshot/image_file.h"

namespace longarm::tests {
namespace {

using Eigen::Vector2d;
using vision::MatchPicture;

// Grey slope along the row around a pixel, root mean square [grey levels/px].
double textureAt(const MatchPicture& picture, int u, int v) {
  double sum = 0;
  for (int row = v - 5; row <= v + 5; ++row) {
    for (int column = u - 5; column <= u + 5; ++column) {
      const float slope = 0.5f * (picture.linear(static_cast<float>(column + 1), static_cast<float>(row)) -
                                  picture.linear(static_cast<float>(column - 1), static_cast<float>(row)));
      sum += slope * slope;
    }
  }
  return std::sqrt(sum / 121);
}

struct Figures {
  int offered = 0, good = 0, points = 0;
};

class MatchPhotographs : public testing::TestWithParam<const char*> {};

TEST_P(MatchPhotographs, OfferedMatchesAreRight) {
  LONGARM_SKIP_WITHOUT_DATA();
  const std::string folder = dataFolder() + "/middlebury2014_quarter/" + GetParam();
  const MiddleburyData scene = loadMiddlebury(folder);
  ASSERT_FALSE(scene.disparity.empty());
  const auto left_image = vision::loadImage(folder + "/im0.png"), right_image = vision::loadImage(folder + "/im1.png");
  ASSERT_TRUE(left_image.ok() && right_image.ok());
  const auto left = MatchPicture::from(*left_image), right = MatchPicture::from(*right_image);
  ASSERT_TRUE(left.ok() && right.ok());
  const vision::View left_view = scene.view(false), right_view = scene.view(true);
  Dice dice(2014);
  Figures figures;
  while (figures.points < 500) {
    const int u = static_cast<int>(dice.uniform(8, scene.width - 8)), v = static_cast<int>(dice.uniform(8, scene.height - 8));
    if (!std::isfinite(scene.at(u, v)) || textureAt(*left, u, v) < 4) continue;
    ++figures.points;
    const auto matches = vision::suggestMatches(left_view, *left, Vector2d(u, v), right_view, *right);
    ASSERT_TRUE(matches.ok()) << matches.error().message;
    if (matches->empty() || matches->front().score <= vision::kOfferScore) continue;
    ++figures.offered;
    const double error = std::abs(matches->front().pixel.x() - (u - static_cast<double>(scene.at(u, v))));
    if (error <= 1) ++figures.good;
  }
  RecordProperty("offered", figures.offered);
  RecordProperty("good", figures.good);
  EXPECT_GE(figures.offered, 110) << "a help that hardly ever helps";
  EXPECT_GE(figures.good, 0.95 * figures.offered) << figures.good << " of " << figures.offered;
}

INSTANTIATE_TEST_SUITE_P(Photographs, MatchPhotographs, testing::Values("Motorcycle", "Recycle"));

}  // namespace
}  // namespace longarm::tests
