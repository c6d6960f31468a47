// look_at: a camera is turned to a point.
#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/text.h"
#include "planning/macros/camera_look.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_directions.h"

namespace longarm::planning {
namespace {

constexpr double kMostTilt = 75 * M_PI / 180;

int qIndexOf(const RobotModel& model, const std::string& name) {
  const auto joint = model.jointIndex(name);
  return joint ? model.joints()[static_cast<std::size_t>(*joint)].q_index : -1;
}

class LookAt final : public FeatureMacro {
 public:
  explicit LookAt(const Workcell& workcell) : m_arm(hasArmCamera(workcell)) {}

  MacroInfo info() const override {
    return {"look_at", "Look At", "Turns a camera to the marked point: the arm's own, or one on a pan-tilt.",
            vision::FeatureKind::kPoint,
            {{"stand_off", "m", 0.35, 0.1, 2, "Distance of the arm's camera from the point."},
             {"pan_tilt", "choice", m_arm ? 0.0 : 1.0, 0, 1, "1: turn the first pan-tilt and leave the arm where it is; 0: move the arm's camera.", {"arm", "pan-tilt"}}},
            0.05,
            true};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    return setup.arguments.choice("pan_tilt") == 1 ? turnPanTilt(setup) : moveArm(setup);
  }

 private:
  static Status moveArm(MacroSetup& setup) {
    const auto eye = armEyeOf(setup.run.workcell(), setup.run.context().start, setup.X_RT);
    if (!eye) return {ErrorCode::kInvalidInput, "the workcell has no camera on the arm: set pan_tilt to 1"};
    const Eigen::Vector3d p = setup.feature.points[0];
    const Eigen::Vector3d view = p - eye->X_RC.translation();
    TaskPart part;
    for (const auto& direction : directionsAround(view.norm() > 1e-3 ? view : Eigen::Vector3d(eye->X_RC.linear().col(2)), kMostTilt)) {
      for (auto& task : lookTasks(*eye, p, direction.z, setup.arguments["stand_off"], setup.run.up(), 4 * direction.ring)) part.tasks.push_back(std::move(task));
    }
    setup.job.parts.push_back(std::move(part));
    return {};
  }

  // Pan and tilt by Newton steps on where the optical axis passes the point.
  static Status turnPanTilt(MacroSetup& setup) {
    const Workcell& cell = setup.run.workcell();
    const CameraSpec* camera = nullptr;
    for (const auto& c : cell.cameras) {
      if (camera == nullptr && !c.pan_tilt.empty() && cell.model->linkIndex(c.link)) camera = &c;
    }
    const PanTiltSpec* unit = nullptr;
    for (const auto& p : cell.pan_tilts) {
      if (camera != nullptr && p.name == camera->pan_tilt) unit = &p;
    }
    if (unit == nullptr) return {ErrorCode::kInvalidInput, "the workcell has no camera on a pan-tilt: set pan_tilt to 0"};
    Eigen::VectorXd q = setup.run.context().start;
    const int pan = qIndexOf(*cell.model, unit->pan_joint), tilt = qIndexOf(*cell.model, unit->tilt_joint);
    if (pan < 0 || tilt < 0) return {ErrorCode::kInvalidInput, "the pan-tilt \"" + unit->name + "\" has no joints of the robot"};
    if (const Status aimed = aim(*cell.model, *cell.model->linkIndex(camera->link), pan, tilt, setup.feature.points[0], q); !aimed) return aimed;
    for (const auto& [name, index] : {std::pair{unit->pan_joint, pan}, std::pair{unit->tilt_joint, tilt}}) {
      const Joint& joint = cell.model->joints()[static_cast<std::size_t>(*cell.model->jointIndex(name))];
      if (q[index] < joint.lower || q[index] > joint.upper) {
        return {ErrorCode::kOutOfLimits, name + " would have to stand at " + formatFixed(q[index], 3) + ", its limits are " +
                                             formatFixed(joint.lower, 3) + " ... " + formatFixed(joint.upper, 3) + ": drive to face the point"};
      }
      setup.run.plan().pan_tilt[name] = q[index];
    }
    setup.run.plan().notes.push_back("Turn " + unit->name + " to pan " + formatFixed(q[pan] * 180 / M_PI, 1) + " deg, tilt " +
                                     formatFixed(q[tilt] * 180 / M_PI, 1) + " deg; the arm stays where it is.");
    setup.arm_stays = true;
    return {};
  }

  static Status aim(const RobotModel& model, int link, int pan, int tilt, const Eigen::Vector3d& p, Eigen::VectorXd& q) {
    const auto miss = [&](const Eigen::VectorXd& at) -> Eigen::Vector3d {
      const Eigen::Vector3d seen = model.forward(at, link).inverse() * p;
      return seen.normalized() - Eigen::Vector3d::UnitZ();
    };
    constexpr double kDifference = 1e-6;
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3d e = miss(q);
      if (e.norm() < 1e-9) break;
      Eigen::Matrix<double, 3, 2> J;
      for (int k = 0; k < 2; ++k) {
        Eigen::VectorXd next = q;
        next[k == 0 ? pan : tilt] += kDifference;
        J.col(k) = (miss(next) - e) / kDifference;
      }
      const Eigen::Vector2d step = (J.transpose() * J + 1e-9 * Eigen::Matrix2d::Identity()).ldlt().solve(-J.transpose() * e);
      const double scale = std::min(1.0, 0.5 / std::max(step.norm(), 1e-12));
      q[pan] = std::remainder(q[pan] + scale * step[0], 2 * M_PI);
      q[tilt] = std::remainder(q[tilt] + scale * step[1], 2 * M_PI);
    }
    if (miss(q).norm() < 1e-4) return {};
    return {ErrorCode::kOutOfLimits, "the pan-tilt cannot turn its camera to the point: it is too near the axis"};
  }

  bool m_arm;
};

}  // namespace

std::unique_ptr<Macro> makeLookAt(const Workcell& workcell) { return std::make_unique<LookAt>(workcell); }

}  // namespace longarm::planning
