// picks.csv and the features that come of it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "tests/vision/stereo_rig.h"
#include "tests/vision/temporary_file.h"
#include "vision/snapshot/views_file.h"

namespace longarm::tests {
namespace {

using vision::FeatureKind;
using vision::parsePicks;

const std::string kHeader = "feature,kind,vertex,view,u,v\n";

vision::ViewSet viewsOf(const StereoRig& rig) {
  vision::ViewSet set;
  for (const auto* view : {&rig.left, &rig.right}) {
    vision::ViewEntry entry;
    entry.view = *view;
    set.entries.push_back(entry);
  }
  return set;
}

std::string rows(const StereoRig& rig, const std::string& feature, const std::string& kind, int vertex,
                 const Eigen::Vector3d& p_W) {
  std::string out;
  for (const auto* view : {&rig.left, &rig.right}) {
    const auto pixel = view->project(p_W).value();
    out += feature + "," + kind + "," + std::to_string(vertex) + "," + view->name + "," + formatNumber(pixel.x()) +
           "," + formatNumber(pixel.y()) + "\n";
  }
  return out;
}

std::string withReturns(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return out;
}

TEST(PicksFile, ReadsLinesThatEndEitherWay) {
  const std::string text = kHeader + "pipe,line,0,left,12.5,-3e1\n\npipe , line , 1 , right , 4 , 5\n";
  for (const std::string& variant : {text, withReturns(text), "\xEF\xBB\xBF" + text, text.substr(0, text.size() - 1)}) {
    const auto picks = parsePicks(variant, "picks.csv");
    ASSERT_TRUE(picks.ok()) << picks.error().message;
    ASSERT_EQ(picks->size(), 2u);
    EXPECT_EQ((*picks)[0].feature, "pipe");
    EXPECT_EQ((*picks)[0].kind, FeatureKind::kLine);
    EXPECT_EQ((*picks)[0].pixel, Eigen::Vector2d(12.5, -30));
    EXPECT_EQ((*picks)[1].vertex, 1);
    EXPECT_EQ((*picks)[1].view, "right");
    EXPECT_EQ((*picks)[1].line, 4);
  }
}

TEST(PicksFile, ADecimalCommaLocaleChangesNothing) {
  const DecimalComma comma;
  if (!comma.active()) GTEST_SKIP() << "skipped: no decimal-comma locale is installed";
  const auto picks = parsePicks(kHeader + "a,point,0,left,12.75,0.125\n", "picks.csv");
  ASSERT_TRUE(picks.ok()) << picks.error().message;
  EXPECT_EQ((*picks)[0].pixel, Eigen::Vector2d(12.75, 0.125));
}

TEST(PicksFile, RefusalsNameFileLineColumnAndValue) {
  const auto expect = [](const std::string& text, const std::string& part) {
    const auto picks = parsePicks(text, "my.csv");
    ASSERT_FALSE(picks.ok()) << text;
    EXPECT_EQ(picks.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(picks.error().message.find("my.csv"), std::string::npos) << picks.error().message;
    EXPECT_NE(picks.error().message.find(part), std::string::npos) << picks.error().message << "\n  should say: " << part;
  };
  expect("", "no picks");
  expect(kHeader, "no picks");
  expect("name,kind,vertex,view,u,v\na,point,0,left,1,2\n", "line 1: header");
  expect(kHeader + "a,point,0,left,1\n", "line 2: has 5 columns");
  expect(kHeader + "a,point,0,left,1,5,2,5\n", "line 2: has 8 columns");
  expect(kHeader + ",point,0,left,1,2\n", "no name");
  expect(kHeader + "a,dot,0,left,1,2\n", "\"dot\"");
  expect(kHeader + "a,point,1,left,1,2\n", "vertex \"1\"");
  expect(kHeader + "a,line,-1,left,1,2\n", "vertex \"-1\"");
  expect(kHeader + "a,point,0,left,x,2\n", "u \"x\"");
  expect(kHeader + "a,point,0,left,1,nan\n", "v \"nan\"");
  expect(kHeader + "a,point,0,left,1e9,2\n", "1e9");
  EXPECT_EQ(vision::readPicksFile("/no/such/picks.csv").error().code, ErrorCode::kNotFound);
}

TEST(MeasureAll, MeasuresEveryFeatureInTheOrderOfItsFirstPick) {
  const StereoRig rig;
  const auto picks = parsePicks(kHeader + rows(rig, "pipe", "line", 0, {-0.1, 0, 1.5}) +
                                    rows(rig, "dot", "point", 0, {0.2, 0.1, 1.2}) +
                                    rows(rig, "pipe", "line", 1, {0.2, 0, 1.5}) +
                                    "lone,point,0,left,300,200\n",
                                "picks.csv");
  ASSERT_TRUE(picks.ok());
  const auto features = measureAll(viewsOf(rig), *picks);
  ASSERT_TRUE(features.ok()) << features.error().message;
  ASSERT_EQ(features->size(), 3u);
  EXPECT_EQ((*features)[0].name, "pipe");
  ASSERT_TRUE((*features)[0].outcome.ok());
  EXPECT_NEAR((*features)[0].outcome->length(), 0.3, 1e-9);
  EXPECT_EQ((*features)[1].name, "dot");
  EXPECT_FALSE((*features)[2].outcome.ok()) << "one view is not enough";
  const auto json = vision::targetJson(*features);
  EXPECT_EQ(json["features"].size(), 3u);
  EXPECT_EQ(json["features"][2]["status"], "invalid_input");
  EXPECT_TRUE(json["features"][2].contains("reason"));
  EXPECT_FALSE(json.contains("status")) << "two succeeded";
}

TEST(MeasureAll, PicksThatContradictAreAnErrorOfTheWhole) {
  const StereoRig rig;
  const auto refusal = [&](const std::string& text) {
    const auto picks = parsePicks(kHeader + text, "picks.csv");
    EXPECT_TRUE(picks.ok());
    const auto features = measureAll(viewsOf(rig), *picks);
    return features.ok() ? std::string("measured") : features.error().message;
  };
  const std::string unknown = refusal("a,point,0,middle,1,2\n");
  EXPECT_NE(unknown.find("line 2"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("middle"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("left, right"), std::string::npos) << unknown;
  EXPECT_NE(refusal("a,point,0,left,1,2\na,line,0,right,1,2\n").find("is a line here but a point"), std::string::npos);
  EXPECT_NE(refusal("a,point,0,left,1,2\na,point,0,left,3,4\n").find("twice"), std::string::npos);
}

TEST(MeasureAll, WhenNothingSucceedsTheWholeSaysWhy) {
  const StereoRig rig;
  const auto picks = parsePicks(kHeader + "a,point,0,left,300,200\n", "picks.csv");
  const auto features = measureAll(viewsOf(rig), *picks);
  ASSERT_TRUE(features.ok());
  const auto json = vision::targetJson(*features);
  EXPECT_EQ(json["status"], "invalid_input");
  EXPECT_GT(json["reason"].get<std::string>().size(), 10u);
}

}  // namespace
}  // namespace longarm::tests
