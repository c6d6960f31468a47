#pragma once

/// @file
/// Geometry that the operator added to the world out of a sketch.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base_motion.h"
#include "core/ids.h"
#include "core/pose.h"
#include "core/result.h"
#include "planning/templates/object_template.h"
#include "planning/world/shape.h"
#include "vision/sketch/feature.h"
#include "vision/sketch/pointer_event.h"
#include "vision/snapshot/view.h"

namespace longarm {
using WorldItemId = Id<struct WorldItemTag>;
}

namespace longarm::session {

enum class WorldKind { kBox, kSlab, kPipe, kPoints, kTemplate };
const char* toString(WorldKind kind);                        ///< "box", "slab", "pipe", "points", "template"
std::optional<WorldKind> worldKindFrom(const std::string& word);

/// What it is to the robot's motions.
enum class WorldRole {
  kObstacle,                                                 ///< Kept clear of; the gripper may take or touch it.
  kDrawn,                                                    ///< Drawn, but planned through.
  kKeepOut,                                                  ///< Never entered by anything of the arm.
  kWorkspace,                                                ///< Never left; boxes only.
};
const char* toString(WorldRole role);                        ///< "obstacle", "drawn", "keep_out", "workspace"
std::optional<WorldRole> worldRoleFrom(const std::string& word);

/// A body, a cloud of small ones, or the bodies of a template.  It stays as it is when the sketch it came from changes or goes.  Plain value;
/// equality is bit for bit.
struct WorldItem {
  WorldItemId id;
  WorldKind kind = WorldKind::kBox;
  std::string name;
  std::string parent;                                        ///< Frame of X_WO and points, as the feature's.
  Pose X_WO = Pose::Identity();                              ///< Middle of the body, or frame of the template; not used by points.
  /// Full extents [m]: of a box or slab (z: its thickness); of a pipe diameter, diameter, length; of points three times
  /// the diameter of their spheres; not used by templates.
  Eigen::Vector3d size{0.1, 0.1, 0.1};
  std::vector<Eigen::Vector3d> points;                       ///< Points only [m].
  double margin_m = 0;                                       ///< Planning keeps this much more away, for what is not known.
  bool hidden = false;
  WorldRole role = WorldRole::kObstacle;
  std::string template_name;                                 ///< Templates only, like what follows.
  std::map<std::string, double> parameters;
  std::vector<planning::TemplatePart> parts;                 ///< Its bodies at these parameters: they stand without the file.
  FeatureId source;                                          ///< It came from; may be gone.
  std::optional<BaseState> base;  ///< Where the robot's base stood then; empty: unknown.

  friend bool operator==(const WorldItem& a, const WorldItem& b);
  friend bool operator!=(const WorldItem& a, const WorldItem& b) { return !(a == b); }
};
std::uint64_t hashOf(const WorldItem& item);

/// Thickness given to a plane and diameter given to points: what a hand can knock against [m].
constexpr double kSlabThickness_m = 0.01, kPointDiameter_m = 0.02;
/// Sizes below and above these are refused [m].
constexpr double kLeastSize_m = 0.001, kMostSize_m = 50;

/// A box, plane or pipe as a body; a point as a small sphere.  The margin is the 95 % uncertainty of its worst vertex, at most
/// 0.1 m.  The slab of a plane lies behind the marked face.
/// @returns kInvalidInput with a sentence: a bare line has no thickness; picks that reject right angles are no box.
Result<WorldItem> worldItemFrom(const vision::Feature& feature);
/// A workspace around the arm as the robot stands: as far as it reaches, from the floor up; to be made smaller.
/// @param reach_m Of the arm from its base.
WorldItem workspaceAround(const Eigen::Vector3d& base, double reach_m, const std::string& frame);
/// The 95 % uncertainty of the worst vertex, at most 0.1 [m].
double marginOf(const vision::Feature& feature);
/// Several measured points as one cloud.  @pre not empty, all of them points of one frame
WorldItem worldPointsFrom(const std::vector<vision::Feature>& points);

/// @returns kInvalidInput naming value and limits.
Status checkWorldItem(const WorldItem& item);

/// What planning and scene need: one body, or one per point.  @param with_margin Enlarged by it on every side (a workspace:
/// made smaller).
std::vector<planning::WorldObject> bodiesOf(const WorldItem& item, bool with_margin);
/// What a plan must heed: obstacles and zones in this frame, margins included; without obstacles that came from `skip`,
/// which the macro handles itself, and without the moving parts of `carried`, which go with the tool.
std::vector<planning::WorldObject> obstaclesOf(const std::vector<WorldItem>& items, const std::string& frame, FeatureId skip,
                                               WorldItemId carried = {});

/// The item as the view sees it, filled and seen through.
void addWorldItem(const WorldItem& item, const vision::View& view, vision::Overlay* overlay);

}  // namespace longarm::session
