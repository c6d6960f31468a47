#pragma once

/// @file
/// Distances and angles between vertices of features, with what their errors share.

#include <string>

#include "core/result.h"
#include "session/document/document.h"

namespace longarm::session {

/// One vertex of one item, wherever it is seen.
struct VertexRef {
  FeatureId item;
  int vertex = 0;

  friend bool operator==(const VertexRef& a, const VertexRef& b) { return a.item == b.item && a.vertex == b.vertex; }
};

struct Dimension {
  bool is_angle = false;
  double value = 0, sigma = 0;             ///< [m] or [rad]

  /// "402.1 ± 1.3 mm" or "89.7 ± 0.4°"; +- is 95 %.
  std::string text() const;
};

/// Errors of the calibration that both vertices share are counted once.  Vertices are measured freely, without what their
/// features know of right angles.  Pure functions.
/// @returns kInvalidInput (no such vertex, an outline of a pipe, vertices in different frames), or as triangulate().
Result<Dimension> distanceBetween(const Document& document, const VertexRef& a, const VertexRef& b);
/// Where a vertex is, in its pictures' parent frame [m].  @returns as distanceBetween.
Result<Eigen::Vector3d> positionOf(const Document& document, const VertexRef& vertex);
/// The angle at `corner` between the ways to a and b.  @returns also kDegenerate when one of them is nowhere to go.
Result<Dimension> angleAt(const Document& document, const VertexRef& a, const VertexRef& corner, const VertexRef& b);

}  // namespace longarm::session
