#pragma once

/// @file
/// views.yaml and picks.csv: measurements described in files, as the headless verbs take them.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "core/result.h"
#include "vision/sketch/feature.h"
#include "vision/snapshot/view.h"
#include "vision/stereo/triangulate.h"

namespace longarm::vision {

/// One entry of views.yaml.
struct ViewEntry {
  View view;
  std::string image;                 ///< Path as usable from here, or empty.
  std::string camera_file;           ///< Path as usable from here.
  std::optional<double> zoom;
};

/// Views that share one parent frame.
struct ViewSet {
  std::vector<ViewEntry> entries;
  /// The view of this name, or null.
  const View* find(const std::string& name) const;
};

/// Reads views.yaml with the camera files it names (relative to it).  A view without `pose` takes the one of
/// its camera file; `pose_covariance` (36 numbers, row-major) may stand beside `pose`.
/// @returns kInvalidInput or kNotFound naming file, view, key and value.  Pictures are not opened.
Result<ViewSet> readViewsFile(const std::string& path);

/// How the picks of a line are to be read.
enum class PickRule {
  kMatched,     ///< kind "point", "line", "plane", "triad": the same vertex in every view.
  kEdge,        ///< kind "edge": vertices 0, 1 anywhere along a line, its ends unmatched between views.
  kPipe         ///< kind "pipe": vertices 0, 1 on one outline of a round pipe, 2, 3 on the other.
};

/// One row of picks.csv.
struct Pick {
  std::string feature;
  FeatureKind kind = FeatureKind::kPoint;            ///< Edges and pipes measure lines.
  PickRule rule = PickRule::kMatched;
  int vertex = 0;
  std::string view;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  int line = 0;                      ///< In the file, from 1.
};

/// Reads picks.csv (header `feature,kind,vertex,view,u,v`; LF or CRLF).
/// @returns kInvalidInput naming file, line, column and value.
Result<std::vector<Pick>> readPicksFile(const std::string& path);
Result<std::vector<Pick>> parsePicks(std::string_view text, const std::string& file_name);

/// What came of one feature of the picks.
struct MeasuredFeature {
  std::string name;
  FeatureKind kind = FeatureKind::kPoint;
  Result<Feature> outcome;
};

/// Measures every feature, in the order of their first picks.  A feature that cannot be measured keeps its
/// reason; picks that contradict each other or the views are an error of the whole.
/// @returns kInvalidInput naming line and value: unknown view, vertex the kind does not have, one feature of
///   two kinds (a line may have matched ends in some views and be an edge in others), the same vertex twice in one view.
///   Pure function.
Result<std::vector<MeasuredFeature>> measureAll(const ViewSet& views, const std::vector<Pick>& picks,
                                                const TriangulationOptions& options = {});

/// What the verb `target` prints: {"features": [...]}; refused ones carry "status" and "reason".  When none
/// succeeded the object itself carries them too.
nlohmann::json targetJson(const std::vector<MeasuredFeature>& features);

}  // namespace longarm::vision
