#include "session/controllers/snapshot_controller.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/clock.h"
#include "core/text.h"
#include "session/commands/sketch_commands.h"

namespace longarm::session {

namespace {
constexpr std::size_t kFramesKept = 16;
}

SnapshotController::SnapshotController(Document& document, EditHistory& history, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_document(document), m_history(history), m_jobs(jobs) {
  connect(&m_timer, &QTimer::timeout, this, &SnapshotController::poll);
}

QString SnapshotController::whyNot() const {
  if (m_feed == nullptr) return tr("No robot is connected. Connect one, or open pictures from files.");
  if (!m_document.workcell()) return tr("No workcell is loaded, so that no camera is known.");
  const auto base = m_feed->base();
  if (base && !base->twist.standing()) return tr("The base is driving: let it come to rest first.");
  if (m_state != State::kIdle) return tr("Pictures are being taken.");
  return {};
}

void SnapshotController::takePair(const QString& left_camera, const QString& right_camera) {
  request({left_camera.toStdString(), right_camera.toStdString()}, PaneSide::kLeft);
}

void SnapshotController::take(const QString& camera, PaneSide side) { request({camera.toStdString()}, side); }

void SnapshotController::request(std::vector<std::string> cameras, PaneSide side) {
  if (const QString reason = whyNot(); !reason.isEmpty()) {
    Q_EMIT failed(reason);
    return;
  }
  for (const auto& camera : cameras) {
    if (m_document.workcell()->camera(camera) != nullptr) continue;
    Q_EMIT failed(tr("The workcell has no camera \"%1\".").arg(QString::fromStdString(camera)));
    return;
  }
  m_cameras = std::move(cameras);
  m_frames.assign(m_cameras.size(), {});
  m_side = side;
  m_requested_s = m_feed->now_s();
  m_refusal.clear();
  setState(State::kWaiting);
  m_timer.start(m_timing.poll_ms);
}

void SnapshotController::poll() {
  if (m_state != State::kWaiting) return;
  if (m_feed == nullptr) return fail("The robot was disconnected while a picture was being taken.");
  m_refusal.clear();
  // Odometry is not kept by time: the base must stand from the request on.
  if (const auto base = m_feed->base(); base && !base->twist.standing())
    return fail("The base began to drive while a picture was being taken.");
  collect();
  if (complete()) {
    auto chosen = choose();
    if (chosen) {
      m_timer.stop();
      const auto workcell = m_document.workcell();
      const double to_wall_s = wallTime_s() - m_feed->now_s();
      return decode(
          [workcell, to_wall_s, base = m_feed->base(), frames = std::move(*chosen)]() -> Result<Snapshots> {
            Snapshots snapshots;
            for (const auto& frame : frames) {
              auto snapshot = makeSnapshot(*workcell, frame);
              if (!snapshot) return snapshot.error();
              snapshot->wall_time_s = snapshot->stamp_s + to_wall_s;
              snapshot->base = base;
              snapshots.push_back(std::move(*snapshot));
            }
            return snapshots;
          },
          m_side);
    }
    m_refusal = chosen.error().message;
  }
  expire(m_feed->now_s() - m_requested_s);
}

void SnapshotController::collect() {
  for (std::size_t i = 0; i < m_cameras.size(); ++i) {
    const auto frame = m_feed->latestFrame(m_cameras[i]);
    if (!frame || frame->stamp_s < m_requested_s) continue;
    auto& kept = m_frames[i];
    if (!kept.empty() && kept.back().frame->stamp_s >= frame->stamp_s) continue;
    // The state at the exposure may still be on its way: ask again at the next poll.
    auto state = m_feed->jointStateAt(frame->stamp_s);
    const auto zoom = m_feed->zoomAt(m_cameras[i], frame->stamp_s);
    if (!state || !zoom || zoomMoves(m_cameras[i], frame->stamp_s, *zoom)) continue;
    kept.push_back({frame, std::move(*state), *zoom});
    if (kept.size() > kFramesKept) kept.erase(kept.begin());
  }
}

// While the lens turns, the picture and what is told of the lens are not of one instant.
bool SnapshotController::zoomMoves(const std::string& camera, double stamp_s, std::optional<double> zoom) {
  constexpr double kBefore_s = 0.1, kStill = 0.002;
  if (!zoom) return false;
  const auto before = m_feed->zoomAt(camera, stamp_s - kBefore_s);
  if (!before || !*before || std::abs(**before - *zoom) <= kStill) return false;
  m_refusal = "The zoom of " + camera + " is moving. Wait until it stands and take the picture again.";
  return true;
}

bool SnapshotController::complete() const {
  return std::all_of(m_frames.begin(), m_frames.end(), [](const auto& frames) { return !frames.empty(); });
}

Result<std::vector<StampedFrame>> SnapshotController::choose() const {
  if (m_frames.size() == 1) return std::vector<StampedFrame>{m_frames[0].back()};
  const StampedFrame *best_a = nullptr, *best_b = nullptr;
  double best = 0;
  for (const auto& a : m_frames[0]) {
    for (const auto& b : m_frames[1]) {
      const double skew = std::abs(a.frame->stamp_s - b.frame->stamp_s);
      if (best_a != nullptr && skew >= best) continue;
      best = skew;
      best_a = &a;
      best_b = &b;
    }
  }
  if (const Status fits = checkPair(*best_a, *best_b, m_timing.limits); !fits) return fits.error();
  return std::vector<StampedFrame>{*best_a, *best_b};
}

void SnapshotController::expire(double waited_s) {
  if (!m_refusal.empty() && waited_s > m_timing.settle_s) return fail(m_refusal);
  if (waited_s <= m_timing.timeout_s) return;
  for (std::size_t i = 0; i < m_cameras.size(); ++i) {
    if (!m_frames[i].empty()) continue;
    return fail("No new picture of " + m_cameras[i] + " with the robot's state came within " +
                formatFixed(m_timing.timeout_s, 0) + " s. Check the camera and the link.");
  }
  fail(m_refusal);
}

void SnapshotController::openFiles(const PictureFiles& left, const PictureFiles& right) {
  decode([left, right]() -> Result<Snapshots> {
    Snapshots snapshots;
    for (const auto& files : {left, right}) {
      auto snapshot = makeSnapshot(files);
      if (!snapshot) return snapshot.error();
      snapshots.push_back(std::move(*snapshot));
    }
    return snapshots;
  }, PaneSide::kLeft);
}

void SnapshotController::openFile(const PictureFiles& picture, PaneSide side) {
  decode([picture]() -> Result<Snapshots> {
    auto snapshot = makeSnapshot(picture);
    if (!snapshot) return snapshot.error();
    return Snapshots{std::move(*snapshot)};
  }, side);
}

void SnapshotController::openViews(const QString& views_yaml) {
  decode([path = views_yaml.toStdString()] { return makeSnapshots(path); }, PaneSide::kLeft);
}

void SnapshotController::cancel() {
  m_timer.stop();
  ++m_generation;
  setState(State::kIdle);
}

void SnapshotController::decode(std::function<Result<Snapshots>()> work, PaneSide side) {
  const int generation = ++m_generation;
  setState(State::kDecoding);
  m_jobs.run<Snapshots>(this, std::move(work), [this, generation, side](Result<Snapshots> result) {
    if (generation == m_generation) finish(std::move(result), side);
  });
}

void SnapshotController::finish(Result<Snapshots> result, PaneSide side) {
  if (!result) return fail(result.error().message);
  std::vector<SnapshotPtr> snapshots;
  std::vector<SnapshotId> ids;
  std::uint64_t next = m_document.nextSnapshotId().value;
  for (auto& snapshot : *result) {
    snapshot.id = {next++};
    ids.push_back(snapshot.id);
    snapshots.push_back(std::make_shared<const vision::Snapshot>(std::move(snapshot)));
  }
  setState(State::kIdle);
  m_history.push(addSnapshots(m_document, std::move(snapshots), side));
  Q_EMIT taken(ids);
}

void SnapshotController::fail(const std::string& sentence) {
  m_timer.stop();
  ++m_generation;
  setState(State::kIdle);
  Q_EMIT failed(QString::fromStdString(sentence));
}

void SnapshotController::setState(State state) {
  if (m_state == state) return;
  m_state = state;
  Q_EMIT stateChanged();
}

}  // namespace longarm::session
