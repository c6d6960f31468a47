#include "session/controllers/motion_recorder.h"

#include <algorithm>
#include <utility>

#include <QDir>

namespace longarm::session {

namespace {

constexpr double kLeastStep = 0.002;  // between two samples, in some joint [rad or m]
constexpr double kThin = 5e-4;        // [rad or m]
constexpr std::size_t kMostSamples = 20000;

Status noMotion(const QString& name) {
  return {ErrorCode::kNotFound, "There is no recorded motion \"" + name.toStdString() + "\"."};
}

}  // namespace

MotionRecorder::MotionRecorder(QObject* parent) : QObject(parent) {}

void MotionRecorder::open(const QString& folder, const std::vector<std::string>& joints) {
  m_folder = folder;
  m_joints = joints;
  m_motions.clear();
  cancel();
  const QDir files(folder);
  for (const auto& file : files.entryList({QStringLiteral("recorded_*.json")}, QDir::Files, QDir::Name)) {
    auto motion = planning::readRecordedMotion(files.filePath(file).toStdString());
    if (!motion) {
      Q_EMIT failed(QString::fromStdString(motion.error().message));
    } else if (motion->joint_names == m_joints) {
      m_motions.push_back(std::move(*motion));
    }
  }
  Q_EMIT changed();
}

int MotionRecorder::indexOf(const QString& name) const {
  for (std::size_t i = 0; i < m_motions.size(); ++i) {
    if (m_motions[i].name == name.toStdString()) return static_cast<int>(i);
  }
  return -1;
}

const planning::RecordedMotion* MotionRecorder::motion(const QString& name) const {
  const int index = indexOf(name);
  return index < 0 ? nullptr : &m_motions[static_cast<std::size_t>(index)];
}

QString MotionRecorder::fileOf(const planning::RecordedMotion& motion) const {
  return QDir(m_folder).filePath(QString::fromStdString(planning::macroName(motion)) +
                                 QStringLiteral(".json"));
}

// Two names may make one file.
bool MotionRecorder::taken(const planning::RecordedMotion& motion, int except) const {
  for (std::size_t i = 0; i < m_motions.size(); ++i) {
    if (static_cast<int>(i) != except && planning::macroName(m_motions[i]) == planning::macroName(motion))
      return true;
  }
  return false;
}

Result<Eigen::VectorXd> MotionRecorder::jointsOf(const JointState& state) const {
  return state.positionsOf(m_joints);
}

Status MotionRecorder::start() {
  if (m_recording) return {ErrorCode::kRefused, "A motion is being recorded already."};
  if (m_joints.empty()) return {ErrorCode::kRefused, "No arm is known yet."};
  m_samples.clear();
  m_recording = true;
  Q_EMIT recordingChanged();
  return {};
}

void MotionRecorder::take(const JointState& state) {
  if (!m_recording) return;
  const auto joints = jointsOf(state);
  if (!joints) return;
  if (!m_samples.empty() && (*joints - m_samples.back()).cwiseAbs().maxCoeff() < kLeastStep) return;
  m_samples.push_back(*joints);
  if (m_samples.size() < kMostSamples) return;
  if (const auto done = finish(); !done) Q_EMIT failed(QString::fromStdString(done.error().message));
}

void MotionRecorder::cancel() {
  if (!std::exchange(m_recording, false)) return;
  m_samples.clear();
  Q_EMIT recordingChanged();
}

Result<QString> MotionRecorder::finish() {
  if (!m_recording) return Error{ErrorCode::kRefused, "Nothing is being recorded."};
  const auto points = planning::thinned(std::exchange(m_samples, {}), kThin);
  m_recording = false;
  Q_EMIT recordingChanged();
  if (points.size() < 2)
    return Error{ErrorCode::kRefused,
                 "The arm has not moved: nothing was recorded. Jog or play while recording."};
  planning::RecordedMotion motion;
  motion.joint_names = m_joints;
  for (int number = 1; motion.name.empty() || taken(motion, -1); ++number)
    motion.name = "Motion " + std::to_string(number);
  for (const auto& q : points)
    motion.waypoints.push_back({"Point " + std::to_string(motion.waypoints.size() + 1), q});
  const QString name = QString::fromStdString(motion.name);
  m_motions.push_back({});
  if (const Status kept = replace(static_cast<int>(m_motions.size()) - 1, std::move(motion)); !kept) {
    m_motions.pop_back();
    return kept.error();
  }
  return name;
}

Status MotionRecorder::replace(int index, planning::RecordedMotion after) {
  if (const Status good = planning::validate(after); !good) return good;
  if (taken(after, index))
    return {ErrorCode::kRefused, "Another recorded motion has that name, or one too like it."};
  QDir().mkpath(m_folder);
  if (const Status written = planning::writeRecordedMotion(fileOf(after).toStdString(), after); !written)
    return written;
  auto& kept = m_motions[static_cast<std::size_t>(index)];
  if (!kept.name.empty() && fileOf(kept) != fileOf(after)) QFile::remove(fileOf(kept));
  kept = std::move(after);
  Q_EMIT changed();
  return {};
}

Status MotionRecorder::rename(const QString& name, const QString& wanted) {
  const int index = indexOf(name);
  if (index < 0) return noMotion(name);
  auto after = m_motions[static_cast<std::size_t>(index)];
  after.name = wanted.trimmed().toStdString();
  return replace(index, std::move(after));
}

Status MotionRecorder::remove(const QString& name) {
  const int index = indexOf(name);
  if (index < 0) return noMotion(name);
  QFile::remove(fileOf(m_motions[static_cast<std::size_t>(index)]));
  m_motions.erase(m_motions.begin() + index);
  Q_EMIT changed();
  return {};
}

Status MotionRecorder::renameWaypoint(const QString& name, int at, const QString& wanted) {
  const int index = indexOf(name);
  if (index < 0) return noMotion(name);
  auto after = m_motions[static_cast<std::size_t>(index)];
  if (at < 0 || at >= static_cast<int>(after.waypoints.size()) || wanted.trimmed().isEmpty()) {
    return {ErrorCode::kInvalidInput, "A way-point needs a name."};
  }
  after.waypoints[static_cast<std::size_t>(at)].name = wanted.trimmed().left(60).toStdString();
  return replace(index, std::move(after));
}

Status MotionRecorder::removeWaypoint(const QString& name, int at) {
  const int index = indexOf(name);
  if (index < 0) return noMotion(name);
  auto after = m_motions[static_cast<std::size_t>(index)];
  if (at < 0 || at >= static_cast<int>(after.waypoints.size()))
    return {ErrorCode::kNotFound, "Select a way-point first."};
  if (after.waypoints.size() == 1)
    return {ErrorCode::kRefused, "A motion keeps one way-point at least; delete the motion instead."};
  after.waypoints.erase(after.waypoints.begin() + at);
  return replace(index, std::move(after));
}

Status MotionRecorder::insertWaypoint(const QString& name, int at, const JointState& state) {
  const int index = indexOf(name);
  if (index < 0) return noMotion(name);
  const auto joints = jointsOf(state);
  if (!joints) return joints.error();
  auto after = m_motions[static_cast<std::size_t>(index)];
  at = std::clamp(at, 0, static_cast<int>(after.waypoints.size()));
  after.waypoints.insert(after.waypoints.begin() + at, {"Inserted " + std::to_string(at + 1), *joints});
  return replace(index, std::move(after));
}

}  // namespace longarm::session
