#pragma once

/// @file
/// The one mutable model of a session: pictures, panes, sketch, selection, plan, workcell.

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/ids.h"
#include "planning/motion/plan.h"
#include "planning/world/workcell.h"
#include "session/document/sketch_item.h"
#include "session/document/world_item.h"
#include "vision/sketch/pointer_event.h"
#include "vision/snapshot/view.h"

namespace longarm::session {

using vision::PaneSide;
using vision::SnapshotPtr;

inline PaneSide otherSide(PaneSide side) {
  return side == PaneSide::kLeft ? PaneSide::kRight : PaneSide::kLeft;
}

/// What happened to the document; never how to draw it.
enum class ChangeKind {
  kSnapshotAdded,    ///< id: SnapshotId
  kSnapshotRemoved,  ///< id: SnapshotId
  kPaneChanged,      ///< id: 0 left, 1 right
  kItemAdded,        ///< id: FeatureId
  kItemChanged,      ///< id: FeatureId; picks, name, visibility, lock or colour
  kItemRemoved,      ///< id: FeatureId
  kWorldChanged,     ///< id: WorldItemId
  kPinsChanged,      ///< id: SnapshotId
  kSelectionChanged,
  kPlanChanged,
  kWorkcellChanged,
  kReset             ///< Everything was replaced (a file was opened).
};
struct Change {
  ChangeKind kind = ChangeKind::kReset;
  std::uint64_t id = 0;
};

/// Which features are selected.
struct Selection {
  std::set<FeatureId> items;
  FeatureId primary;                       ///< The one that numbers and macros refer to; invalid when empty.

  bool contains(FeatureId id) const { return items.count(id) != 0; }
  static Selection of(FeatureId id) { return {{id}, id}; }
  friend bool operator==(const Selection& a, const Selection& b) {
    return a.items == b.items && a.primary == b.primary;
  }
};

/// What a sketch item measures now, or why it does not.
struct Measurement {
  std::optional<vision::Feature> feature;
  std::string reason;                      ///< A sentence when there is no feature.
  bool stale = false;                      ///< Its pictures were taken before the base was driven elsewhere.
};

/// The part of the document that undo and redo restore bit for bit.  Plain value.
struct DocumentState {
  std::vector<SnapshotPtr> snapshots;      ///< Library order; compared by identity, for they never change.
  std::array<SnapshotId, 2> panes;         ///< By PaneSide; invalid: empty pane.
  std::vector<SketchItem> items;           ///< List order.
  std::vector<WorldItem> world;            ///< Geometry added to the workcell's world; list order.
  std::set<SnapshotId> pinned;             ///< Pictures that must not be deleted.

  friend bool operator==(const DocumentState& a, const DocumentState& b);
  friend bool operator!=(const DocumentState& a, const DocumentState& b) { return !(a == b); }
};
std::uint64_t hashOf(const DocumentState& state);

/// The plan on the table and what it was made for.
struct PlanRecord {
  PlanId id;
  planning::Plan plan;
  std::string macro;                       ///< Name of the macro.
  FeatureId feature;                       ///< Invalid for canned motions.
};

/// GUI thread only (thread-compatible).  Readers hold a const reference.  The state is changed by EditCommands
/// alone; selection, plan and workcell are facts of the session that no undo touches.
class Document {
 public:
  Document();
  ~Document();
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  const DocumentState& state() const { return m_state; }

  const std::vector<SnapshotPtr>& snapshots() const { return m_state.snapshots; }
  SnapshotPtr snapshot(SnapshotId id) const;                 ///< Null if there is none.
  SnapshotId paneSnapshotId(PaneSide side) const { return m_state.panes[static_cast<int>(side)]; }
  SnapshotPtr paneSnapshot(PaneSide side) const { return snapshot(paneSnapshotId(side)); }

  const std::vector<SketchItem>& items() const { return m_state.items; }
  const SketchItem* item(FeatureId id) const;                ///< Null if there is none.
  int indexOf(FeatureId id) const;                           ///< -1 if there is none.
  /// @pre an item of this id exists
  const Measurement& measurement(FeatureId id) const;
  /// Measures any item value against this document's pictures (a drag's preview does).
  Measurement measure(const SketchItem& item) const;

