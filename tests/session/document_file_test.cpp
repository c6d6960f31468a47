// Sketches on disk.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "core/text.h"
#include "session/document/document_file.h"
#include "tests/session/synthetic_views.h"
#include "tests/support/fuzz.h"

namespace longarm::session {
namespace {

namespace fs = std::filesystem;
using tests::Bench;
using tests::trueLine;

class SketchFile : public testing::Test {
 protected:
  SketchFile() {
    folder = fs::temp_directory_path() / ("longarm_sketch_" + std::to_string(::getpid()) + "_" +
                                          testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
  }
  ~SketchFile() override {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  std::string path() const { return folder.string(); }
  std::string json() const { return (folder / kSketchFileName).string(); }
  nlohmann::json content() const { return nlohmann::json::parse(readTextFile(json()).value()); }
  void write(const nlohmann::json& root) const { std::ofstream(json()) << root.dump(); }
  /// The refusal of the saved sketch after `change`.
  template <typename Change>
  std::string refusal(Change change) {
    nlohmann::json root = content();
    change(root);
    const nlohmann::json good = content();
    write(root);
    const auto loaded = loadSketch(path());
    write(good);
    return loaded ? "taken" : loaded.error().message;
  }
  fs::path folder;
};

/// A document small enough to be damaged thousands of times.
DocumentState smallState() {
  tests::StereoScene scene;
  DocumentState state;
  for (vision::View view : {scene.left, scene.right}) {
    auto snapshot = std::make_shared<vision::Snapshot>();
    view.camera.width = 24;
    view.camera.height = 16;
    snapshot->id = {state.snapshots.size() + 1};
    snapshot->view = view;
    snapshot->view.pose_covariance = Matrix6d::Identity() * 1e-6;
    snapshot->view.pose_covariance(0, 5) = 1e-7;
    snapshot->view.zoom = 1.0 / 3;
    snapshot->image = cv::Mat(16, 24, CV_8UC3, cv::Scalar(10, 200, static_cast<double>(state.snapshots.size())));
    snapshot->stamp_s = 12.345678901234567;
    snapshot->wall_time_s = 1.7e9 + 0.1;
    snapshot->robot_state.names = {"head_pan_joint", "head_tilt_joint"};
    snapshot->robot_state.positions = Eigen::Vector2d(0.1, -0.2);
    snapshot->robot_state.velocities = Eigen::Vector2d(0, 1e-3);
    snapshot->source = "live";
    state.snapshots.push_back(snapshot);
  }
  state.panes = {SnapshotId{2}, SnapshotId{1}};
  SketchItem item;
  item.id = {5};
  item.kind = vision::FeatureKind::kLine;
  item.name = "Rohr \"A\", 1 \u00b1";
  item.colour = 0x00ff80;
  item.locked = true;
  item.setPick({1}, 0, {{1.0 / 3, 7.1}, PickState::kFree});
  item.setPick({2}, 0, {{std::nextafter(2.0, 3.0), 7.1}, PickState::kConstrained});
  item.setPick({2}, 1, {{11, 2}, PickState::kReleased});
  state.items.push_back(item);
  return state;
}

TEST_F(SketchFile, GivesBackWhatWasSaved) {
  const DocumentState state = smallState();
  ASSERT_TRUE(saveSketch(path(), state));
  const auto loaded = loadSketch(path());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->items, state.items) << "bit for bit";
  EXPECT_EQ(loaded->panes, state.panes);
  ASSERT_EQ(loaded->snapshots.size(), 2u);
  const vision::Snapshot &a = *state.snapshots[1], &b = *loaded->snapshots[1];
  EXPECT_EQ(b.id, a.id);
  EXPECT_EQ(b.view.name, a.view.name);
  EXPECT_EQ(b.view.parent, a.view.parent);
  EXPECT_EQ(b.view.camera.fx, a.view.camera.fx);
  EXPECT_EQ(b.view.camera.cx, a.view.camera.cx);
  EXPECT_EQ(b.view.camera.distortion, a.view.camera.distortion);
  EXPECT_LT((b.view.X_WC.matrix() - a.view.X_WC.matrix()).norm(), 1e-14) << "quaternion and back";
  EXPECT_EQ(b.view.pose_covariance, a.view.pose_covariance);
  EXPECT_EQ(b.view.zoom, a.view.zoom);
  EXPECT_EQ(b.stamp_s, a.stamp_s);
  EXPECT_EQ(b.wall_time_s, a.wall_time_s);
  EXPECT_EQ(b.robot_state.names, a.robot_state.names);
  EXPECT_EQ(b.robot_state.positions, a.robot_state.positions);
  EXPECT_EQ(b.robot_state.velocities, a.robot_state.velocities);
  ASSERT_EQ(b.image.type(), a.image.type());
  EXPECT_EQ(cv::norm(a.image, b.image, cv::NORM_INF), 0);
  EXPECT_TRUE(loadSketch(json())) << "by the name of the file too";
}

TEST_F(SketchFile, MeasuresTheSameAfterwards) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  ASSERT_TRUE(saveSketch(path(), bench.document.state()));
  Document again;
  again.reset(loadSketch(path()).value());
  const auto &before = *bench.document.measurement({1}).feature, &after = *again.measurement({1}).feature;
  EXPECT_NEAR((before.vertices[0].xyz - after.vertices[0].xyz).norm(), 0, 1e-12);
  EXPECT_EQ(again.nextFeatureId(), FeatureId{2});
  EXPECT_EQ(again.nextSnapshotId(), SnapshotId{3});
}

TEST_F(SketchFile, SavesAnEmptySketch) {
  ASSERT_TRUE(saveSketch(path(), {}));
  const auto loaded = loadSketch(path());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->items.empty());
}

TEST_F(SketchFile, KeepsPicturesOfAnEarlierSaveAndRemovesThoseNobodyNeeds) {
  const DocumentState state = smallState();
  ASSERT_TRUE(saveSketch(path(), state));
  std::vector<std::pair<fs::path, fs::file_time_type>> before;
  for (const auto& entry : fs::directory_iterator(folder)) before.emplace_back(entry.path(), fs::last_write_time(entry));
  EXPECT_EQ(before.size(), 3u);
  DocumentState fewer = state;
  fewer.items.clear();
  fewer.snapshots.pop_back();
  fewer.panes = {};
  ASSERT_TRUE(saveSketch(path(), fewer));
  std::size_t left = 0;
  for (const auto& [file, time] : before) {
    if (!fs::exists(file)) continue;
    ++left;
    if (file.extension() == ".png") {
      EXPECT_EQ(fs::last_write_time(file), time) << "not written again";
    }
  }
  EXPECT_EQ(left, 2u);
}

TEST_F(SketchFile, DoesNotTakeAnotherSessionsPictureForItsOwn) {
  DocumentState state = smallState();
  ASSERT_TRUE(saveSketch(path(), state));
  auto other = std::make_shared<vision::Snapshot>(*state.snapshots[0]);
  other->image = cv::Mat(16, 24, CV_8UC3, cv::Scalar(1, 2, 3));   // Same id, another picture.
  state.snapshots[0] = other;
  ASSERT_TRUE(saveSketch(path(), state));
  const auto loaded = loadSketch(path());
  ASSERT_TRUE(loaded);
  EXPECT_EQ(cv::norm(loaded->snapshots[0]->image, other->image, cv::NORM_INF), 0);
}

TEST_F(SketchFile, NamesFileKeyAndValueOfWhatItRefuses) {
  ASSERT_TRUE(saveSketch(path(), smallState()));
  const auto expect = [&](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(kSketchFileName), std::string::npos) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(refusal([](auto& j) { j["format"] = 9; }), "format is 9, this version reads 1");
  expect(refusal([](auto& j) { j.erase("items"); }), "has no \"items\"");
  expect(refusal([](auto& j) { j["items"][0]["kind"] = "blob"; }), "items[0].kind is \"blob\"");
  expect(refusal([](auto& j) { j["items"][0]["picks"][0]["vertex"] = 2; }), "vertex is 2, a line has 2");
  expect(refusal([](auto& j) { j["items"][0]["picks"][0]["snapshot"] = 7; }), "snapshot is 7, which the file does not hold");
  expect(refusal([](auto& j) { j["items"][0]["picks"][0]["state"] = "stuck"; }), "is \"stuck\", expected unplaced");
  expect(refusal([](auto& j) { j["items"][0]["picks"][0]["pixel"] = {1}; }), "must be a list of 2 numbers");
  expect(refusal([](auto& j) { j["items"][0]["picks"][0]["pixel"] = {1, 1e300}; }), "beyond 1e12");
  expect(refusal([](auto& j) { j["items"].push_back(j["items"][0]); }), "items[1].id is there twice");
  expect(refusal([](auto& j) { j["items"][0]["id"] = 0; }), "items[0].id is 0, expected an id");
  expect(refusal([](auto& j) { j["panes"][0] = 4; }), "panes names snapshot 4");
  expect(refusal([](auto& j) { j["snapshots"][0]["image"] = "../../secret.png"; }), "expected a file name inside");
  expect(refusal([](auto& j) { j["snapshots"][0]["image"] = "none.png"; }), "none.png");
  expect(refusal([](auto& j) { j["snapshots"][0]["camera"]["image_width"] = 25; }), "24 x 16 px, its camera says 25 x 16");
  expect(refusal([](auto& j) { j["snapshots"][0]["pose"]["quaternion_xyzw"] = {0, 0, 0, 2}; }), "has length 2, expected 1");
  expect(refusal([](auto& j) { j["snapshots"][0]["sigma_px"] = 0; }), "sigma_px is 0, expected > 0");
  expect(refusal([](auto& j) { j["snapshots"][0]["joints"]["positions"] = {1}; }), "must be a list of 2 numbers");
  EXPECT_EQ(refusal([](auto&) {}), "taken");
}

TEST_F(SketchFile, SaysWhenThereIsNoFile) {
  const auto loaded = loadSketch(path());
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kNotFound);
}

TEST_F(SketchFile, SaysWhenTheFolderCannotBeMade) {
  fs::create_directories(folder);
  std::ofstream(folder / "file") << "x";
  const Status saved = saveSketch((folder / "file" / "below").string(), smallState());
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().message.find("cannot make the folder"), std::string::npos);
}

TEST_F(SketchFile, RefusesDeepNestingBeforeReadingIt) {
  fs::create_directories(folder);
  std::ofstream(json()) << std::string(100000, '[');
  const auto loaded = loadSketch(path());
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("nested deeper than 32"), std::string::npos);
}

TEST_F(SketchFile, SurvivesAThousandDamagedCopies) {
  ASSERT_TRUE(saveSketch(path(), smallState()));
  const std::string good = readTextFile(json()).value();
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    std::ofstream(json(), std::ios::binary) << tests::mutate(good, seed);
    const auto loaded = loadSketch(path());
    if (loaded) {
      Document document;
      document.reset(*loaded);   // What is taken can be measured without harm.
      continue;
    }
    ++refused;
    EXPECT_FALSE(loaded.error().message.empty());
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace longarm::session
