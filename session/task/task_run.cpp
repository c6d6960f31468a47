#include "session/task/task_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/text.h"
#include "planning/macros/macro.h"
#include "session/robot/gripper_watch.h"
#include "session/task/lift_motion.h"
#include "vision/stereo/measure.h"

namespace longarm::session {
namespace {

using planning::PlayerState;

constexpr double kTick_s = 0.02;
constexpr double kGone_s = 4;            // A link that is lost for longer is gone for good.
constexpr double kConnect_s = 15, kAim_s = 12, kPictures_s = 30, kGripper_s = 6, kReady_s = 3;
constexpr double kPlanning_s = 10;
constexpr double kSettle_s = 0.3;        // between the end of a motion and a picture
constexpr double kLiftAbove = 0.02;      // more than the goal asks for [m]
constexpr double kAxisShown = 0.15;      // to either side of the middle of a mechanism's axis [m]
constexpr double kUsualLift = 0.1;       // where no goal says how far [m]

std::string millimetres(double metres) { return formatFixed(1000 * metres, 1) + " mm"; }

// Without a task of its own: Grab Pipe on what the first goal wants taken hold of.
std::vector<planning::ScenarioStep> taskOf(const planning::Scenario& scenario) {
  if (!scenario.task.empty()) return scenario.task;
  planning::ScenarioStep grab;
  for (const auto& goal : scenario.goals) {
    if (grab.object.empty() && (goal.kind == "grasp" || goal.kind == "lift")) grab.object = goal.object;
  }
  if (grab.object.empty() && scenario.random_pipe) grab.object = scenario.random_pipe->object;
  const auto* object = scenario.object(grab.object);
  const auto* cylinder = object != nullptr ? std::get_if<planning::Cylinder>(&object->body.shape) : nullptr;
  if (cylinder == nullptr) return {};
  grab.macro = "grab_pipe";
  grab.arguments = {{"radius", cylinder->radius}};
  grab.close_gripper = true;
  return {grab};
}

// Half the size of a shape along its own axes.
Eigen::Vector3d halves(const planning::Shape& shape) {
  if (const auto* box = std::get_if<planning::Box>(&shape)) return 0.5 * box->size;
  if (const auto* cylinder = std::get_if<planning::Cylinder>(&shape)) return {cylinder->radius, cylinder->radius, 0.5 * cylinder->length};
  if (const auto* sphere = std::get_if<planning::Sphere>(&shape)) return Eigen::Vector3d::Constant(sphere->radius);
  return Eigen::Vector3d::Ones();
}

vision::FeatureKind kindOf(std::size_t places) {
  constexpr vision::FeatureKind kKinds[] = {vision::FeatureKind::kPoint, vision::FeatureKind::kLine, vision::FeatureKind::kPlane,
                                            vision::FeatureKind::kTriad};
  return kKinds[std::min<std::size_t>(places, 4) - 1];
}

Eigen::Vector3d middleOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// Distance of the tool from the line through the first two places, or from the only one.
double offTheMark(const std::vector<Eigen::Vector3d>& places, const Eigen::Vector3d& tool) {
  const Eigen::Vector3d off = tool - places[0];
  if (places.size() < 2) return off.norm();
  const Eigen::Vector3d along = (places[1] - places[0]).normalized();
  return (off - off.dot(along) * along).norm();
}

double liftHeight(const planning::Scenario& scenario) {
  for (const auto& goal : scenario.goals) {
    if (goal.kind == "lift") return goal.amount + kLiftAbove;
  }
  return kUsualLift;
}

}  // namespace

TaskRun::TaskRun(const planning::Workcell& workcell, planning::Scenario scenario, const TaskOptions& options,
                 TaskFaults faults)
    : m_workcell(std::make_shared<planning::Workcell>(workcell)),
      m_scenario(std::move(scenario)),
      m_options(options),
      m_task(taskOf(m_scenario)),
      m_faults(std::move(faults)),
      m_hand(options.seed, options.click_sigma_px) {}

TaskRun::~TaskRun() = default;

Status TaskRun::start() {
  RuntimeOptions options;
  options.scenario = m_options.scenario;
  options.variant = m_options.variant;
  options.seed = m_options.seed;
  options.ideal = m_options.ideal;
  options.lockstep = m_options.lockstep;
  options.virtual_robot = m_options.virtual_robot;
  options.gui_watchdog = false;
  options.stream_cameras = false;        // only the pair, and only while it is needed
  options.through = m_faults.through();
  auto runtime = RobotRuntime::start(m_workcell, options);
  if (!runtime) return runtime.error();
  m_runtime = std::move(*runtime);
  m_started_s = m_runtime->clock().now_s();
  m_runtime->onEvent([this](const RuntimeEvent& event) {
    if (event.kind != "stop" || event.source == "console") return;
    std::lock_guard<std::mutex> lock(m_mutex);
    m_stops.push_back({event.t_s - m_started_s, event.source, event.text});
  });
  return {};
}

double TaskRun::elapsed() const { return m_runtime->clock().now_s() - m_started_s; }

bool TaskRun::stage(const char* name, StageResult (TaskRun::*work)(), TaskReport& report) {
  const double begin = elapsed();
  const auto result = (this->*work)();
  report.stages.push_back({name, result.ok(), elapsed() - begin, result ? *result : result.error().message});
  if (result) return true;
  report.errors.push_back(std::string(name) + ": " + result.error().message);
  return false;
}

bool TaskRun::step(const planning::ScenarioStep& step, TaskReport& report) {
  m_step = step;
  const bool opens = !m_plan.has_value();        // later steps leave the gripper as it is
  const bool marked = stage("aim", &TaskRun::aim, report) && stage("snapshot", &TaskRun::snapshot, report) &&
                      stage("measure", &TaskRun::measure, report) && stage("plan", &TaskRun::makePlan, report);
  if (!marked || (opens && !stage("open", &TaskRun::openGripper, report)) || !stage("play", &TaskRun::play, report)) return false;
  if (!step.close_gripper) return true;
  m_grasped = m_plan->grasped;
  return stage("close", &TaskRun::closeGripper, report);
}

TaskReport TaskRun::run() {
  TaskReport report;
  const auto wants_lift = [this] {
    const auto& goals = m_scenario.goals;
    return m_grasped && (m_scenario.task.empty() || std::any_of(goals.begin(), goals.end(), [](const auto& goal) { return goal.kind == "lift"; }));
  };
  report.success = stage("connect", &TaskRun::connect, report);
  for (const auto& next : m_task) report.success = report.success && step(next, report);
  report.success = report.success && (!wants_lift() || stage("lift", &TaskRun::lift, report)) && stage("verify", &TaskRun::verify, report);
  if (!report.success) settleAfterStop();
  std::lock_guard<std::mutex> lock(m_mutex);
  report.stops = m_stops;
  report.success = report.success && m_stops.empty();
  return report;
}

StageResult TaskRun::connect() {
  const auto up = waitFor([this] { return m_runtime->status().link == LinkState::kUp; }, kConnect_s,
                          "no joint state came from the robot");
  if (!up) return up.error();
  const auto pair = measuringPair(*m_workcell);
  if (!pair) return pair.error();
  m_cameras = *pair;
  if (auto released = m_runtime->resetStop(); !released) return released.error();
  if (m_task.empty()) {
    return Error{ErrorCode::kInvalidInput, "the scenario " + m_scenario.name + " has neither a task nor a pipe to take hold of"};
  }
  return std::string("the robot's joints are known");
}

StageResult TaskRun::aim() {
  const auto known = truth();
  if (!known) return known.error();
  const auto marks = places(*known);
  if (!marks) return marks.error();
  const auto joints = m_runtime->jointState();
  const auto wishes = aimAt(*m_workcell, {m_cameras.first, m_cameras.second}, middleOf(*marks), *joints);
  if (!wishes) return wishes.error();
  std::string said;
  for (const auto& wish : *wishes) {
    Status sent;                         // devices become active a moment after the connection stands
    const auto accepted = [&] { return (sent = m_runtime->movePanTilt(wish.pan_tilt, wish.pan, wish.tilt)).ok(); };
    if (auto status = waitFor(accepted, kReady_s, "the pan-tilt takes no command"); !status) {
      return Error{status.error().code, sent ? status.error().message : sent.error().message};
    }
    said += (said.empty() ? "" : "; ") + wish.pan_tilt + " to pan " + formatFixed(wish.pan * 180 / M_PI, 1) + ", tilt " +
            formatFixed(wish.tilt * 180 / M_PI, 1) + " deg";
  }
  const auto still = [this, &wishes] {
    for (const auto& wish : *wishes) {
      const auto now = m_runtime->panTilt(wish.pan_tilt);
      if (!now || now->moving || std::abs(now->pan - wish.pan) > 0.02 || std::abs(now->tilt - wish.tilt) > 0.02) return false;
    }
    return true;
  };
  if (auto status = waitFor(still, kAim_s, "the pan-tilt did not arrive"); !status) return status.error();
  const double end = elapsed() + kSettle_s;
  if (auto status = waitFor([&] { return elapsed() >= end; }, 2 * kSettle_s, "time does not pass"); !status) return status.error();
  return said;
}

std::optional<StampedFrame> TaskRun::freshFrame(const std::string& camera, double after_s) const {
  const auto frame = m_runtime->cameraFrame(camera);
  if (!frame || frame->stamp_s < after_s) return std::nullopt;
  auto state = m_runtime->jointStateAt(frame->stamp_s);
  const auto zoom = m_runtime->zoomAt(camera, frame->stamp_s);
  if (!state || !zoom) return std::nullopt;      // what comes after it is still under way
  return StampedFrame{frame, *state, *zoom};
}

StageResult TaskRun::snapshot() {
  for (const auto& name : {m_cameras.first, m_cameras.second}) {
    if (auto status = m_runtime->streamCamera(name, true); !status) return status.error();
  }
  const double after_s = m_runtime->clock().now_s();
  m_snapshots.clear();
  std::optional<StampedFrame> left, right;
  Status pair{ErrorCode::kTimeout, "no pictures"};
  const auto taken = [&] {
    left = freshFrame(m_cameras.first, after_s);
    right = freshFrame(m_cameras.second, after_s);
    pair = left && right ? checkPair(*left, *right) : Status{ErrorCode::kTimeout, "a picture is missing"};
    return pair.ok();
  };
  const auto status = waitFor(taken, kPictures_s, "no pair of pictures came from " + m_cameras.first + " and " + m_cameras.second);
  for (const auto& name : {m_cameras.first, m_cameras.second}) (void)m_runtime->streamCamera(name, false);
  if (!status) return Error{status.error().code, status.error().message + " (" + (pair ? "" : pair.error().message) + ")"};
  for (const auto* frame : {&*left, &*right}) {
    auto made = makeSnapshot(*m_workcell, *frame);
    if (!made) return made.error();
    m_snapshots.push_back(std::move(*made));
  }
  return "pictures " + formatFixed(1000 * std::abs(left->frame->stamp_s - right->frame->stamp_s), 0) + " ms apart";
}

StageResult TaskRun::measure() {
  const auto known = truth();
  if (!known) return known.error();
  const auto marks = places(*known);
  if (!marks) return marks.error();
  std::vector<std::vector<vision::Sighting>> vertices;
  for (const auto& place : *marks) {
    std::vector<vision::Sighting> sightings;
    for (const auto& snapshot : m_snapshots) {
      const auto* camera = m_workcell->camera(snapshot.view.name);
      const auto pose = known->links.find(camera->link);
      if (pose == known->links.end()) return Error{ErrorCode::kNotFound, "the truth does not know camera " + camera->name};
      const auto pixel = m_hand.click(snapshot.view.camera, pose->second, place);
      if (!pixel) return Error{pixel.error().code, snapshot.view.name + ": " + pixel.error().message};
      sightings.push_back({&snapshot.view, *pixel});
    }
    vertices.push_back(std::move(sightings));
  }
  auto measured = vision::measureFeature(m_step.object.empty() ? m_step.mechanism : m_step.object, kindOf(marks->size()), vertices);
  if (!measured) return measured.error();
  m_feature = std::move(*measured);
  double worst = 0;
  for (std::size_t i = 0; i < marks->size(); ++i) worst = std::max(worst, (m_feature->vertices[i].xyz - (*marks)[i]).norm());
  std::string said = "marked within " + millimetres(worst);
  if (m_feature->kind == vision::FeatureKind::kLine) {
    said += "; length " + millimetres(m_feature->length()) + " +- " + millimetres(2 * m_feature->lengthSigma()) + ", truly " +
            millimetres(((*marks)[1] - (*marks)[0]).norm());
  }
  return said;
}

StageResult TaskRun::makePlan() {
  const auto macros = planning::makeMacros(*m_workcell);
  const auto* macro = planning::findMacro(macros, m_step.macro);
  if (macro == nullptr) return Error{ErrorCode::kNotFound, "the workcell has no macro \"" + m_step.macro + "\""};
  const auto q = m_runtime->configuration();
  if (!q) return q.error();
  planning::PlanContext context;
  context.workcell = m_workcell.get();
  context.start = *q;
  context.up = m_runtime->status().up;
  context.arguments = m_step.arguments;
  context.seed = m_options.seed;
  context.budget_s = kPlanning_s;
  context.cancel = m_options.cancel;
  planning::Plan plan = macro->plan(context, &*m_feature);
  if (!plan.ok()) return Error{ErrorCode::kNoSolution, std::string(planning::toString(plan.status)) + ": " + plan.reason};
  if (plan.go == "no_go") return Error{ErrorCode::kRefused, "no_go: " + plan.accuracy_note};
  m_plan = std::move(plan);
  return formatFixed(m_plan->trajectory.duration(), 2) + " s of motion, clearance " + millimetres(m_plan->min_clearance) +
         ", " + m_plan->go;
}

StageResult TaskRun::openGripper() {
  const auto& gripper = *m_workcell->gripper;
  if (auto status = m_runtime->setGripper(gripper.open); !status) return status.error();
  const double tolerance = 0.02 * std::abs(gripper.open - gripper.closed);
  const auto open = [&] { return std::abs(m_runtime->gripperPosition() - gripper.open) < tolerance; };
  if (auto status = waitFor(open, kGripper_s, "the gripper did not open"); !status) return status.error();
  return std::string("the gripper is open");
}

StageResult TaskRun::play() {
  if (auto status = m_runtime->load(m_plan->trajectory); !status) return status.error();
  m_runtime->setSpeed(m_options.speed);
  m_grips = GripSequence(*m_plan);
  const double longest = 20 + 3 * m_plan->trajectory.duration() / m_options.speed;
  for (;;) {
    auto status = m_grips.empty() ? Status() : m_runtime->confine(m_grips.low(), m_grips.high());
    if (status) status = m_runtime->play();
    if (status) status = playLoaded(longest, true);
    if (!status) return status.error();
    if (m_grips.next() == nullptr) break;
    if (status = actBetweenStages(); !status) return status.error();
  }
  const auto known = truth();
  if (!known) return known.error();
  const auto tool = known->links.find(m_workcell->arm.tip_link);
  const auto marks = places(*known);
  if (tool == known->links.end() || !marks) return std::string("the motion has reached its end");
  return "the tool is " + millimetres(offTheMark(*marks, tool->second.translation())) + " from the mark";
}

Status TaskRun::playLoaded(double timeout_s, bool with_faults) {
  Status trouble;
  const auto done = [&] {
    const auto status = m_runtime->status();
    if (with_faults && status.duration > 0) trouble = m_faults.strikeAt(status.cursor / status.duration, *m_runtime);
    if (trouble && (status.player == PlayerState::kHalted || status.player == PlayerState::kPaused)) {
      trouble = {ErrorCode::kRefused, "the motion ended before its end: " + status.notice};
    }
    const bool rests = status.player == PlayerState::kPaused && m_grips.due(status.arm_cursor);
    return !trouble || rests || status.player == PlayerState::kDone;
  };
  if (auto status = waitFor(done, timeout_s, "the motion did not come to its end"); !status) return status;
  return trouble;
}

Status TaskRun::actBetweenStages() {
  const planning::GripperStep step = *m_grips.next();
  if (auto status = m_runtime->setGripper(step.position); !status) return status;
  GripperWatch watch(step.position, step.grips, m_runtime->gripperPosition(), elapsed());
  GripperWatch::Outcome outcome = GripperWatch::Outcome::kMoving;
  const auto over = [&] {
    outcome = watch.look(m_runtime->gripperPosition(), m_runtime->holding(), elapsed());
    return outcome != GripperWatch::Outcome::kMoving;
  };
  if (auto status = waitFor(over, kGripper_s + 15, "the gripper did not come to an end"); !status) return status;
  if (outcome == GripperWatch::Outcome::kFailed) return {ErrorCode::kNoSolution, watch.failure()};
  m_grips.finish();
  return {};
}

StageResult TaskRun::closeGripper() {
  if (auto status = m_runtime->setGripper(m_workcell->gripper->closed); !status) return status.error();
  const auto holding = [this] { return m_runtime->holding(); };
  if (auto status = waitFor(holding, kGripper_s, "the gripper has closed on nothing"); !status) return status.error();
  return std::string("the gripper holds something");
}

StageResult TaskRun::lift() {
  const auto q = m_runtime->configuration();
  if (!q) return q.error();
  const double height = liftHeight(m_scenario);
  const auto motion = planLift(*m_workcell, *q, *m_grasped, height);
  if (!motion) return motion.error();
  m_grips = {};
  if (auto status = m_runtime->load(*motion); !status) return status.error();
  if (auto status = m_runtime->play(); !status) return status.error();
  if (auto status = playLoaded(20 + 3 * motion->duration() / m_options.speed, false); !status) return status.error();
  return "lifted by " + millimetres(height);
}

StageResult TaskRun::verify() {
  const auto known = truth();
  if (!known) return known.error();
  const std::string wanted = m_task.front().close_gripper ? m_task.front().object : std::string();
  if (known->held != wanted) {
    return Error{ErrorCode::kNoSolution, known->held.empty() ? "nothing is held" : "\"" + known->held + "\" is held"};
  }
  for (const auto& contact : known->contacts) {
    return Error{ErrorCode::kCollision, contact.first + " touched " + contact.second};
  }
  for (const auto& goal : known->goals) {
    if (!goal.reached) return Error{ErrorCode::kNoSolution, "the goal \"" + goal.kind + " " + goal.object + "\" is not reached"};
  }
  return std::to_string(known->goals.size()) + " goals reached, nothing touched";
}

Result<TaskTruth> TaskRun::truth() {
  const auto answer = m_runtime->callService("/virtual_robot/truth", "{}", 5);
  if (!answer) return answer.error();
  return parseTruth(*answer);
}

Result<std::vector<Eigen::Vector3d>> TaskRun::places(const TaskTruth& truth) const {
  if (const auto* mechanism = m_scenario.mechanism(m_step.mechanism)) {
    const Eigen::Vector3d half = kAxisShown * mechanism->axis;
    return std::vector<Eigen::Vector3d>{mechanism->origin - half, mechanism->origin + half};
  }
  const auto pose = truth.objects.find(m_step.object);
  const auto* object = m_scenario.object(m_step.object);
  if (pose == truth.objects.end() || object == nullptr) return Error{ErrorCode::kNotFound, "the truth does not know \"" + m_step.object + "\""};
  const std::vector<Eigen::Vector3d> axis{{0, 0, -1}, {0, 0, 1}};
  std::vector<Eigen::Vector3d> out;
  for (const auto& at : m_step.at.empty() ? axis : m_step.at) out.push_back(pose->second * at.cwiseProduct(halves(object->body.shape)));
  return out;
}

std::size_t TaskRun::contacts() {
  const auto known = m_runtime ? truth() : Result<TaskTruth>(ErrorCode::kDisconnected, "");
  return known ? known->contacts.size() : 0;
}

std::optional<TaskStop> TaskRun::firstStop() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_stops.empty()) return std::nullopt;
  return m_stops.front();
}