  const Selection& selection() const { return m_selection; }
  /// The measured feature of the primary selection; null when nothing is selected or measured.
  const vision::Feature* selectedFeature() const;

  const std::optional<PlanRecord>& plan() const { return m_plan; }
  const std::shared_ptr<const planning::Workcell>& workcell() const { return m_workcell; }

  /// Where the base is now; empty: unknown, and nothing is stale.
  const std::optional<BaseState>& base() const { return m_base; }
  bool stale(SnapshotId id) const;
  bool stale(const WorldItem& item) const;
  /// Where the base was when the pictures that measure it were taken.  @pre an item of this id exists
  std::optional<BaseState> baseOf(FeatureId id) const;
  /// As measure(), from pictures taken near this place of the base alone.
  Measurement measureFrom(const SketchItem& item, const std::optional<BaseState>& place) const;

  const std::vector<WorldItem>& world() const { return m_state.world; }
  const WorldItem* worldItem(WorldItemId id) const;          ///< Null if there is none.
  bool pinned(SnapshotId id) const { return m_state.pinned.count(id) != 0; }

  /// Ids that the next additions should use; never given twice in one session.
  SnapshotId nextSnapshotId() const { return {m_next_snapshot}; }
  FeatureId nextFeatureId() const { return {m_next_feature}; }
  WorldItemId nextWorldId() const { return {m_next_world}; }
  std::uint64_t nextGroup() const;                           ///< A number that no group has.
  /// "Line 3": the first number that no item of this kind bears.
  std::string freeName(vision::FeatureKind kind, bool pipe = false) const;

  /// Calls back after each change, on the thread that made it.  @returns a handle for unobserve().
  int observe(std::function<void(const Change&)> observer);
  void unobserve(int handle);

  /// @name For commands only
  /// @{
  void insertSnapshot(std::size_t index, SnapshotPtr snapshot);
  void removeSnapshot(SnapshotId id);                        ///< Panes that show it go empty.
  void setPane(PaneSide side, SnapshotId id);
  void replaceSnapshot(SnapshotPtr snapshot);  ///< @pre one of its id exists
  void insertItem(std::size_t index, SketchItem item);
  void removeItem(FeatureId id);                             ///< Leaves the selection too.
  void replaceItem(const SketchItem& item);                  ///< @pre an item of its id exists
  void insertWorldItem(std::size_t index, WorldItem item);
  void removeWorldItem(WorldItemId id);
  void replaceWorldItem(const WorldItem& item);              ///< @pre an item of its id exists
  void setPinned(SnapshotId id, bool pinned);
  void reset(DocumentState state);                           ///< A file was opened.
  /// @}

  /// @name Facts that no undo touches
  /// @{
  void select(Selection selection);                          ///< Ids that do not exist are dropped.
  PlanId setPlan(PlanRecord record);                         ///< Gives the id.
  void clearPlan();
  /// Pictures and bodies from elsewhere (samePlace) become stale; what changes is measured and told anew.
  void setBase(const std::optional<BaseState>& base);
  void setWorkcell(std::shared_ptr<const planning::Workcell> workcell);
  /// @}

 private:
  void notify(ChangeKind kind, std::uint64_t id = 0);
  void remeasure(const SketchItem& item);
  Measurement measureAll(const SketchItem& item) const;
  Measurement measurePipe(const SketchItem& item) const;
  Measurement measureEdge(const SketchItem& item) const;
  std::vector<std::optional<BaseState>> placesOf(const SketchItem& item) const;
  void tellItemsOf(const std::set<SnapshotId>& pictures);
  bool elsewhere(const std::optional<BaseState>& place) const;

  DocumentState m_state;
  std::map<FeatureId, Measurement> m_measurements;
  Selection m_selection;
  std::optional<PlanRecord> m_plan;
  std::shared_ptr<const planning::Workcell> m_workcell;
  std::optional<BaseState> m_base;
  std::uint64_t m_next_snapshot = 1, m_next_feature = 1, m_next_world = 1, m_next_plan = 1;
  std::map<int, std::function<void(const Change&)>> m_observers;
  int m_next_observer = 1;
};

}  // namespace longarm::session
