// move_around_axis: from the present grip along an arc about a line, as a door or a lever goes; further than the arm reaches in
// turns, the tool letting go, going back and gripping again.
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"

namespace longarm::planning {
namespace {

constexpr double kLeast = 0.01;          // [rad]
constexpr int kMostGrips = 12;

struct Arc {
  AxisLine line;
  Eigen::Vector3d center;                // of the grip's circle [m]
  bool turn_tool;
};

// The angles of turns that make up the whole, one list for each way to share it out, fewest first.
std::vector<std::vector<double>> turnsOf(double angle, double pitch) {
  std::vector<std::vector<double>> out{{angle}};
  const double sign = angle < 0 ? -1 : 1;
  if (pitch > 0) {
    // As many pitches a turn as there can be, and one fewer each time.
    for (int pitches = std::max(1, static_cast<int>(std::ceil(std::abs(angle) / pitch - 1e-9)) - 1); pitches >= 1; --pitches) {
      std::vector<double> turns;
      double left = std::abs(angle);
      for (; left > pitches * pitch + kLeast; left -= pitches * pitch) turns.push_back(sign * pitches * pitch);
      turns.push_back(sign * left);
      if (turns.size() > 1 && turns.size() <= kMostGrips) out.push_back(std::move(turns));
    }
    return out;
  }
  for (int grips = 2; grips <= kMostGrips && std::abs(angle) / grips > kLeast; ++grips) out.emplace_back(static_cast<std::size_t>(grips), angle / grips);
  return out;
}

Pose turned(const Arc& arc, double angle) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, arc.line.direction).toRotationMatrix();
  return poseAt(arc.center - R * arc.center, R);
}

class MoveAroundAxis final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"move_around_axis", "Move Around Axis",
            "Turns what is gripped about the marked line, right-handed from its first to its second end: door, lid, valve, lever.",
            vision::FeatureKind::kLine,
            {{"angle", "rad", 0.7854, -12.5664, 12.5664, "How far to turn; negative is left-handed."},
             {"turn_tool", "choice", 1, 0, 1, "1: the grip turns with it; 0: the tool keeps its direction and the handle turns in it.", {"no", "yes"}},
             travelSpeedParameter(0.10),
             {"regrip", "choice", 0, 0, 1, "1: where the arm cannot turn all the way at once, it lets go, goes back and grips again.", {"no", "yes"}},
             {"pitch", "rad", 0, 0, 3.1416, "The handle looks the same after each turn by this, as a wheel of six spokes after 1.0472; 0: a round one."},
             {"back_off", "m", 0.08, 0.02, 0.3, "How far the tool backs off before it goes back to grip again."}},
            0.006};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto line = axisLineFrom(setup.feature);
    if (!line) return line.error();
    const double angle = setup.arguments["angle"];
    if (std::abs(angle) < kLeast) return {ErrorCode::kOutOfLimits, "the angle is " + formatNumber(angle) + " rad; at least 0.01 rad is needed"};
    const bool regrip = setup.arguments.choice("regrip") == 1;
    if (regrip && !setup.run.workcell().gripper) return {ErrorCode::kInvalidInput, "to grip again takes a gripper, and the workcell names none"};
    const Arc arc{*line, line->nearest(setup.X_RT.translation()), setup.arguments.choice("turn_tool") == 1};
    const double radius = (setup.X_RT.translation() - arc.center).norm();
    if (radius < 1e-3 && !arc.turn_tool) return {ErrorCode::kDegenerate, "the tool is on the axis: it can only turn with it"};
    TaskPart part;
    part.from_here = true;
    for (const auto& turns : turnsOf(angle, setup.arguments["pitch"])) {
      part.tasks.push_back(taskOf(setup, arc, turns));
      part.tasks.back().preference = static_cast<int>(part.tasks.size()) - 1;
      if (!regrip) break;
    }
    setup.job.parts.push_back(std::move(part));
    setup.job.place = setup.X_RT.translation();
    setup.measure = [radius](const ArmSpace&, Plan& plan) {
      plan.figures["radius"] = radius;
      plan.figures["grips"] = 1 + static_cast<double>(std::count_if(plan.stages.begin(), plan.stages.end(), [](const PlanStage& stage) {
        return stage.gripper && stage.gripper->grips;
      }));
    };
    return {};
  }

 private:
  static ToolTask taskOf(const MacroSetup& setup, const Arc& arc, const std::vector<double>& turns) {
    ToolTask task;
    task.X_entry = setup.X_RT;
    double done = 0;
    for (std::size_t i = 0; i < turns.size(); ++i) {
      ToolPath act(setup.X_RT);
      act.arc(arc.center, arc.line.direction, turns[i], arc.turn_tool);
      task.stages.push_back({"act", act, setup.arguments["speed"], false, false});
      done += turns[i];
      if (i + 1 < turns.size()) goBack(setup, arc, act.end(), turns[i], done, task);
    }
    if (turns.size() > 1) {
      task.note = "Turns in " + std::to_string(turns.size()) + " grips: the gripper lets go, goes back and grips again by itself between them.";
    }
    return task;
  }

  // Lets go where the turn ended, backs off, goes back along the arc, and grips where it gripped at the start.
  static void goBack(const MacroSetup& setup, const Arc& arc, const Pose& X_end, double turn, double done, ToolTask& task) {
    const GripperSpec& gripper = *setup.run.workcell().gripper;
    const Pose X_released = turned(arc, done);
    task.stages.back().gripper = GripperStep{gripper.open, false};
    ToolPath off(X_end);
    off.lineTo(Eigen::Vector3d(X_end.translation() - setup.arguments["back_off"] * X_end.linear().col(2)));
    ToolPath back(off.end());
    back.arc(arc.line.nearest(off.end().translation()), arc.line.direction, -turn, arc.turn_tool);
    ToolPath on(back.end());
    on.lineTo(setup.X_RT);
    const double approach = setup.run.workcell().approach_speed;
    task.stages.push_back({"back off", off, approach, true, true, X_released});
    task.stages.push_back({"return", back, setup.arguments["speed"], false, false, X_released});
    task.stages.push_back({"approach", on, approach, true, true, X_released, GripperStep{gripper.closed, true}});
  }
};

}  // namespace

std::unique_ptr<Macro> makeMoveAroundAxis() { return std::make_unique<MoveAroundAxis>(); }

}  // namespace longarm::planning
