// grasp_by_faces: a box is taken between two opposite faces.
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

constexpr double kSpare = 0.004;         // on either side of the box between the open fingers [m]
constexpr double kFromBelow = -0.3;      // upward part of a face's normal below which nothing comes from there

class GraspByFaces final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"grasp_by_faces", "Grasp By Faces", "Takes the marked box between two opposite faces that fit between the fingers.",
            vision::FeatureKind::kTriad,
            {standOffParameter(0.10),
             {"depth", "m", 0.025, 0, 0.1, "How far the tool point goes beyond the face it comes through."},
             approachSpeedParameter()},
            0.008,
            true};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto box = boxPatchFrom(setup.feature);
    if (!box) return box.error();
    const auto& gripper = setup.run.workcell().gripper;
    if (!gripper || gripper->links.empty()) return {ErrorCode::kInvalidInput, "the workcell names no gripper, or no gripper links"};
    const double widest = gripper->max_width - 2 * kSpare;
    TaskPart part;
    for (int axis = 0; axis < 3; ++axis) {
      if (box->size[axis] > widest) continue;
      for (int face = 0; face < 6; ++face) {
        if (face / 2 == axis || box->normal(face).dot(setup.run.up()) < kFromBelow) continue;
        for (const double sign : {1.0, -1.0}) part.tasks.push_back(taskThrough(setup, *box, axis, face, sign));
      }
    }
    if (part.tasks.empty()) {
      return {ErrorCode::kOutOfLimits, "the box is " + formatFixed(1e3 * box->size.minCoeff(), 1) + " mm across at its narrowest; the open gripper takes " +
                                           formatFixed(1e3 * widest, 1) + " mm"};
    }
    setup.job.obstacles.push_back(box->object(setup.feature.name));
    setup.job.grasped = setup.job.obstacles.back();
    setup.job.touchable = objectsThrough(setup.run.context(), box->X_RO.translation());
    setup.job.touchable.push_back(setup.feature.name);
    setup.job.open_gripper = true;
    setup.job.place = box->X_RO.translation();
    setup.job.parts.push_back(std::move(part));
    return {};
  }

 private:
  static ToolTask taskThrough(const MacroSetup& setup, const BoxPatch& box, int axis, int face, double sign) {
    const Eigen::Vector3d z = -box.normal(face), y = sign * box.X_RO.linear().col(axis);
    const double depth = std::min(setup.arguments["depth"], 0.5 * box.size[face / 2]);
    const Eigen::Vector3d end = box.faceCenter(face) + depth * z;
    ToolTask task;
    task.X_entry = poseAt(end - (setup.arguments["stand_off"] + depth) * z, toolRotation(z, y.cross(z)));
    ToolPath path(task.X_entry);
    path.lineTo(end);
    task.stages.push_back({"approach", path, setup.arguments["approach_speed"], true, true});
    // From above first, then through the faces that look at the arm, then the others.
    const double facing = box.normal(face).dot((setup.reach.shoulder - box.X_RO.translation()).normalized());
    task.preference = box.normal(face).dot(setup.run.up()) > 0.7 ? 0 : facing > 0.3 ? 1 : 2;
    return task;
  }
};

}  // namespace

std::unique_ptr<Macro> makeGraspByFaces() { return std::make_unique<GraspByFaces>(); }

}  // namespace longarm::planning
