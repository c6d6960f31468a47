#include "hardware/motion_gate.h"

#include <atomic>
#include <cmath>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

#include "core/require.h"
#include "core/text.h"
#include "hardware/horizon_checks.h"
#include "hardware/stop_horizon.h"

namespace longarm::hardware {
namespace {

using StopCallback = std::function<void(const std::string&, const std::string&)>;

// One horizon that was sent.
struct Leg {
  Trajectory path;
  double start_s = 0;
  bool is_stop = false;

  bool inForce(double now_s) const { return now_s - start_s < path.duration(); }
};

constexpr double kDriveForce_s = 0.25;   // how long a base goes on after a command
constexpr std::size_t kLegsKept = 64;    // more than a second at 50 Hz

std::shared_ptr<const Leg> legOf(const Horizon& horizon) {
  return std::make_shared<const Leg>(
      Leg{Trajectory{horizon.joint_names, horizon.points}, horizon.start_s, horizon.is_stop});
}

}  // namespace

struct MotionGate::Impl {
  std::shared_ptr<RobotArm> arm;
  std::vector<std::string> joints;
  MotionLimits limits;
  const Clock& clock;
  GateOptions options;
  GateChecks checks;

  std::mutex submit_mutex;               // one submitter, reset or acquire at a time; stop() never takes it
  std::optional<std::uint64_t> last_sequence;
  std::optional<double> apart_since;     // measured and commanded joints have been apart

  std::shared_ptr<MobileBase> base;
  BaseLimits base_limits;
  std::atomic<double> driven_until_s{-1e9};  // a command is in force till then

  std::atomic<bool> stopped{true};
  std::atomic<std::uint64_t> stops{0}, accepted{0}, refused{0};

  // Leaf lock: held for copying only, nothing is called under it.
  mutable std::mutex mutex;
  std::deque<std::shared_ptr<const Leg>> legs;   // oldest first
  std::string reason = "not released since the start", source = "start", owner;
  bool cause_recorded = false;
  std::shared_ptr<const StopCallback> callback;

  Impl(std::shared_ptr<RobotArm> a, std::vector<std::string> j, MotionLimits l, const Clock& c, GateOptions o,
       GateChecks k)
      : arm(std::move(a)), joints(std::move(j)), limits(std::move(l)), clock(c), options(o), checks(std::move(k)) {}

  std::shared_ptr<const Leg> legAt(double now_s) const {
    std::lock_guard<std::mutex> lock(mutex);
    for (auto it = legs.rbegin(); it != legs.rend(); ++it) {
      if ((*it)->start_s <= now_s) return *it;
    }
    return legs.empty() ? nullptr : legs.front();
  }

  void remember(std::shared_ptr<const Leg> leg) {
    std::lock_guard<std::mutex> lock(mutex);
    // A new horizon replaces whatever would have started later.
    while (!legs.empty() && legs.back()->start_s >= leg->start_s) legs.pop_back();
    legs.push_back(std::move(leg));
    if (legs.size() > kLegsKept) legs.pop_front();
  }

  std::string currentOwner() const {
    std::lock_guard<std::mutex> lock(mutex);
    return owner;
  }

  Status refuse(Error error) {
    ++refused;
    std::lock_guard<std::mutex> lock(mutex);
    if (!stopped) reason = error.message;
    return error;
  }

