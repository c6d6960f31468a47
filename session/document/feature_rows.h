#pragma once

/// @file
/// The list of features as a table shows it: values and ready text.

#include <optional>
#include <string>
#include <vector>

#include "session/document/document.h"

namespace longarm::session {

/// One line of the list.  Lengths in metres; `..._text` in millimetres with "." as decimal point.
struct FeatureRow {
  FeatureId id;
  std::string name;
  vision::FeatureKind kind = vision::FeatureKind::kPoint;
  bool hidden = false, locked = false, selected = false, primary = false;
  std::optional<std::uint32_t> colour;
  bool measured = false;
  bool stale = false;                          ///< Measured from where the base no longer is.
  std::string reason;                          ///< Why it is not measured: what to do.
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();   ///< Point, or middle of a line, plane or box [m].
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero(); ///< 1 sigma per axis [m].
  double plus_minus = 0;                       ///< 95 % along the worst axis of a vertex [m].
  std::optional<double> length, length_plus_minus;   ///< Lines only; +- is 95 % [m].
  std::optional<Eigen::Vector3d> size, size_plus_minus;   ///< Boxes only; +- is 95 % [m].
  std::optional<double> radius, radius_plus_minus;   ///< Pipes only; +- is 95 % [m].
  bool pipe = false;                           ///< Marked by a pipe's outlines.
  std::uint64_t group = 0;
  std::string note;
  double miss = 0;                             ///< Largest of its vertices [m].
  std::vector<std::string> warnings;
  std::string xyz_text, plus_minus_text, length_text, miss_text;   ///< A box's length is its size.
  std::string size_text;                       ///< A box's edges, each with its +-.
};

FeatureRow featureRow(const SketchItem& item, const Measurement& measurement);
std::vector<FeatureRow> featureRows(const Document& document);

/// "402.1 mm" and "402.1 ± 1.3 mm": metres to millimetres; +- is 95 %.
std::string millimetreText(double metres, int decimals = 1);
std::string millimetreText(double metres, double plus_minus_metres);
/// Half-width of the 95 % interval of a scalar with this standard deviation.
double plusMinus95(double sigma);

}  // namespace longarm::session
