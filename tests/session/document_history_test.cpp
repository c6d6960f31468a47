// Undo and redo: labels, limits, the clean mark, and the state restored bit for bit.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "session/commands/edit_history.h"
#include "session/commands/sketch_commands.h"
#include "session/commands/world_commands.h"
#include "session/tools/pick_editor.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

using tests::Bench;
using tests::trueLine;

TEST(EditHistory, UndoesAndRedoesWithLabels) {
  Bench bench;
  const DocumentState empty = bench.document.state();
  bench.history.push(addItem(trueLine(bench, 1)));
  const DocumentState with_line = bench.document.state();
  EXPECT_EQ(bench.history.undoLabel(), "Add line 'Line 1'");
  EXPECT_EQ(bench.history.redoLabel(), "");
  bench.history.undo();
  EXPECT_EQ(bench.document.state(), empty);
  EXPECT_EQ(bench.history.redoLabel(), "Add line 'Line 1'");
  bench.history.redo();
  EXPECT_EQ(bench.document.state(), with_line);
  EXPECT_FALSE(bench.history.canRedo());
}

TEST(EditHistory, DoesNothingAtItsEnds) {
  Bench bench;
  bench.history.undo();
  bench.history.redo();
  EXPECT_EQ(bench.history.position(), 0u);
}

TEST(EditHistory, ForgetsWhatWasUndoneWhenSomethingNewIsDone) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(renameItem(bench.document, {1}, "a"));
  bench.history.undo();
  bench.history.push(renameItem(bench.document, {1}, "b"));
  EXPECT_FALSE(bench.history.canRedo());
  EXPECT_EQ(bench.history.size(), 2u);
}

TEST(EditHistory, KeepsAtLeastAHundredStepsAndForgetsTheOldest) {
  Bench bench;
  EditHistory small(bench.document, 5);
  EXPECT_EQ(small.limit(), 100u);
  small.push(addItem(trueLine(bench, 1)));
  for (int i = 0; i < 150; ++i) small.push(renameItem(bench.document, {1}, "name " + std::to_string(i)));
  EXPECT_EQ(small.size(), 100u);
  while (small.canUndo()) small.undo();
  EXPECT_EQ(bench.document.item({1})->name, "name 49");
}

TEST(EditHistory, KnowsTheCleanState) {
  Bench bench;
  EXPECT_TRUE(bench.history.isClean());
  bench.history.push(addItem(trueLine(bench, 1)));
  EXPECT_FALSE(bench.history.isClean());
  bench.history.markClean();
  bench.history.push(renameItem(bench.document, {1}, "a"));
  EXPECT_FALSE(bench.history.isClean());
  bench.history.undo();
  EXPECT_TRUE(bench.history.isClean());
  bench.history.undo();
  EXPECT_FALSE(bench.history.isClean());
  bench.history.push(addItem(trueLine(bench, 2)));
  EXPECT_FALSE(bench.history.isClean()) << "the saved state can no longer be reached";
  bench.history.undo();
  EXPECT_FALSE(bench.history.isClean());
}

CommandPtr nudge(const Document& document, double by) {
  SketchItem item = *document.item({1});
  SketchPick pick = *item.pick({1}, 0);
  pick.pixel.x() += by;
  item.setPick({1}, 0, pick);
  return replaceItem(document, item, "Nudge", "nudge 1 0 1");
}

TEST(EditHistory, MakesOneStepOfNudgesInARow) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  const DocumentState before = bench.document.state();
  for (int i = 0; i < 20; ++i) bench.history.push(nudge(bench.document, 0.1));
  EXPECT_EQ(bench.history.size(), 2u);
  const DocumentState after = bench.document.state();
  bench.history.undo();
  EXPECT_EQ(bench.document.state(), before);
  bench.history.redo();
  EXPECT_EQ(bench.document.state(), after);
}