  Result<std::shared_ptr<const JointState>> freshState(double now_s) const;
  Status checkAuthority(const Horizon& horizon) const;
  Status checkStart(const Horizon& horizon, const JointState& measured, double now_s) const;
  Status checkAll(const Horizon& horizon, double now_s);
  Status checkJump(const Horizon& horizon, const TrajectoryPoint& reference, double tolerance,
                   const char* what) const;
  void followUp(double now_s, std::string& complaint);
  void brake() noexcept;
  bool baseMoves(double now_s) const;
  Status checkDrive(const std::string& by, const BaseTwist& twist, double now_s) const;
};

MotionGate::MotionGate(std::shared_ptr<RobotArm> arm, std::vector<std::string> joints, MotionLimits limits,
                       const Clock& clock, GateOptions options, GateChecks checks)
    : m_impl(std::make_unique<Impl>(std::move(arm), std::move(joints), std::move(limits), clock, options,
                                    std::move(checks))) {
  const auto n = static_cast<Eigen::Index>(m_impl->joints.size());
  const MotionLimits& l = m_impl->limits;
  LONGARM_REQUIRE(m_impl->arm != nullptr && n > 0, "MotionGate needs an arm and its joints");
  LONGARM_REQUIRE(l.lower.size() == n && l.upper.size() == n && l.max_velocity.size() == n &&
                      l.max_acceleration.size() == n && l.stop_deceleration.size() == n,
                  "MotionGate needs one limit per joint");
}

MotionGate::~MotionGate() = default;

Status MotionGate::acquire(const std::string& owner) {
  std::lock_guard<std::mutex> submit_lock(m_impl->submit_mutex);
  if (owner.empty()) return {ErrorCode::kRefused, "the arm cannot be taken without a name"};
  if (m_impl->stopped) {
    return {ErrorCode::kRefused, "\"" + owner + "\" cannot take the arm: STOP is latched; release it first"};
  }
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  if (m_impl->owner == owner) return {};
  if (!m_impl->owner.empty()) {
    return {ErrorCode::kRefused, "\"" + owner + "\" cannot take the arm: \"" + m_impl->owner + "\" has it"};
  }
  m_impl->owner = owner;
  m_impl->last_sequence.reset();
  return {};
}

void MotionGate::release(const std::string& owner) {
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  if (m_impl->owner == owner) m_impl->owner.clear();
}

Result<std::shared_ptr<const JointState>> MotionGate::Impl::freshState(double now_s) const {
  auto state = arm->jointState();
  if (state == nullptr) return Error{ErrorCode::kStale, "no joint state has come from the robot yet"};
  const double age = now_s - state->stamp_s;
  if (!(std::abs(age) <= options.max_state_age_s)) {
    return Error{ErrorCode::kStale, "the joint state is " + formatFixed(age, 3) + " s old; the limit is " +
                                        formatFixed(options.max_state_age_s, 3) + " s"};
  }
  return state;
}

Status MotionGate::Impl::checkAuthority(const Horizon& h) const {
  if (stopped) return {ErrorCode::kRefused, "STOP is latched; release it first"};
  const std::string has = currentOwner();
  if (h.owner.empty() || h.owner != has) {
    return {ErrorCode::kRefused, "\"" + h.owner + "\" may not move the arm: " +
                                     (has.empty() ? "nobody has taken it" : "\"" + has + "\" has it")};
  }
  if (h.is_stop) return {ErrorCode::kRefused, "only STOP brakes at the stop deceleration"};
  if (last_sequence && h.sequence <= *last_sequence) {
    return {ErrorCode::kRefused, "horizon " + std::to_string(h.sequence) + " of \"" + h.owner +
                                     "\" comes after " + std::to_string(*last_sequence) +
                                     "; the sequence must grow"};
  }
  return {};
}

Status MotionGate::Impl::checkJump(const Horizon& h, const TrajectoryPoint& reference, double tolerance,
                                   const char* what) const {
  const auto& first = h.points.front();
  for (Eigen::Index j = 0; j < first.positions.size(); ++j) {
    const std::string& joint = joints[static_cast<std::size_t>(j)];
    const double position = first.positions[j] - reference.positions[j];
    if (!(std::abs(position) <= tolerance)) {
      return {ErrorCode::kOutOfLimits, "horizon of \"" + h.owner + "\" starts " + formatNumber(position) +
                                           " from the " + what + " position of joint " + joint +
                                           "; the limit is " + formatNumber(tolerance)};
    }
    const double velocity = first.velocities[j] - reference.velocities[j];
    if (!(std::abs(velocity) <= options.max_velocity_jump)) {
      return {ErrorCode::kOutOfLimits, "horizon of \"" + h.owner + "\" starts " + formatNumber(velocity) +
                                           " off the " + what + " velocity of joint " + joint +
                                           "; the limit is " + formatNumber(options.max_velocity_jump)};
    }
  }
  return {};
}

Status MotionGate::Impl::checkStart(const Horizon& h, const JointState& measured, double now_s) const {
  const double offset = h.start_s - now_s;
  if (!(std::abs(offset) <= options.max_start_offset_s)) {
    return {offset < 0 ? ErrorCode::kStale : ErrorCode::kRefused,
            "horizon of \"" + h.owner + "\" starts " + formatFixed(offset, 3) + " s from now; the limit is " +
                formatFixed(options.max_start_offset_s, 3) + " s"};
  }
  const auto leg = legAt(h.start_s);
  if (leg != nullptr && leg->inForce(h.start_s)) {
    return checkJump(h, leg->path.sample(h.start_s - leg->start_s), options.max_continuation_error, "commanded");
  }
  const auto positions = measured.positionsOf(joints);
  if (!positions) return positions.error();
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(positions->size());
  return checkJump(h, {0, *positions, rest, rest}, options.max_start_error, "measured");
}

Status MotionGate::Impl::checkAll(const Horizon& horizon, double now_s) {
  if (auto status = checkAuthority(horizon); !status) return status;
  if (baseMoves(now_s)) return {ErrorCode::kRefused, "the base is driving; the arm moves when it stands"};
  if (auto status = checkHorizon(horizon, joints, limits, options); !status) return status;
  const auto state = freshState(now_s);
  if (!state) return state.error();
  if (auto status = checkStart(horizon, **state, now_s); !status) return status;
  return checkSurroundings(horizon, checks);
}

Status MotionGate::submit(const Horizon& horizon) {
  watch();
  std::lock_guard<std::mutex> submit_lock(m_impl->submit_mutex);
  const std::uint64_t stops_before = m_impl->stops;
  try {
    if (auto status = m_impl->checkAll(horizon, m_impl->clock.now_s()); !status) {
      return m_impl->refuse(status.error());
    }
    auto leg = legOf(horizon);
    if (m_impl->stops != stops_before) return m_impl->refuse({ErrorCode::kRefused, "STOP was pressed"});
    if (auto status = m_impl->arm->send(horizon); !status) return m_impl->refuse(status.error());
    m_impl->remember(std::move(leg));
  } catch (const std::exception& e) {
    return m_impl->refuse({ErrorCode::kInternal, std::string("the arm's driver failed: ") + e.what()});
  }
  m_impl->last_sequence = horizon.sequence;
  // STOP may have come between the check and the sending, and its command before ours: brake again.
  if (m_impl->stopped || m_impl->stops != stops_before) {
    m_impl->brake();
    return m_impl->refuse({ErrorCode::kRefused, "STOP was pressed"});
  }
  ++m_impl->accepted;
  return {};
}

void MotionGate::setBase(std::shared_ptr<MobileBase> base, const BaseLimits& limits) {
  std::lock_guard<std::mutex> submit_lock(m_impl->submit_mutex);
  m_impl->base = std::move(base);
  m_impl->base_limits = limits;
}

bool MotionGate::Impl::baseMoves(double now_s) const {
  if (base == nullptr) return false;
  if (now_s < driven_until_s) return true;
  const auto odometry = base->odometry();
  if (odometry == nullptr || now_s - odometry->stamp_s > options.max_state_age_s) return false;
  return !odometry->twist.standing();
}

bool MotionGate::driving() const { return m_impl->baseMoves(m_impl->clock.now_s()); }

Status MotionGate::Impl::checkDrive(const std::string& by, const BaseTwist& twist, double now_s) const {
  if (base == nullptr) return {ErrorCode::kRefused, "this robot has no base that can be driven"};
  if (stopped) return {ErrorCode::kRefused, "drive: STOP is latched; release it first"};
  const std::string has = currentOwner();
  if (by.empty() || by != has) {
    return {ErrorCode::kRefused, "\"" + by + "\" may not drive: " +
                                     (has.empty() ? "nobody has taken the robot" : "\"" + has + "\" has it")};
  }
  if (auto status = checkTwist(twist, base_limits); !status) return status;
  if (twist.still()) return {};
  const auto leg = legAt(now_s);
  if (leg != nullptr && leg->inForce(now_s))
    return {ErrorCode::kRefused, "drive: the arm still moves; it must be held"};
  const auto odometry = base->odometry();
  if (odometry == nullptr) return {ErrorCode::kStale, "drive: no odometry has come from the robot yet"};
  const double age = now_s - odometry->stamp_s;
  if (!(std::abs(age) <= options.max_state_age_s)) {
    return {ErrorCode::kStale, "drive: the odometry is " + formatFixed(age, 3) + " s old; the limit is " +
                                   formatFixed(options.max_state_age_s, 3) + " s"};
  }
  return {};
}

Status MotionGate::drive(const std::string& owner, const BaseTwist& twist) {
  std::lock_guard<std::mutex> submit_lock(m_impl->submit_mutex);
  const std::uint64_t stops_before = m_impl->stops;
  const double now_s = m_impl->clock.now_s();
  try {
    if (auto status = m_impl->checkDrive(owner, twist, now_s); !status) return m_impl->refuse(status.error());
    if (!twist.still()) m_impl->driven_until_s = now_s + kDriveForce_s;
    if (auto status = m_impl->base->drive(twist); !status) return m_impl->refuse(status.error());
  } catch (const std::exception& e) {
    return m_impl->refuse({ErrorCode::kInternal, std::string("the base's driver failed: ") + e.what()});
  }
  // As in submit(): STOP may have been told to the base before our command.
  if (m_impl->stopped || m_impl->stops != stops_before) {
    m_impl->base->stop();
    return m_impl->refuse({ErrorCode::kRefused, "STOP was pressed"});
  }
  ++m_impl->accepted;
  return {};
}

// Fills in the complaint when the arm must be stopped.
void MotionGate::Impl::followUp(double now_s, std::string& complaint) {
  const auto state = arm->jointState();
  if (stopped || state == nullptr) return;
  const auto leg = legAt(state->stamp_s);
  const auto measured = state->positionsOf(joints);
  // What is measured before our first horizon or long after the last says nothing about tracking.
  if (leg == nullptr || !measured || state->stamp_s < leg->start_s ||
      state->stamp_s > leg->start_s + leg->path.duration() + 0.5) {
    apart_since.reset();
    return;
  }
  const Eigen::VectorXd apart =
      (*measured - leg->path.sample(state->stamp_s - leg->start_s).positions).cwiseAbs();
  Eigen::Index worst = 0;
  const double error = apart.maxCoeff(&worst);
  if (!(error > options.max_tracking_error)) {
    apart_since.reset();
    return;
  }
  if (!apart_since) apart_since = now_s;
  if (now_s - *apart_since < options.tracking_time_s) return;
  complaint = "joint " + joints[static_cast<std::size_t>(worst)] + " is " + formatFixed(error, 3) +
              " from where it was sent; the limit is " + formatFixed(options.max_tracking_error, 3) +
              ". Look for an obstacle, then plan again";
}

void MotionGate::watch() {
  std::string complaint;
  try {
    std::lock_guard<std::mutex> submit_lock(m_impl->submit_mutex);
    m_impl->followUp(m_impl->clock.now_s(), complaint);
  } catch (const std::exception& e) {
    complaint = std::string("the joint state cannot be read: ") + e.what();
  }
  if (!complaint.empty()) stop("tracking", complaint);
}

// Sends the stop horizon along the horizon in force, then the arm's own stop.
void MotionGate::Impl::brake() noexcept {
  try {
    const double now_s = clock.now_s();
    const auto leg = legAt(now_s);
    if (leg != nullptr && leg->inForce(now_s) && !leg->is_stop) {
      Horizon stop_horizon = brakeAlong(leg->path, now_s - leg->start_s, limits.stop_deceleration);
      stop_horizon.owner = "stop";
      stop_horizon.start_s = now_s;
      if (stop_horizon.points.size() >= 2) {
        (void)arm->send(stop_horizon);   // the arm's own stop follows whatever this answers
        remember(legOf(stop_horizon));
      }
    }
  } catch (...) {  // the arm's own stop follows
  }
  arm->stop();
  if (base != nullptr) base->stop();
  driven_until_s = -1e9;
}

void MotionGate::stop(const std::string& source, const std::string& reason) noexcept {
  ++m_impl->stops;                       // before the flag: reset() clears the flag, then looks at the count
  m_impl->stopped = true;
  m_impl->brake();
  try {
    std::shared_ptr<const StopCallback> callback;
    {
      std::lock_guard<std::mutex> lock(m_impl->mutex);
      m_impl->owner.clear();
      if (!m_impl->cause_recorded) {
        m_impl->source = source;
        m_impl->reason = reason;
        m_impl->cause_recorded = true;
      }
      callback = m_impl->callback;
    }
    if (callback != nullptr && *callback) (*callback)(source, reason);
  } catch (...) {  // a callback is no reason not to stop
  }
}

Status MotionGate::reset() {
  std::lock_guard<std::mutex> submit_lock(m_impl->submit_mutex);
  const double now_s = m_impl->clock.now_s();
  const auto leg = m_impl->legAt(now_s);
  if (m_impl->stopped && leg != nullptr && leg->inForce(now_s)) {
    return {ErrorCode::kRefused, "the arm still brakes; release STOP when it stands"};
  }
  const std::uint64_t stops_before = m_impl->stops;
  if (m_impl->arm->state() == DeviceState::kIdle) {
    if (auto status = m_impl->arm->activate(); !status) return status;
  }
  if (m_impl->base != nullptr && m_impl->base->state() == DeviceState::kIdle) {
    if (auto status = m_impl->base->activate(); !status) return status;
  }
  const DeviceState state = m_impl->arm->state();
  if (state != DeviceState::kActive) {
    return {ErrorCode::kRefused, "STOP cannot be released: " + m_impl->arm->name() + " is " + toString(state)};
  }
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  m_impl->legs.clear();
  m_impl->apart_since.reset();
  m_impl->reason.clear();
  m_impl->source.clear();
  m_impl->cause_recorded = false;
  m_impl->stopped = false;
  if (m_impl->stops == stops_before) return {};
  m_impl->stopped = true;                // pressed again meanwhile
  return {ErrorCode::kRefused, "STOP was pressed again"};
}

GateStatus MotionGate::status() const {
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  return {m_impl->stopped, m_impl->reason, m_impl->source, m_impl->owner, m_impl->accepted, m_impl->refused};
}

bool MotionGate::stopped() const { return m_impl->stopped; }

Result<TrajectoryPoint> MotionGate::commandedAt(double now_s) const {
  if (const auto leg = m_impl->legAt(now_s)) {
    TrajectoryPoint out = leg->path.sample(now_s - leg->start_s);
    out.t = now_s;
    return out;
  }
  const auto state = m_impl->arm->jointState();
  if (state == nullptr) return Error{ErrorCode::kStale, "no joint state has come from the robot yet"};
  const auto positions = state->positionsOf(m_impl->joints);
  if (!positions) return positions.error();
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(positions->size());
  return TrajectoryPoint{now_s, *positions, rest, rest};
}

void MotionGate::onStop(StopCallback callback) {
  auto shared = std::make_shared<const StopCallback>(std::move(callback));
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  m_impl->callback = std::move(shared);
}

}  // namespace longarm::hardware
