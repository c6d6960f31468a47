#include "session/task/task_run.h"

#include <chrono>
#include <cmath>
#include <thread>

#include "core/text.h"
#include "planning/macros/macro.h"
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
constexpr double kUsualLift = 0.1;       // where no goal says how far [m]

std::string millimetres(double metres) { return formatFixed(1000 * metres, 1) + " mm"; }

// The object of the first goal that wants something taken hold of.
std::string graspObject(const planning::Scenario& scenario) {
  for (const auto& goal : scenario.goals) {
    if (goal.kind == "grasp" || goal.kind == "lift") return goal.object;
  }
  return scenario.random_pipe ? scenario.random_pipe->object : std::string();
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
      m_object(graspObject(m_scenario)),
      m_faults(std::move(faults)),
      m_hand(options.seed, options.click_sigma_px) {
  const auto* object = m_scenario.object(m_object);
  if (object == nullptr) return;
  if (const auto* cylinder = std::get_if<planning::Cylinder>(&object->body.shape)) {
    m_radius = cylinder->radius;
    m_length = cylinder->length;
  }
}

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

TaskReport TaskRun::run() {
  const std::pair<const char*, StageResult (TaskRun::*)()> stages[] = {
      {"connect", &TaskRun::connect},    {"aim", &TaskRun::aim},     {"snapshot", &TaskRun::snapshot},
      {"measure", &TaskRun::measure},    {"plan", &TaskRun::makePlan}, {"open", &TaskRun::openGripper},
      {"play", &TaskRun::play},          {"close", &TaskRun::closeGripper}, {"lift", &TaskRun::lift},
      {"verify", &TaskRun::verify}};
  TaskReport report;
  report.success = true;
  for (const auto& [name, stage] : stages) {
    const double begin = elapsed();
    const auto result = (this->*stage)();
    report.stages.push_back({name, result.ok(), elapsed() - begin, result ? *result : result.error().message});
    if (result) continue;
    report.success = false;
    report.errors.push_back(std::string(name) + ": " + result.error().message);
    settleAfterStop();
    break;
  }
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
  if (m_length <= 0) {
    return Error{ErrorCode::kInvalidInput, "the scenario " + m_scenario.name + " has no pipe to take hold of"};
  }
  return std::string("the robot's joints are known");
}

StageResult TaskRun::aim() {
  const auto known = truth();
  if (!known) return known.error();
  const auto ends = pipeEnds(*known);
  if (!ends) return ends.error();
  const auto joints = m_runtime->jointState();
  const auto wishes = aimAt(*m_workcell, {m_cameras.first, m_cameras.second}, 0.5 * (ends->first + ends->second), *joints);
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
  if (!state) return std::nullopt;       // the state after it is still under way
  return StampedFrame{frame, *state};
}

StageResult TaskRun::snapshot() {
  for (const auto& name : {m_cameras.first, m_cameras.second}) {
    if (auto status = m_runtime->streamCamera(name, true); !status) return status.error();
  }
  const double after_s = m_runtime->clock().now_s();
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
  const auto ends = pipeEnds(*known);
  if (!ends) return ends.error();
  std::vector<std::vector<vision::Sighting>> vertices;
  for (const auto& end : {ends->first, ends->second}) {
    std::vector<vision::Sighting> sightings;
    for (const auto& snapshot : m_snapshots) {
      const auto* camera = m_workcell->camera(snapshot.view.name);
      const auto pose = known->links.find(camera->link);
      if (pose == known->links.end()) return Error{ErrorCode::kNotFound, "the truth does not know camera " + camera->name};
      const auto pixel = m_hand.click(snapshot.view.camera, pose->second, end);
      if (!pixel) return Error{pixel.error().code, snapshot.view.name + ": " + pixel.error().message};
      sightings.push_back({&snapshot.view, *pixel});
    }
    vertices.push_back(std::move(sightings));
  }
  auto measured = vision::measureFeature(m_object, vision::FeatureKind::kLine, vertices);
  if (!measured) return measured.error();
  m_pipe = std::move(*measured);
  const Eigen::Vector3d middle = 0.5 * (m_pipe->vertices[0].xyz + m_pipe->vertices[1].xyz);
  return "length " + millimetres(m_pipe->length()) + " +- " + millimetres(2 * m_pipe->lengthSigma()) + ", truly " +
         millimetres((ends->second - ends->first).norm()) + "; its middle is " +
         millimetres((middle - 0.5 * (ends->first + ends->second)).norm()) + " off";
}

StageResult TaskRun::makePlan() {
  const auto macros = planning::makeMacros(*m_workcell);
  const auto* macro = planning::findMacro(macros, "grab_pipe");
  if (macro == nullptr) return Error{ErrorCode::kNotFound, "the workcell has no gripper for grab_pipe"};
  const auto q = m_runtime->configuration();
  if (!q) return q.error();
  planning::PlanContext context;
  context.workcell = m_workcell.get();
  context.start = *q;
  context.seed = m_options.seed;
  context.budget_s = kPlanning_s;
  context.cancel = m_options.cancel;
  planning::Plan plan = macro->plan(context, &*m_pipe);
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
  if (auto status = m_runtime->play(); !status) return status.error();
  if (auto status = playLoaded(20 + 3 * m_plan->trajectory.duration() / m_options.speed, true); !status) return status.error();
  const auto known = truth();
  if (!known) return known.error();
  const auto tool = known->links.find(m_workcell->arm.tip_link);
  const auto ends = pipeEnds(*known);
  if (tool == known->links.end() || !ends) return std::string("the motion has reached its end");
  const Eigen::Vector3d along = (ends->second - ends->first).normalized();
  const Eigen::Vector3d off = tool->second.translation() - ends->first;
  return "the tool is " + millimetres((off - off.dot(along) * along).norm()) + " from the pipe's axis";
}

Status TaskRun::playLoaded(double timeout_s, bool with_faults) {
  Status trouble;
  const auto done = [&] {
    const auto status = m_runtime->status();
    if (with_faults && status.duration > 0) trouble = m_faults.strikeAt(status.cursor / status.duration, *m_runtime);
    if (trouble && (status.player == PlayerState::kHalted || status.player == PlayerState::kPaused)) {
      trouble = {ErrorCode::kRefused, "the motion ended before its end: " + status.notice};
    }
    return !trouble || status.player == PlayerState::kDone;
  };
  if (auto status = waitFor(done, timeout_s, "the motion did not come to its end"); !status) return status;
  return trouble;
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
  const auto motion = planLift(*m_workcell, *q, *m_pipe, m_radius, height);
  if (!motion) return motion.error();
  if (auto status = m_runtime->load(*motion); !status) return status.error();
  if (auto status = m_runtime->play(); !status) return status.error();
  if (auto status = playLoaded(20 + 3 * motion->duration() / m_options.speed, false); !status) return status.error();
  return "lifted by " + millimetres(height);
}

StageResult TaskRun::verify() {
  const auto known = truth();
  if (!known) return known.error();
  if (known->held != m_object) {
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

Result<std::pair<Eigen::Vector3d, Eigen::Vector3d>> TaskRun::pipeEnds(const TaskTruth& truth) const {
  const auto pose = truth.objects.find(m_object);
  if (pose == truth.objects.end()) return Error{ErrorCode::kNotFound, "the truth does not know \"" + m_object + "\""};
  const Eigen::Vector3d half = pose->second.linear().col(2) * m_length / 2;
  return std::pair<Eigen::Vector3d, Eigen::Vector3d>(pose->second.translation() - half, pose->second.translation() + half);
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