TEST(EditHistory, KeepsNudgesApartWhenSealedOrClean) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(nudge(bench.document, 0.1));
  bench.history.seal();
  bench.history.push(nudge(bench.document, 0.1));
  EXPECT_EQ(bench.history.size(), 3u);
  bench.history.markClean();
  bench.history.push(nudge(bench.document, 0.1));
  EXPECT_EQ(bench.history.size(), 4u);
  bench.history.undo();
  EXPECT_TRUE(bench.history.isClean());
  bench.history.push(nudge(bench.document, 0.1));
  EXPECT_EQ(bench.history.size(), 4u);
}

TEST(SketchCommands, AnswerNullWhenNothingWouldChange) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  EXPECT_EQ(renameItem(bench.document, {1}, "Line 1"), nullptr);
  EXPECT_EQ(renameItem(bench.document, {1}, ""), nullptr);
  EXPECT_EQ(hideItem(bench.document, {1}, false), nullptr);
  EXPECT_EQ(lockItem(bench.document, {9}, true), nullptr);
  EXPECT_EQ(removeItems(bench.document, {{9}}), nullptr);
  EXPECT_EQ(duplicateItem(bench.document, {9}), nullptr);
  EXPECT_EQ(moveItem(bench.document, {1}, 5), nullptr);
  EXPECT_EQ(removeSnapshot(bench.document, {9}), nullptr);
  EXPECT_EQ(showSnapshot(bench.document, PaneSide::kLeft, {1}), nullptr);
  EXPECT_EQ(addSnapshots(bench.document, {}), nullptr);
  EXPECT_EQ(composite("nothing", {}), nullptr);
}

TEST(SketchCommands, TakeThePicksOfAPictureWithItAndBringThemBack) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  const DocumentState before = bench.document.state();
  bench.history.push(removeSnapshot(bench.document, {2}));
  EXPECT_EQ(bench.document.item({1})->picks.count({2}), 0u);
  EXPECT_FALSE(bench.document.paneSnapshotId(PaneSide::kRight).valid());
  EXPECT_FALSE(bench.document.measurement({1}).feature);
  bench.history.undo();
  EXPECT_EQ(bench.document.state(), before);
  EXPECT_TRUE(bench.document.measurement({1}).feature);
}

TEST(SketchCommands, SwapThePanesWhenTheOtherOneHasThePicture) {
  Bench bench;
  bench.history.push(showSnapshot(bench.document, PaneSide::kLeft, {2}));
  EXPECT_EQ(bench.document.paneSnapshotId(PaneSide::kLeft), SnapshotId{2});
  EXPECT_EQ(bench.document.paneSnapshotId(PaneSide::kRight), SnapshotId{1});
}

TEST(SketchCommands, ShowASinglePictureWhereItWasAskedFor) {
  Bench bench;
  bench.history.push(addSnapshots(bench.document, {tests::snapshotOf(3, bench.scene.left)}, PaneSide::kRight));
  EXPECT_EQ(bench.document.paneSnapshotId(PaneSide::kLeft), SnapshotId{1});
  EXPECT_EQ(bench.document.paneSnapshotId(PaneSide::kRight), SnapshotId{3});
  bench.history.undo();
  EXPECT_EQ(bench.document.paneSnapshotId(PaneSide::kRight), SnapshotId{2});
}

TEST(SketchCommands, CopyToOtherPicturesWhereItIsSeenButNotMeasuredBeforeItIsPlaced) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  EXPECT_FALSE(copyItemTo(bench.document, {1}, {{1}, {2}}).ok()) << "marked there already";
  EXPECT_FALSE(copyItemTo(bench.document, {1}, {{77}}).ok());
  EXPECT_FALSE(copyItemTo(bench.document, {9}, {{1}}).ok());
  bench.history.push(addSnapshots(bench.document, {tests::snapshotOf(3, bench.scene.left), tests::snapshotOf(4, bench.scene.right)}, PaneSide::kLeft));
  auto copy = copyItemTo(bench.document, {1}, {{3}, {4}});
  ASSERT_TRUE(copy.ok()) << copy.error().message;
  bench.history.push(std::move(*copy));
  ASSERT_EQ(bench.document.items().size(), 2U);
  const SketchItem made = bench.document.items()[1];
  for (int vertex = 0; vertex < 2; ++vertex) {
    EXPECT_EQ(made.pick({1}, vertex), nullptr);
    for (const auto& [from, to] : {std::pair<std::uint64_t, std::uint64_t>{1, 3}, {2, 4}}) {
      ASSERT_NE(made.pick({to}, vertex), nullptr);
      EXPECT_EQ(made.pick({to}, vertex)->state, PickState::kUnplaced);
      EXPECT_LT((made.pick({to}, vertex)->pixel - bench.document.item({1})->pick({from}, vertex)->pixel).norm(), 0.01);
    }
  }
  EXPECT_FALSE(bench.document.measurement(made.id).feature.has_value()) << "nobody has looked yet";
  EXPECT_FALSE(copyItemTo(bench.document, made.id, {{1}, {2}}).ok()) << "not measured";
  bench.history.undo();
  EXPECT_EQ(bench.document.items().size(), 1U);
}

