#pragma once

/// @file
/// The interface of sketch tools: explicit state machines that never write the document.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "session/commands/edit_command.h"
#include "session/document/dimension.h"
#include "session/document/document.h"
#include "vision/match/suggest.h"
#include "vision/sketch/pointer_event.h"

namespace longarm::session {

enum class ToolKind { kSelect, kPoint, kLine, kPipe, kPlane, kTriad, kMeasure };

/// One vertex of one item in one picture.
struct Handle {
  FeatureId item;
  int vertex = -1;
  SnapshotId snapshot;
  PaneSide side = PaneSide::kLeft;

  bool valid() const { return vertex >= 0; }
  friend bool operator==(const Handle& a, const Handle& b) {
    return a.item == b.item && a.vertex == b.vertex && a.snapshot == b.snapshot;
  }
};

/// What the host must do after an event.
struct ToolReply {
  bool consumed = false;                       ///< The tool used the event.
  bool redraw = false;                         ///< Preview, hint or active handle changed.
  bool finished = false;                       ///< Go back to the default tool.
  std::unique_ptr<EditCommand> command;        ///< At most one per gesture; null: none.
  std::optional<Selection> selection;          ///< Selection to set after the command.
};

/// Numbers of the vertex under the operator's hand, while it is dragged and after.
struct LiveMeasure {
  Handle handle;
  Eigen::Vector2d raw = Eigen::Vector2d::Zero();          ///< Where the pointer asks for it [raw px].
  Eigen::Vector2d constrained = Eigen::Vector2d::Zero();  ///< Where it is [raw px].
  bool on_curve = false;                                  ///< Held on the epipolar curve.
  bool released = false;                                  ///< Let go of it by Control.
  std::optional<Eigen::Vector3d> xyz;                     ///< In the views' parent frame [m]; empty: one view only.
  double plus_minus = 0;                                  ///< 95 % along the worst axis [m].
  double miss = 0;                                        ///< Distance of the viewing rays [m].
  std::optional<double> depth;                            ///< z in the other picture's camera [m].
  std::optional<double> length, length_plus_minus;        ///< Lines whose two ends are measured; +- 95 % [m].
  std::optional<double> radius, radius_plus_minus;        ///< Measured pipes; +- 95 % [m].
  std::optional<vision::Feature> feature;                 ///< All of it, when it is measured.
  std::string reason;                                     ///< Why there is no xyz, or no feature.
  bool refused = false;                                   ///< Everything is marked, and does not determine the feature.
  std::vector<std::string> warnings;

  /// One line for a status bar: "x 812.0  y -35.2  z 410.9 mm ± 3.1   miss 0.4 mm   length 402.1 ± 1.3 mm".
  std::string text() const;
};

/// A vertex that is placed in one pane and not for good in the other: where is it seen again?
struct MatchWish {
  FeatureId item;
  int vertex = 0;
  SnapshotId from, to;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();         ///< In `from` [raw px].

  friend bool operator==(const MatchWish& a, const MatchWish& b) {
    return a.item == b.item && a.vertex == b.vertex && a.from == b.from && a.to == b.to && a.pixel == b.pixel;
  }
};

/// What was found, best first; empty: nothing is seen again.
struct MatchHelp {
  MatchWish wish;
  std::vector<vision::Match> matches;

  /// Sure enough to be offered; never taken unasked.
  bool offered() const { return !matches.empty() && matches.front().score > vision::kOfferScore; }
};

/// A measured way through the scene, and what it measures.
struct SceneDimension {
  std::vector<Eigen::Vector3d> points;                    ///< In the views' parent frame [m]; one: only its first end is known.
  std::string text;                                       ///< Empty as long as nothing is measured.

  friend bool operator==(const SceneDimension& a, const SceneDimension& b) { return a.points == b.points && a.text == b.text; }
};

class MatchPictures;

/// Knows no Qt.  Reads the document that activate() gave it and never writes it: a gesture ends in one command.
class SketchTool {
 public:
  virtual ~SketchTool() = default;
  virtual ToolKind kind() const = 0;
  /// Starts afresh.  The document must outlive the tool's use.
  virtual void activate(const Document& document) = 0;
  /// Drops whatever was going on without a trace.
  virtual void deactivate() = 0;
  virtual ToolReply onPointer(const vision::PointerEvent& event) = 0;
  virtual ToolReply onKey(vision::SketchKey key, const vision::KeyModifiers& modifiers) = 0;
  /// Esc: one step back; never commits.
  virtual ToolReply cancel() = 0;
  /// The document changed under the tool (undo, deletion): handles that are gone are let go.
  virtual void documentChanged() = 0;

  /// Provisional items that stand for the document's of the same ids, or are not in it yet; valid until the next event.
  virtual std::vector<const SketchItem*> drafts() const = 0;
  /// Beyond sketch and drafts: epipolar curve, depth ticks, miss line.  Pure function of the state.
  virtual vision::Overlay preview(PaneSide side) const = 0;
  /// The handle that keys act on; invalid when there is none.
  virtual Handle activeHandle() const = 0;
  /// Takes over the handle of the tool before, so that keys go on with it.  Ignored when it is not there.
  virtual void setActiveHandle(const Handle& handle) = 0;
  /// Whether a drag is going on.
  virtual bool busy() const = 0;
  virtual std::optional<LiveMeasure> liveMeasure() const = 0;
  /// What it measures, for the scene; empty: nothing.
  virtual std::optional<SceneDimension> dimension() const { return std::nullopt; }
  /// A vertex picked in the scene.
  virtual ToolReply onVertex(const VertexRef& /*vertex*/) { return {}; }
  /// Status text for the state.
  virtual std::string hint() const = 0;
  /// For which vertices a match would help now; none while dragging.
  virtual std::vector<MatchWish> matchWishes() const { return {}; }
  /// The operator takes the best match of one of the wishes.
  virtual ToolReply acceptMatch(const MatchHelp& /*help*/) { return {}; }

  /// Pictures to snap in; borrowed, may be null.
  void usePictures(MatchPictures* pictures) { m_pictures = pictures; }

 protected:
  MatchPictures* pictures() const { return m_pictures; }

 private:
  MatchPictures* m_pictures = nullptr;
};

std::unique_ptr<SketchTool> makeTool(ToolKind kind);

}  // namespace longarm::session
