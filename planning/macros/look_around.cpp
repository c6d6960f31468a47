// look_around: a camera goes round a box and looks at its middle.
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "planning/macros/camera_look.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"

namespace longarm::planning {
namespace {

constexpr int kLeastViews = 2;

class LookAround final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"look_around", "Look All Around", "Brings the arm's camera to a ring of places about the marked box, looking at its middle.",
            vision::FeatureKind::kTriad,
            {{"stand_off", "m", 0.20, 0.05, 2, "Of the camera from the ball around the box's corners."},
             {"views", "choice", 8, kLeastViews, 24, "How many places on the ring; those that cannot be reached are left out."},
             {"elevation", "rad", 0.6109, -0.5236, 1.3963, "Of the places over the box's middle, seen from there."}},
            0.05,
            true};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto box = boxPatchFrom(setup.feature);
    if (!box) return box.error();
    const Eigen::Vector3d middle = box->X_RO.translation(), up = setup.run.up();
    const double distance = 0.5 * box->size.norm() + setup.arguments["stand_off"], elevation = setup.arguments["elevation"];
    const int views = setup.arguments.choice("views");
    const auto camera = armEyeOf(setup.run.workcell(), setup.run.context().start, setup.X_RT);
    if (!camera) setup.run.plan().notes.push_back("The arm has no camera: the tool's own z axis looks.");
    const ArmEye eye = camera.value_or(ArmEye{setup.X_RT, Pose::Identity()});
    // The middle view stands on the arm's side; from there to both ends behind the box.
    Eigen::Vector3d here = setup.reach.shoulder - middle;
    here -= here.dot(up) * up;
    if (here.norm() < 1e-3) here = setup.X_RT.linear().col(0) - setup.X_RT.linear().col(0).dot(up) * up;
    if (here.norm() < 1e-3) return {ErrorCode::kDegenerate, "the box stands over the arm's shoulder: drive away from it"};
    here.normalize();
    const Eigen::Vector3d left = up.cross(here);
    for (int k = 0; k < views; ++k) {
      const double azimuth = 2 * M_PI * (k - views / 2) / views;
      const Eigen::Vector3d level = std::cos(azimuth) * here + std::sin(azimuth) * left;
      const Eigen::Vector3d out = std::cos(elevation) * level + std::sin(elevation) * up;
      setup.job.parts.push_back({"view " + std::to_string(k + 1), false, true, lookTasks(eye, middle, -out, distance, up, 0)});
    }
    setup.job.least_parts = kLeastViews;
    setup.job.obstacles.push_back(box->object(setup.feature.name));
    setup.job.place = middle;
    setup.measure = [views](const ArmSpace&, Plan& plan) { count(views, plan); };
    return {};
  }

 private:
  static void count(int views, Plan& plan) {
    const auto reached = std::count_if(plan.stages.begin(), plan.stages.end(), [](const PlanStage& stage) { return stage.name.rfind("view ", 0) == 0; });
    plan.figures["views"] = static_cast<double>(reached);
    plan.figures["views_wanted"] = views;
    plan.notes.push_back(std::to_string(reached) + " of " + std::to_string(views) + " views can be reached.");
  }
};

}  // namespace

std::unique_ptr<Macro> makeLookAround() { return std::make_unique<LookAround>(); }

}  // namespace longarm::planning