TEST(SketchCommands, ALineWhoseEndsDifferIsMeasuredByWhatItRunsAlong) {
  Bench bench;
  SketchItem line = trueLine(bench, 1);
  const Eigen::Vector3d a = bench.scene.a, b = a + 0.15 * bench.scene.left.X_WC.linear().col(1);   // across the baseline
  for (int vertex = 0; vertex < 2; ++vertex) line.setPick({1}, vertex, {bench.scene.pixel(PaneSide::kLeft, vertex == 0 ? a : b), PickState::kFree});
  // Other places of the same edge in the right picture.
  line.setPick({2}, 0, {bench.scene.pixel(PaneSide::kRight, a + 0.3 * (b - a)), PickState::kReleased});
  line.setPick({2}, 1, {bench.scene.pixel(PaneSide::kRight, a + 0.8 * (b - a)), PickState::kReleased});
  bench.history.push(addItem(line));
  bench.history.push(edgeItem(bench.document, {1}, true));
  const auto& feature = bench.document.measurement({1}).feature;
  ASSERT_TRUE(feature.has_value()) << bench.document.measurement({1}).reason;
  EXPECT_LT((feature->vertices[0].xyz - a).norm(), 1e-6) << "the ends are those of the first picture";
  EXPECT_LT((feature->vertices[1].xyz - b).norm(), 1e-6);
  EXPECT_FALSE(constrainingSnapshot(bench.document, *bench.document.item({1}), {2}, 0).valid()) << "no curve holds its picks";
  bench.history.undo();
  const auto& matched = bench.document.measurement({1}).feature;
  EXPECT_TRUE(!matched || (matched->vertices[0].xyz - a).norm() > 0.01) << "the ends do not correspond";
  EXPECT_EQ(edgeItem(bench.document, {9}, true), nullptr);
  // Along the baseline the planes coincide.
  SketchItem flat = trueLine(bench, 2, "Line 2");
  for (int vertex = 0; vertex < 2; ++vertex) {
    const Eigen::Vector3d p = a + vertex * 0.2 * (bench.scene.right.X_WC.translation() - bench.scene.left.X_WC.translation()).normalized();
    flat.setPick({1}, vertex, {bench.scene.pixel(PaneSide::kLeft, p), PickState::kFree});
    flat.setPick({2}, vertex, {bench.scene.pixel(PaneSide::kRight, p), PickState::kReleased});
  }
  flat.edge = true;
  bench.history.push(addItem(flat));
  EXPECT_FALSE(bench.document.measurement({2}).feature.has_value());
  EXPECT_NE(bench.document.measurement({2}).reason.find("baseline"), std::string::npos) << bench.document.measurement({2}).reason;
}

TEST(SketchCommands, DuplicateWithAnIdAndNameOfItsOwn) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(duplicateItem(bench.document, {1}));
  ASSERT_EQ(bench.document.items().size(), 2u);
  EXPECT_EQ(bench.document.items()[1].name, "Line 2");
  EXPECT_NE(bench.document.items()[1].id, FeatureId{1});
  EXPECT_EQ(bench.document.items()[1].picks, bench.document.items()[0].picks);
}

