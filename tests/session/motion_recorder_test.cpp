// Recording, naming, editing and keeping motions; replaying them is planning's.
#include <gtest/gtest.h>
#include <QDir>
#include <QTemporaryDir>

#include "session/controllers/motion_recorder.h"

namespace longarm::session {
namespace {

const std::vector<std::string> kJoints{"joint_1", "joint_2"};

JointState at(double a, double b) {
  return {0, {"finger", "joint_2", "joint_1"}, Eigen::Vector3d(0.04, b, a), {}};
}

class Recorder : public ::testing::Test {
 protected:
  void SetUp() override { m_recorder.open(m_folder.path(), kJoints); }
  // Out along one joint, then along the other.
  QString record() {
    EXPECT_TRUE(m_recorder.start().ok());
    for (int i = 0; i <= 100; ++i) m_recorder.take(at(0.01 * i, 0));
    for (int i = 0; i <= 100; ++i) m_recorder.take(at(1, 0.005 * i));
    const auto name = m_recorder.finish();
    EXPECT_TRUE(name.ok()) << name.error().message;
    return name.valueOr(QString());
  }
  QTemporaryDir m_folder;
  MotionRecorder m_recorder;
};

TEST_F(Recorder, KeepsOnlyTheCornersOfWhatTheArmDid) {
  const QString name = record();
  const auto* motion = m_recorder.motion(name);
  ASSERT_NE(motion, nullptr);
  ASSERT_EQ(motion->waypoints.size(), 3u);
  EXPECT_EQ(motion->waypoints[1].joints, Eigen::Vector2d(1, 0)) << "the arm's joints, in the arm's order";
  EXPECT_EQ(motion->waypoints[2].joints, Eigen::Vector2d(1, 0.5));
}

TEST_F(Recorder, AnArmThatStandsIsNoMotion) {
  EXPECT_FALSE(m_recorder.finish().ok());
  ASSERT_TRUE(m_recorder.start().ok());
  EXPECT_FALSE(m_recorder.start().ok());
  for (int i = 0; i < 50; ++i) m_recorder.take(at(0.3, 0.1));
  EXPECT_EQ(m_recorder.samples(), 1);
  EXPECT_EQ(m_recorder.finish().error().code, ErrorCode::kRefused);
  EXPECT_FALSE(m_recorder.recording());
  EXPECT_TRUE(m_recorder.motions().empty());
}

TEST_F(Recorder, IsThereAgainInTheNextRunForTheSameArmOnly) {
  record();
  ASSERT_TRUE(m_recorder.rename(QStringLiteral("Motion 1"), QStringLiteral("Over the wall")).ok());
  MotionRecorder later;
  later.open(m_folder.path(), kJoints);
  ASSERT_NE(later.motion(QStringLiteral("Over the wall")), nullptr);
  EXPECT_EQ(later.motion(QStringLiteral("Motion 1")), nullptr) << "its old file is gone";
  MotionRecorder other;
  other.open(m_folder.path(), {"axis_1", "axis_2"});
  EXPECT_TRUE(other.motions().empty());
  EXPECT_EQ(QDir(m_folder.path()).entryList(QDir::Files).size(), 1);
}

TEST_F(Recorder, TellsOfADamagedFileAndLeavesItAlone) {
  record();
  QFile broken(m_folder.filePath(QStringLiteral("recorded_broken.json")));
  ASSERT_TRUE(broken.open(QIODevice::WriteOnly));
  broken.write(
      "{\"format\": 1, \"name\": \"x\", \"joints\": [\"joint_1\"], \"waypoints\": [{\"name\": \"p\", "
      "\"positions\": [1, 2]}]}");
  broken.close();
  MotionRecorder later;
  QStringList said;
  QObject::connect(&later, &MotionRecorder::failed, &later,
                   [&said](const QString& sentence) { said << sentence; });
  later.open(m_folder.path(), kJoints);
  EXPECT_EQ(later.motions().size(), 1u);
  ASSERT_EQ(said.size(), 1);
  EXPECT_TRUE(said[0].contains(QStringLiteral("recorded_broken.json"))) << said[0].toStdString();
  EXPECT_TRUE(broken.exists());
}

TEST_F(Recorder, WayPointsAreInsertedRenamedAndDeleted) {
  const QString name = record();
  ASSERT_TRUE(m_recorder.insertWaypoint(name, 1, at(0.5, 0.2)).ok());
  EXPECT_EQ(m_recorder.motion(name)->waypoints[1].joints, Eigen::Vector2d(0.5, 0.2));
  ASSERT_TRUE(m_recorder.renameWaypoint(name, 1, QStringLiteral("beside the post")).ok());
  EXPECT_EQ(m_recorder.motion(name)->waypoints[1].name, "beside the post");
  EXPECT_FALSE(m_recorder.renameWaypoint(name, 1, QStringLiteral("  ")).ok());
  EXPECT_FALSE(m_recorder.removeWaypoint(name, 9).ok());
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(m_recorder.removeWaypoint(name, 0).ok());
  EXPECT_EQ(m_recorder.removeWaypoint(name, 0).error().code, ErrorCode::kRefused) << "one stays";
  MotionRecorder later;
  later.open(m_folder.path(), kJoints);
  EXPECT_EQ(later.motion(name)->waypoints.size(), 1u) << "each change is kept at once";
  ASSERT_TRUE(m_recorder.remove(name).ok());
  EXPECT_TRUE(QDir(m_folder.path()).entryList(QDir::Files).isEmpty());
}

TEST_F(Recorder, TwoMotionsCannotShareAFile) {
  record();
  record();
  EXPECT_EQ(m_recorder.rename(QStringLiteral("Motion 2"), QStringLiteral("motion-1")).error().code,
            ErrorCode::kRefused);
  EXPECT_FALSE(m_recorder.rename(QStringLiteral("Motion 2"), QString()).ok());
  EXPECT_NE(m_recorder.motion(QStringLiteral("Motion 2")), nullptr);
}

}  // namespace
}  // namespace longarm::session
