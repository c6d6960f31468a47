#pragma once

/// @file
/// TargetingController: sketching, as the panes, the feature list and the menus see it.

#include <optional>
#include <vector>

#include <QObject>
#include <QString>

#include "session/commands/edit_history.h"
#include "session/document/feature_rows.h"
#include "session/document/overlay_builder.h"
#include "session/tools/tool_host.h"

namespace longarm::session {

/// Owns the tool host; turns the document's changes into signals.  GUI thread only.
class TargetingController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; both outlive this.  Takes the history's onChanged callback.
  TargetingController(Document& document, EditHistory& history, QObject* parent = nullptr);
  ~TargetingController() override;

  const Document& document() const { return m_document; }

  void setTool(ToolKind kind);
  ToolKind tool() const { return m_tools.tool(); }
  /// Empty when the tool can be used now; else why not and what to do.
  QString whyNotTool(ToolKind kind) const;
  /// @returns whether the sketch used the event.
  bool pointer(const vision::PointerEvent& event) { return m_tools.pointer(event); }
  bool key(vision::SketchKey key, const vision::KeyModifiers& modifiers = {}) { return m_tools.key(key, modifiers); }

  vision::Overlay overlay(PaneSide side) const;
  /// A third picture beside the panes; invalid: none.  No edit: nothing of it is kept.
  SnapshotId third() const { return m_third; }
  void setThird(SnapshotId id);
  /// Its sketch, with the curves of the vertex that is worked on and a flag at picks that are off.
  vision::Overlay thirdOverlay() const;
  /// Marks the vertex that belongs there in the third picture.  @returns why it cannot.
  Status pickInThird(const Eigen::Vector2d& pixel);
  /// Features and path in a live picture.
  vision::Overlay overlay(const vision::View& view) const;
  QString hint() const { return QString::fromStdString(m_tools.hint()); }
  std::optional<LiveMeasure> liveMeasure() const { return m_tools.liveMeasure(); }
  Handle activeHandle() const { return m_tools.activeHandle(); }
  /// What the measure tool measured, for the scene.
  std::optional<SceneDimension> dimension() const { return m_tools.dimension(); }
  /// A vertex of a measured feature was picked in the scene: the measure tool takes it.  @returns whether it did.
  bool takeVertex(const VertexRef& vertex) { return m_tools.takeVertex(vertex); }
  OwnLinksCache& ownLinks() const { return m_tools.ownLinks(); }
  /// Whether the robot's own links are tinted in snapshots.
  void setOwnLinksShown(bool shown) { m_tools.setOwnLinksShown(shown); }

  std::vector<MatchWish> matchWishes() const { return m_tools.matchWishes(); }
  std::vector<MatchHelp> matchHelp() const { return m_tools.matchHelp(); }
  void setMatchHelp(std::vector<MatchHelp> help) { m_tools.setMatchHelp(std::move(help)); }
  const std::shared_ptr<MatchPictures>& pictures() const { return m_tools.pictures(); }

  std::vector<FeatureRow> rows() const { return featureRows(m_document); }
  void select(FeatureId id);                       ///< Invalid: nothing.
  void select(const Selection& selection);
  void rename(FeatureId id, const QString& name);
  /// A copy in the pictures that the panes show, to be dragged into place.  @returns as copyItemTo.
  Status copyToPictures(FeatureId id);
  void setHidden(FeatureId id, bool hidden);
  void setLocked(FeatureId id, bool locked);
  void setEdge(FeatureId id, bool edge);           ///< See edgeItem.
  void setColour(FeatureId id, std::optional<std::uint32_t> rgb);
  void setNote(FeatureId id, const QString& note);
  void groupSelected(bool together);
  /// By numbers [m], [raw px].  @returns why not: locked, gone, or not to be seen there.
  Status moveVertex(FeatureId id, int vertex, const Eigen::Vector3d& xyz);
  Status movePick(FeatureId id, SnapshotId snapshot, int vertex, const Eigen::Vector2d& pixel);
  /// What lies under a pixel of a pane's snapshot; invalid: nothing.
  FeatureId itemAt(PaneSide side, const Eigen::Vector2d& pixel, double radius_px) const;
  void duplicate(FeatureId id);
  void remove(FeatureId id);
  void removeSelected();
  void showSnapshot(PaneSide side, SnapshotId id);
  void removeSnapshot(SnapshotId id);
  void setPinned(SnapshotId id, bool pinned);

  bool canUndo() const { return !m_tools.busy() && m_history.canUndo(); }
  bool canRedo() const { return !m_tools.busy() && m_history.canRedo(); }
  QString undoLabel() const { return QString::fromStdString(m_history.undoLabel()); }
  QString redoLabel() const { return QString::fromStdString(m_history.redoLabel()); }
  bool isClean() const { return m_history.isClean(); }
  void undo();
  void redo();

 Q_SIGNALS:
  void overlayChanged();                           ///< Paint both panes again.
  void hintChanged(const QString& hint);
  void toolChanged(longarm::session::ToolKind kind);
  void featuresChanged();                          ///< rows() differ: items, numbers or selection.
  void selectionChanged();
  void panesChanged();                             ///< Which picture is in which pane.
  void snapshotsChanged();                         ///< The library and its pins.
  void worldChanged();                             ///< Bodies added to the world.
  void thirdChanged();                             ///< Which picture is the third.
  void planChanged();
  void historyChanged();                           ///< canUndo, canRedo, labels, isClean.
  void liveMeasureChanged();                       ///< While dragging, at each move.

 private:
  void changed(const Change& change);
  void push(std::unique_ptr<EditCommand> command);

  Document& m_document;
  EditHistory& m_history;
  ToolHost m_tools;
  int m_observer = 0;
  std::vector<Eigen::Vector3d> m_path;
  SnapshotId m_third;
};

}  // namespace longarm::session