TEST(SketchCommands, OpenASketchAndBringBackWhatWasThere) {
  Bench bench;
  const DocumentState before = bench.document.state();
  DocumentState other;
  other.snapshots = before.snapshots;
  bench.history.push(openState(bench.document, other, "cellar"));
  EXPECT_EQ(bench.document.state(), other);
  EXPECT_EQ(bench.history.undoLabel(), "Open cellar");
  bench.history.undo();
  EXPECT_EQ(bench.document.state(), before);
}

/// One random edit of any kind; null when the dice ask for something that is not there.
class RandomEditor {
 public:
  RandomEditor(Bench& bench, unsigned seed) : m_bench(bench), m_random(seed) {}
  CommandPtr next() {
    const Document& document = m_bench.document;
    if (document.items().size() > 12) return removeItems(document, {anyItem(), anyItem(), anyItem()});
    switch (below(18)) {
      case 0:
      case 1: return addItem(randomItem());
      case 2: return removeItems(document, {anyItem(), anyItem()});
      case 3:
      case 4:
      case 5: return movePick("");
      case 6: return movePick("nudge");
      case 7: return renameItem(document, anyItem(), "name " + std::to_string(below(50)));
      case 17: return edgeItem(document, anyItem(), below(2) == 0);
      case 8: return below(2) == 0 ? hideItem(document, anyItem(), below(2) == 0) : lockItem(document, anyItem(), below(2) == 0);
      case 9: return colourItem(document, anyItem(), static_cast<std::uint32_t>(below(1 << 24)));
      case 10: return below(2) == 0 ? duplicateItem(document, anyItem()) : moveItem(document, anyItem(), below(8));
      case 11: return snapshotEdit();
      case 12: return below(20) == 0 ? openState(document, otherSketch(), "other") : nullptr;
      case 16: return groupItems(document, {anyItem(), anyItem(), anyItem()}, below(3) != 0);
      case 13: return noteItem(document, anyItem(), below(3) == 0 ? "" : "note " + std::to_string(below(9)));
      case 14:
      case 15: return worldEdit();
      default: return both();
    }
  }
  std::size_t below(std::size_t n) { return m_random() % n; }

