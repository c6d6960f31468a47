#include "session/controllers/play_controller.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace longarm::session {

namespace {

using planning::PlayerState;

constexpr double kAtEnd_s = 1e-6;
constexpr double kHeld_s = 0.25;           // A button that must be held counts as let go of after so long.
constexpr double kSlowest = 0.05;          // A wanted factor below this would look like a robot that does not obey.

bool isMoving(PlayerState state) { return state == PlayerState::kPlaying || state == PlayerState::kPausing; }

bool same(const PlayState& a, const PlayState& b) {
  return a.has_plan == b.has_plan && a.loaded == b.loaded && a.playing == b.playing &&
         a.can_play == b.can_play && a.can_back_up == b.can_back_up && a.gripper == b.gripper && a.can_scrub == b.can_scrub &&
         a.stale == b.stale && a.ask == b.ask && a.correcting == b.correcting && a.only_held == b.only_held &&
         a.halted == b.halted && a.halt_reason == b.halt_reason && a.why_not_stage == b.why_not_stage &&
         a.why_not_stage_back == b.why_not_stage_back && a.why_not_correct == b.why_not_correct &&
         a.why_not_play == b.why_not_play && a.why_not_back_up == b.why_not_back_up &&
         a.cursor_s == b.cursor_s && a.duration_s == b.duration_s && a.speed == b.speed && a.rate == b.rate;
}

}  // namespace

