// push_face: against the middle of one face of a box.
#include <algorithm>
#include <vector>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

class PushFace final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"push_face", "Push Face", "Pushes the marked box by the middle of one of its faces, and backs away.", vision::FeatureKind::kTriad,
            {standOffParameter(0.08),
             {"distance", "m", 0.05, 0.002, 0.5, "How far to push from where the tool's end meets the face."},
             {"face", "choice", 0, 0, 6, "0: the first that can be pushed of those that look at the arm; 1 to 6: the faces across the triad's "
                                        "edges, far and near, edge by edge.",
              {"any", "edge 1, far", "edge 1, near", "edge 2, far", "edge 2, near", "edge 3, far", "edge 3, near"}},
             approachSpeedParameter(),
             {"push_speed", "m/s", 0.03, 0.001, 0.2, "Speed of pushing."}},
            0.012};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto box = boxPatchFrom(setup.feature);
    if (!box) return box.error();
    const Eigen::Vector3d to_arm = (setup.reach.shoulder - box->X_RO.translation()).normalized();
    std::vector<std::pair<double, int>> faces;       // least first
    for (int face = 0; face < 6; ++face) {
      const int asked = setup.arguments.choice("face");
      const double facing = box->normal(face).dot(to_arm);
      if (asked == 0 ? facing > 0.1 : asked == face + 1) faces.emplace_back(-facing, face);
    }
    std::sort(faces.begin(), faces.end());
    TaskPart part;
    for (const auto& [unused, face] : faces) {
      part.tasks.push_back(taskOn(setup, *box, face));
      part.tasks.back().preference = static_cast<int>(part.tasks.size());
    }
    setup.job.obstacles.push_back(box->object(setup.feature.name));
    setup.job.touchable = objectsThrough(setup.run.context(), box->X_RO.translation());
    setup.job.touchable.push_back(setup.feature.name);
    setup.job.place = box->X_RO.translation();
    setup.job.parts.push_back(std::move(part));
    return {};
  }

 private:
  static ToolTask taskOn(const MacroSetup& setup, const BoxPatch& box, int face) {
    const Eigen::Vector3d z = -box.normal(face);
    const Eigen::Vector3d on = box.faceCenter(face) - toolOverhang(setup.run.workcell(), setup.run.context().start) * z;
    const Eigen::Vector3d in = on + setup.arguments["distance"] * z;
    ToolTask task;
    task.X_entry = poseAt(on - setup.arguments["stand_off"] * z, toolRotation(z, setup.X_RT.linear().col(0)));
    ToolPath approach(task.X_entry), push(poseAt(on, task.X_entry.linear())), retreat(poseAt(in, task.X_entry.linear()));
    approach.lineTo(on);
    push.lineTo(in);
    retreat.lineTo(task.X_entry);
    task.stages.push_back({"approach", approach, setup.arguments["approach_speed"], true, true});
    task.stages.push_back({"push", push, setup.arguments["push_speed"], true, true});
    task.stages.push_back({"retreat", retreat, setup.arguments["approach_speed"], true, true});
    task.roll_free = true;
    return task;
  }
};

}  // namespace

std::unique_ptr<Macro> makePushFace() { return std::make_unique<PushFace>(); }

}  // namespace longarm::planning