Status TaskRun::checkRobot() {
  if (m_options.cancel.cancelled()) return {ErrorCode::kCancelled, "the task was cancelled"};
  if (const auto stop = firstStop()) return {ErrorCode::kRefused, "stopped by " + stop->source + ": " + stop->reason};
  const auto status = m_runtime->status();
  if (status.link != LinkState::kLost) {
    m_lost_since_s = -1;
    return {};
  }
  const double now_s = elapsed();
  if (m_lost_since_s < 0) m_lost_since_s = now_s;
  if (now_s - m_lost_since_s < kGone_s && status.faults.empty()) return {};
  return {ErrorCode::kDisconnected, status.link_text};
}

Status TaskRun::pass() {
  if (m_options.lockstep) return m_runtime->step(kTick_s);
  std::this_thread::sleep_for(std::chrono::duration<double>(kTick_s / 2));
  return {};
}

Status TaskRun::waitFor(const std::function<bool()>& condition, double timeout_s, const std::string& what) {
  for (const double end = elapsed() + timeout_s;;) {
    if (auto status = checkRobot(); !status) return status;
    if (condition()) return {};
    if (elapsed() > end) return {ErrorCode::kTimeout, what + " within " + formatNumber(timeout_s) + " s"};
    if (auto status = pass(); !status) return status;
  }
}

// A robot that was stopped is left standing, as far as it can still be told.
void TaskRun::settleAfterStop() {
  if (!firstStop()) m_runtime->stop("task", "the task has failed");
  for (const double end = elapsed() + 1; elapsed() < end && !m_runtime->status().stop_confirmed;) {
    if (!pass()) return;
  }
}

}  // namespace longarm::session
