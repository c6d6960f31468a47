#pragma once

/// @file
/// One sketched primitive: its picks in each picture, as the operator left them.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/ids.h"
#include "vision/sketch/feature.h"

namespace longarm::session {

/// How a pick came to be where it is.
enum class PickState {
  kUnplaced,     ///< A copy that nobody has dragged yet: drawn dashed, never measured.
  kFree,         ///< Placed freely: the first picture of its vertex.
  kConstrained,  ///< Slid along the epipolar curve of another pick; follows when that one moves.
  kReleased,     ///< Placed off the curve on purpose (Control held); stays when the other moves.
  kMatched       ///< Taken from a suggested match; slides along the new curve when the other moves, as kConstrained.
};

/// One vertex in one picture.
struct SketchPick {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< Raw pixel, (0, 0) = centre of the top-left one [px].
  PickState state = PickState::kUnplaced;
  double sigma_px = 0;                              ///< Its own noise, 1 sigma [px]; 0: what the view says.

  bool placed() const { return state != PickState::kUnplaced; }
  friend bool operator==(const SketchPick& a, const SketchPick& b);
  friend bool operator!=(const SketchPick& a, const SketchPick& b) { return !(a == b); }
};

/// A pick per vertex of one picture; empty where the vertex has none.
using VertexPicks = std::vector<std::optional<SketchPick>>;

/// A point or line the operator sketched.  Plain value; equality is bit for bit.
struct SketchItem {
  FeatureId id;
  vision::FeatureKind kind = vision::FeatureKind::kPoint;
  std::string name;
  std::optional<std::uint32_t> colour;         ///< 0xRRGGBB; empty: the theme's.
  bool hidden = false;
  bool locked = false;                         ///< Can be selected, not moved.
  bool pipe = false;                           ///< A line that is measured by a pipe's outlines: vertices 0, 1 on one, 2, 3 on the other.
  bool edge = false;                           ///< A line whose ends are others in every picture: only what it runs along counts.
  std::uint64_t group = 0;                     ///< Items of one number are selected and moved together; 0: none.
  std::string note;                            ///< The operator's own words, shown below the name.
  std::map<SnapshotId, VertexPicks> picks;     ///< Each of size vertices().

  /// How many picks a picture has of it.
  int vertices() const { return pipe ? 4 : vision::vertexCount(kind); }

  /// Null when this vertex has no pick in this picture.
  const SketchPick* pick(SnapshotId snapshot, int vertex) const;
  /// Makes room for the picture where needed.  @pre 0 <= vertex < vertices()
  void setPick(SnapshotId snapshot, int vertex, const SketchPick& pick);
  /// Whether every vertex is placed in this picture.
  bool placedIn(SnapshotId snapshot) const;
  /// In how many pictures this vertex is placed.
  int placedCount(int vertex) const;
  /// Whether everything is placed in two pictures or more: what is not measured then will not be by marking more of it.
  bool markedTwice() const;

  friend bool operator==(const SketchItem& a, const SketchItem& b);
  friend bool operator!=(const SketchItem& a, const SketchItem& b) { return !(a == b); }
};

/// Pairs of vertices that an edge is drawn between.
std::vector<std::pair<int, int>> edgesOf(const SketchItem& item);
/// "point", "line", "pipe", ...
const char* wordFor(const SketchItem& item);

/// Bits of the value mixed to one number; equal items give equal hashes.
std::uint64_t hashOf(const SketchItem& item);

}  // namespace longarm::session