PlayController::PlayController(Document& document, PlanController& plans, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_document(document), m_plans(plans), m_jobs(jobs) {
  m_observer = m_document.observe([this](const Change& change) {
    if (change.kind == ChangeKind::kPlanChanged) {
      m_cursor = 0;
      m_off_path.clear();
    }
    forgetOtherPlan();
    rebuild();
  });
  rebuild();
}

PlayController::~PlayController() { m_document.unobserve(m_observer); }

void PlayController::setRuntime(RobotRuntime* runtime) {
  m_runtime = runtime;
  m_loaded = {};
  m_grips = {};
  m_gripper.reset();
  m_go_on = false;
  m_off_path.clear();
  m_status = runtime != nullptr ? runtime->status() : RuntimeStatus();
  rebuild();
}

const planning::Plan* PlayController::plan() const {
  const auto& record = m_document.plan();
  return record && record->plan.ok() && !record->plan.trajectory.empty() ? &record->plan : nullptr;
}

void PlayController::refresh(const RuntimeStatus& status) {
  m_status = status;
  if (status.player == PlayerState::kEmpty) {
    m_loaded = {};
    m_off_path.clear();
    m_grips = {};
    m_gripper.reset();
    m_go_on = false;
  }
  watchGripper();
  forgetOtherPlan();
  if (m_correction && m_status.player == PlayerState::kDone) finishCorrection();
  if (!m_nudges.empty() && !isMoving(m_status.player)) correctNext();
  if (m_status.player == PlayerState::kEmpty) dropCorrections();
  if (m_status.player == PlayerState::kHalted) {
    m_go_on = false;
    m_nudges.clear();                    // one on its way is finished after Reset and Play
    m_resume = false;
  }
  rebuild();
}

void PlayController::forgetOtherPlan() {
  if (!m_loaded.valid() || m_runtime == nullptr || isMoving(m_status.player)) return;
  if (m_document.plan() && m_document.plan()->id == m_loaded) return;
  m_runtime->unload();
  m_loaded = {};
  m_grips = {};
  m_gripper.reset();
  m_go_on = false;
}

QString PlayController::whyNotMove() const {
  if (m_runtime == nullptr) return tr("No robot is connected.");
  if (m_status.link != LinkState::kUp) {
    return tr("The link is %1: %2").arg(QString::fromLatin1(toString(m_status.link)), QString::fromStdString(m_status.link_text));
  }
  if (m_status.gate.stopped) return tr("STOP is latched: hold Reset first.");
  return {};
}

void PlayController::checkPlan(PlayState& next) const {
  if (!m_off_path.isEmpty()) {
    next.stale = true;
    next.why_not_play = m_off_path;
    return;
  }
  if (const Status around = m_plans.checkSurroundings(); next.loaded && !around) {
    next.stale = true;
    next.why_not_play = QString::fromStdString(around.error().message);
    return;
  }
  const auto joints = m_runtime != nullptr ? m_runtime->jointState() : nullptr;
  if (!joints || next.loaded) return;
  const Status fresh = m_plans.checkFresh(*joints);
  if (fresh) return;
  next.stale = fresh.error().code == ErrorCode::kStale;
  next.why_not_play = QString::fromStdString(fresh.error().message);
}

void PlayController::rebuild() {
  PlayState next;
  const planning::Plan* shown = plan();
  next.speed = m_speed;
  next.has_plan = shown != nullptr;
  next.only_held = m_only_held;
  next.loaded = shown != nullptr && m_loaded.valid() && m_document.plan()->id == m_loaded;
  next.playing = (isMoving(m_status.player) || m_gripper) && m_loaded.valid();
  if (m_gripper) next.gripper = m_grips.next()->grips ? tr("the gripper closes") : tr("the gripper opens");
  next.correcting = !m_nudges.empty() || m_planning_correction || m_correction.has_value();
  next.why_not_correct = whyNotCorrect();
  if (shown != nullptr) {
    next.duration_s = shown->trajectory.duration();
    next.cursor_s = next.loaded ? m_status.cursor : std::clamp(m_cursor, 0.0, next.duration_s);
    next.rate = next.loaded ? m_status.rate : 0;
    next.can_scrub = !next.playing;
    checkPlan(next);
    if (next.why_not_play.isEmpty() && shown->go != "go" && !next.loaded && m_accepted != m_document.plan()->id) {
      next.ask = shown->go == "ask";
      next.why_not_play = QString::fromStdString(shown->accuracy_note);
    }
    if (next.why_not_play.isEmpty()) next.why_not_play = whyNotMove();
    if (next.why_not_play.isEmpty() && m_planning_correction) next.why_not_play = tr("The correction is being planned.");
    next.why_not_back_up = !m_off_path.isEmpty()       ? m_off_path
                           : next.loaded && next.stale ? next.why_not_play
                           : next.loaded
                               ? whyNotMove()
                               : tr("The arm stands at the start of this motion: nothing to back up.");
    if (next.loaded && next.why_not_back_up.isEmpty() && m_grips.atLow(m_status.arm_cursor)) next.why_not_back_up = beyondGrip();
    if (next.loaded && m_gripper) next.why_not_back_up = tr("The gripper moves: wait until it is done, or pause.");
    if (next.loaded && m_status.player == PlayerState::kDone && !m_grips.due(m_status.arm_cursor) && next.cursor_s >= next.duration_s - kAtEnd_s) {
      next.why_not_play = tr("The motion is done. Back up, or plan the next one.");
    }
    next.halted = next.loaded && m_status.player == PlayerState::kHalted;
    if (next.halted) next.halt_reason = QString::fromStdString(m_status.notice);
    next.why_not_stage = next.why_not_play;
    if (next.why_not_stage.isEmpty() && !nextBorder(1))
      next.why_not_stage = tr("There is no later stage on this motion.");
    next.why_not_stage_back = next.why_not_back_up;
    if (next.why_not_stage_back.isEmpty() && !nextBorder(-1))
      next.why_not_stage_back = tr("The arm stands at the start of this motion: nothing to back up.");
  } else {
    next.why_not_play = next.why_not_back_up = next.why_not_stage = next.why_not_stage_back =
        tr("There is no plan. Choose a motion first.");
  }
  next.can_play = next.why_not_play.isEmpty();
  next.can_back_up = next.why_not_back_up.isEmpty();
  if (same(next, m_state)) return;
  m_state = next;
  Q_EMIT changed();
}

// Backing up would leave behind, or tear at, what the gripper has let go of or taken there.
QString PlayController::beyondGrip() const {
  return tr("The gripper let go of or took something here (%1 of %2): the motion backs up no further. Play on, or plan from here.")
      .arg(m_grips.done())
      .arg(m_grips.size());
}

Status PlayController::confine(std::optional<double> high_s) {
  if (m_grips.empty()) return {};
  return m_runtime->confine(m_grips.low(), std::min(m_grips.high(), high_s.value_or(m_grips.high())));
}

void PlayController::beginGripper() {
  const planning::GripperStep step = *m_grips.next();
  if (const Status sent = m_runtime->setGripper(step.position); !sent) {
    m_go_on = false;
    Q_EMIT failed(QString::fromStdString(sent.error().message));
    return;
  }
  m_gripper = GripperWatch(step.position, step.grips, m_runtime->gripperPosition(), m_runtime->clock().now_s());
}

void PlayController::endGripper(const QString& sentence) {
  m_gripper.reset();
  m_go_on = false;
  Q_EMIT failed(sentence);
}

// The arm rests while the gripper moves; what it is to do begins when the arm has come to rest where it is to be done.
void PlayController::watchGripper() {
  if (m_runtime == nullptr || !m_loaded.valid()) return;
  if (m_only_held && m_runtime->clock().now_s() - m_kept_s > kHeld_s) m_go_on = false;
  if (!m_gripper) {
    const bool rests = m_status.player == PlayerState::kPaused || m_status.player == PlayerState::kDone;
    if (m_go_on && rests && !m_correction && m_grips.due(m_status.arm_cursor)) beginGripper();
    return;
  }
  if (m_status.gate.stopped) return endGripper(tr("STOP ended what the gripper did: after Reset, Play begins with it again."));
  const auto outcome = m_gripper->look(m_runtime->gripperPosition(), m_runtime->holding(), m_runtime->clock().now_s());
  if (outcome == GripperWatch::Outcome::kMoving) return;
  if (outcome == GripperWatch::Outcome::kFailed) {
    return endGripper(tr("%1 The arm holds here: look what is in its way; Play tries it again.").arg(QString::fromLatin1(m_gripper->failure())));
  }
  m_gripper.reset();
  m_grips.finish();
  if (const Status open = confine(); !open) return endGripper(QString::fromStdString(open.error().message));
  if (m_go_on) go(m_go_until);
}

Status PlayController::load() {
  if (m_loaded.valid() && m_document.plan()->id == m_loaded) return {};
  const auto joints = m_runtime->jointState();
  if (!joints) return {ErrorCode::kStale, "The robot's joints are not known yet."};
  if (const Status fresh = m_plans.checkFresh(*joints); !fresh) return fresh;
  if (const Status loaded = m_runtime->load(plan()->trajectory); !loaded) return loaded;
  m_loaded = m_document.plan()->id;
  m_grips = GripSequence(*plan());
  m_gripper.reset();
  return confine();
}

// The next end of a stage that way which the arm can still come to rest at; it needs a horizon for that.
std::optional<double> PlayController::nextBorder(double direction) const {
  if (plan() == nullptr) return std::nullopt;
  const bool loaded = m_loaded.valid() && m_document.plan()->id == m_loaded;
  constexpr double kHorizon_s = 0.22;  // and a tick
  const double needs = std::max(kAtEnd_s, kHorizon_s * std::abs(m_status.rate));
  const double here = loaded ? m_status.arm_cursor : 0;
  std::optional<double> next;
  for (const auto& stage : plan()->stages) {
    const double border = direction > 0 ? stage.end_s : stage.start_s;
    if (direction > 0 && border > here + needs && !next) next = border;
    if (direction < 0 && border < here - needs) next = border;
  }
  return next;
}

void PlayController::playStage() { move(1, nextBorder(1)); }
void PlayController::backUpStage() { move(-1, nextBorder(-1)); }

void PlayController::setOnlyHeld(bool on) {
  if (m_only_held == on) return;
  m_only_held = on;
  m_go_on = false;
  if (m_runtime != nullptr && isMoving(m_status.player)) pause();
  rebuild();
}

void PlayController::keepRunning() {
  if (m_runtime == nullptr) return;
  m_kept_s = m_runtime->clock().now_s();
  m_runtime->keepRunning();
}

void PlayController::move(double direction, std::optional<double> until_s) {
  const QString& why = direction > 0 ? m_state.why_not_play : m_state.why_not_back_up;
  if (!why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  if (const Status loaded = load(); !loaded) {
    Q_EMIT failed(QString::fromStdString(loaded.error().message));
    return;
  }
  const double size = std::abs(m_speed) < kSlowest ? 1.0 : std::abs(m_speed);
  m_status = m_runtime->status();
  setSpeed(direction * size);
  keepRunning();
  m_go_on = direction > 0;
  m_go_until = until_s;
  // Where a stop has taken the arm off the player's hands, playing takes it up again first.
  if (m_go_on && m_grips.due(m_status.arm_cursor) && m_status.player != PlayerState::kHalted) {
    if (!m_gripper) beginGripper();
    return rebuild();
  }
  go(direction > 0 ? until_s : until_s && *until_s >= m_grips.low() ? until_s : std::nullopt);
}

// As far as the gripper's next step, or `until_s`.
void PlayController::go(std::optional<double> until_s) {
  const bool beyond = m_go_on && until_s && *until_s > m_grips.high();
  if (m_go_on && until_s && !beyond) m_go_on = false;        // it rests there, whatever the gripper is to do next
  const Status played = m_runtime->play({beyond ? std::nullopt : until_s, m_only_held});
  // The arm was stopped beside the path, by its own watchdog or by hand: only a new plan starts where it is.
  if (!played && played.error().code == ErrorCode::kStale) m_off_path = QString::fromStdString(played.error().message);
  if (!played) Q_EMIT failed(QString::fromStdString(played.error().message));
  refresh(m_runtime->status());
}

void PlayController::acceptAccuracy() {
  if (!m_state.ask) return;
  m_accepted = m_document.plan()->id;
  rebuild();
}

void PlayController::play() { move(1); }
void PlayController::backUp() { move(-1); }

void PlayController::pause() {
  if (m_runtime == nullptr) return;
  m_go_on = false;
  m_runtime->pause();
  refresh(m_runtime->status());
}

void PlayController::setSpeed(double factor) {
  if (!std::isfinite(factor)) return;
  m_speed = std::clamp(factor, -2.0, 2.0);
  if (m_runtime != nullptr) m_runtime->setSpeed(m_speed);
  rebuild();
}

void PlayController::scrub(double t_s) {
  if (!m_state.can_scrub || !std::isfinite(t_s)) return;
  m_cursor = std::clamp(t_s, 0.0, m_state.duration_s);
  if (m_state.loaded) {
    const Status scrubbed = m_runtime->scrub(m_cursor);
    if (!scrubbed) Q_EMIT failed(QString::fromStdString(scrubbed.error().message));
    refresh(m_runtime->status());
  } else {
    rebuild();
  }
}

QString PlayController::whyNotCorrect() const {
  if (plan() == nullptr || !m_loaded.valid() || m_document.plan()->id != m_loaded) return tr("Corrections are made on a motion under way: press Play first.");
  if (!m_off_path.isEmpty()) return m_off_path;
  if (m_gripper || m_grips.due(m_status.arm_cursor)) return tr("The gripper has something to do here first: press Play.");
  if (m_status.player == PlayerState::kHalted) return tr("The motion was stopped: press Play first, then pause.");
  return whyNotMove();
}

void PlayController::nudge(const planning::Nudge& nudge) {
  if (const QString why = whyNotCorrect(); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  if (m_nudges.empty() && !m_planning_correction && !m_correction) m_resume = m_status.player == PlayerState::kPlaying;
  m_go_on = false;
  m_nudges.push_back(nudge);
  // A correction on its way is finished first; any other motion gives way.
  if (isMoving(m_status.player) && !m_correction) m_runtime->pause();
  refresh(m_runtime->status());
}

void PlayController::correctNext() {
  if (m_planning_correction || m_correction) return;
  const auto workcell = m_plans.workcell();
  auto context = m_plans.contextOf(QString::fromStdString(m_document.plan()->macro));
  if (!context || plan() == nullptr) return dropCorrections();
  const planning::Nudge nudge = m_nudges.front();
  m_nudges.erase(m_nudges.begin());
  m_planning_correction = true;
  m_jobs.run<planning::CorrectedPlan>(
      this,
      [workcell, context = *context, plan = *plan(), tau = m_status.arm_cursor, nudge] {
        return planning::correctPlan(context, plan, tau, nudge);
      },
      [this, id = m_document.plan()->id](Result<planning::CorrectedPlan> corrected) {
        m_planning_correction = false;
        const bool same = m_document.plan() && m_document.plan()->id == id && m_loaded == id;
        if (same)
          takeCorrection(std::move(corrected));
        else
          dropCorrections();
        rebuild();
      });
}

// The robot is given the motion only as far as the corrected pose, so that it rests there.
void PlayController::takeCorrection(Result<planning::CorrectedPlan> corrected) {
  if (!corrected) {
    dropCorrections();
    Q_EMIT failed(QString::fromStdString(corrected.error().message));
    return;
  }
  Trajectory first = corrected->plan.trajectory;
  while (first.points.back().t > corrected->reached_s + kAtEnd_s) first.points.pop_back();
  Status started = m_runtime->load(first, corrected->leave_s);
  if (started) {
    PlanRecord record = *m_document.plan();
    record.plan = corrected->plan;
    m_correction = *std::move(corrected);
    m_loaded = {};                       // so that the observer does not unload it
    m_loaded = m_document.setPlan(std::move(record));
    m_grips = GripSequence(m_correction->plan, m_grips.done());
    if (const Status held = confine(first.duration()); !held) {
      dropCorrections();
      Q_EMIT failed(QString::fromStdString(held.error().message));
      return;
    }
    m_runtime->setSpeed(std::max(kSlowest, std::abs(m_speed)));
    started = m_runtime->play();
  }
  if (!started) {
    dropCorrections();
    Q_EMIT failed(QString::fromStdString(started.error().message));
  }
  refresh(m_runtime->status());
}

void PlayController::finishCorrection() {
  const planning::CorrectedPlan done = *std::move(m_correction);
  m_correction.reset();
  const Status loaded = m_runtime->load(done.plan.trajectory, std::min(done.reached_s, done.plan.trajectory.duration()));
  if (!loaded) {
    dropCorrections();
    Q_EMIT failed(QString::fromStdString(loaded.error().message));
    return;
  }
  if (const Status held = confine(); !held) {
    dropCorrections();
    Q_EMIT failed(QString::fromStdString(held.error().message));
    return;
  }
  m_status = m_runtime->status();
  const bool more = done.reached_s < done.plan.trajectory.duration() - kAtEnd_s;
  // With hold to run the hand is on the correction, not on Play.
  if (m_nudges.empty() && std::exchange(m_resume, false) && more && !m_only_held) play();
}

void PlayController::dropCorrections() {
  m_nudges.clear();
  m_correction.reset();
  m_resume = false;
}

}  // namespace longarm::session