 private:
  double pixel() { return std::uniform_real_distribution<double>(0, 640)(m_random); }
  FeatureId anyItem() {
    const auto& items = m_bench.document.items();
    return items.empty() ? FeatureId{} : items[below(items.size())].id;
  }
  SketchItem randomItem() {
    SketchItem item;
    item.id = m_bench.document.nextFeatureId();
    item.kind = below(2) == 0 ? vision::FeatureKind::kPoint : vision::FeatureKind::kLine;
    item.name = m_bench.document.freeName(item.kind);
    for (const auto& snapshot : m_bench.document.snapshots()) {
      for (int vertex = 0; vertex < vision::vertexCount(item.kind); ++vertex) {
        if (below(5) != 0) item.setPick(snapshot->id, vertex, {{pixel(), pixel() * 0.75}, static_cast<PickState>(below(5)), below(2) == 0 ? 0 : pixel() / 640});
      }
    }
    return item;
  }
  // What a file would bring: one item of ours less, in another order.
  DocumentState otherSketch() {
    DocumentState state = m_bench.document.state();
    if (!state.items.empty()) state.items.pop_back();
    std::reverse(state.items.begin(), state.items.end());
    return state;
  }
  WorldItemId anyBody() {
    const auto& world = m_bench.document.world();
    return world.empty() ? WorldItemId{} : world[below(world.size())].id;
  }
  WorldItem randomBody() {
    WorldItem body;
    body.id = m_bench.document.nextWorldId();
    body.kind = below(4) == 0 ? WorldKind::kPoints : WorldKind::kBox;
    body.name = "body " + std::to_string(below(20));
    body.X_WO.translation() = Eigen::Vector3d(pixel(), pixel(), pixel()) / 640;
    if (body.kind == WorldKind::kPoints) body.points.assign(1 + below(4), body.X_WO.translation());
    body.source = anyItem();
    return body;
  }
  CommandPtr worldEdit() {
    const Document& document = m_bench.document;
    if (document.world().size() > 6) return removeWorldItems(document, {anyBody(), anyBody()});
    const WorldItem* body = document.worldItem(anyBody());
    if (below(4) == 0 && !document.snapshots().empty()) {
      return pinSnapshot(document, document.snapshots()[below(document.snapshots().size())]->id, below(2) == 0);
    }
    if (body == nullptr || below(2) == 0) return addWorldItem(randomBody());
    WorldItem after = *body;
    after.size(static_cast<int>(below(3))) = pixel() / 640;
    after.margin_m = pixel() / 6400;
    after.hidden = below(2) == 0;
    after.role = static_cast<WorldRole>(below(4));
    return replaceWorldItem(document, after);
  }
  CommandPtr both() {
    std::vector<CommandPtr> commands;
    commands.push_back(renameItem(m_bench.document, anyItem(), "x" + std::to_string(below(9))));
    commands.push_back(addItem(randomItem()));
    return composite("both", std::move(commands));
  }
  CommandPtr movePick(const std::string& merge_key) {
    const SketchItem* item = m_bench.document.item(anyItem());
    if (item == nullptr || item->picks.empty()) return nullptr;
    SketchItem after = *item;
    const SnapshotId id = std::next(after.picks.begin(), static_cast<long>(below(after.picks.size())))->first;
    after.setPick(id, static_cast<int>(below(static_cast<std::size_t>(vision::vertexCount(after.kind)))),
                  {{pixel(), pixel()}, static_cast<PickState>(below(5))});
    return replaceItem(m_bench.document, after, "Move", merge_key);
  }
  CommandPtr snapshotEdit() {
    const Document& document = m_bench.document;
    const auto& all = document.snapshots();
    const std::uint64_t id = document.nextSnapshotId().value;
    if (all.size() < 3) {
      return addSnapshots(document, {tests::snapshotOf(id, m_bench.scene.left), tests::snapshotOf(id + 1, m_bench.scene.right)});
    }
    const SnapshotId one = all[below(all.size())]->id;
    if (below(3) == 0) return removeSnapshot(document, one);
    return showSnapshot(document, below(2) == 0 ? PaneSide::kLeft : PaneSide::kRight, one);
  }
  Bench& m_bench;
  std::mt19937_64 m_random;
};

// The state is compared, by value and by hash, after every single step of undo and of redo.
void restoresEveryState(unsigned seed, int edits) {
  Bench bench;
  RandomEditor editor(bench, seed);
  std::vector<DocumentState> states{bench.document.state()};   // By history position.
  int done = 0;
  while (done < edits) {
    const std::size_t burst = 1 + editor.below(60);
    for (std::size_t i = 0; i < burst && done < edits; ++i) {
      CommandPtr command = editor.next();
      if (!command) continue;
      const std::size_t before = bench.history.size();
      bench.history.push(std::move(command));
      ++done;
      const std::size_t position = bench.history.position();
      if (before == bench.history.limit() && position == before) states.erase(states.begin());
      states.resize(position);
      states.push_back(bench.document.state());
    }
    for (std::size_t back = editor.below(bench.history.position() + 1); back > 0; --back) {
      bench.history.undo();
      const DocumentState& expected = states[bench.history.position()];
      ASSERT_EQ(bench.document.state(), expected) << "undo, seed " << seed << ", edit " << done;
      ASSERT_EQ(hashOf(bench.document.state()), hashOf(expected));
    }
    for (std::size_t on = editor.below(bench.history.size() - bench.history.position() + 1); on > 0; --on) {
      bench.history.redo();
      ASSERT_EQ(bench.document.state(), states[bench.history.position()]) << "redo, seed " << seed << ", edit " << done;
    }
  }
  while (bench.history.canUndo()) bench.history.undo();
  EXPECT_EQ(bench.document.state(), states[0]);
}

TEST(EditHistory, RestoresEveryStateBitForBitThroughTenThousandRandomEdits) { restoresEveryState(20260722, 10000); }

TEST(EditHistoryCampaign, RestoresEveryStateBitForBitForManySeeds) {
  for (unsigned seed = 1; seed <= 10; ++seed) restoresEveryState(seed, 10000);
}

}  // namespace
}  // namespace longarm::session
