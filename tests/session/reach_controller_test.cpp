// Reach while a feature is dragged: the newest wins, nothing blocks, other kinds are forgotten.
#include <QCoreApplication>
#include <QElapsedTimer>
#include <QObject>
#include <gtest/gtest.h>

#include "session/controllers/reach_controller.h"
#include "tests/session/event_loop.h"

namespace longarm::session {
namespace {

using Level = planning::ReachAnswer::Level;

class ReachControllerTest : public longarm::testing::EventLoopTest {
 protected:
  void SetUp() override {
    auto workcell = planning::loadBuiltInWorkcell();
    ASSERT_TRUE(workcell.ok()) << workcell.error().message;
    m_document.setWorkcell(std::make_shared<const planning::Workcell>(*std::move(workcell)));
    auto joints = std::make_shared<JointState>();
    for (const auto& [name, value] : m_document.workcell()->poses.at("ready")) {
      joints->names.push_back(name);
      joints->positions.conservativeResize(static_cast<Eigen::Index>(joints->names.size()));
      joints->positions[joints->positions.size() - 1] = value;
    }
    m_joints = joints;
    m_plans.setJointSource([this] { return m_joints; });
    m_reach.setBudget(60);               // a loaded machine must not change the answer
    QObject::connect(&m_reach, &ReachController::changed, &m_reach, [this] { ++m_changes; });
  }

  static vision::Feature point(double x) {
    vision::Feature feature;
    feature.kind = vision::FeatureKind::kPoint;
    feature.vertices.resize(1);
    feature.vertices[0].xyz = {x, 0.1, 0.45};
    return feature;
  }
  void waitFor(int changes) {
    QElapsedTimer since;
    since.start();
    while (m_changes < changes && since.elapsed() < 120000) QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
    ASSERT_GE(m_changes, changes);
  }
  Level level(const char* macro) const { return m_reach.answer(QString::fromLatin1(macro)).level; }

  Document m_document;
  JobRunner m_jobs;
  std::shared_ptr<const JointState> m_joints;
  PlanController m_plans{m_document, m_jobs};
  ReachController m_reach{m_plans, m_jobs};
  int m_changes = 0;
};

TEST_F(ReachControllerTest, AnswersForEveryMacroThatTakesTheKind) {
  EXPECT_EQ(level("touch"), Level::kUnknown);
  m_reach.setFeature(point(0.75));
  waitFor(1);
  EXPECT_NE(level("touch"), Level::kNot) << m_reach.answer(QStringLiteral("touch")).reason;
  EXPECT_NE(level("look_at"), Level::kUnknown);
  EXPECT_EQ(level("grab_pipe"), Level::kUnknown) << "takes a line";
  m_reach.setFeature({});
  EXPECT_EQ(level("touch"), Level::kUnknown);
}

TEST_F(ReachControllerTest, LooksAtTheNewestAndSkipsWhatWasPassedOver) {
  for (int i = 0; i < 50; ++i) m_reach.setFeature(point(0.6 + 0.002 * i));
  m_reach.setFeature(point(5));
  waitFor(2);
  EXPECT_EQ(level("touch"), Level::kNot) << "the last one is out of reach";
  for (int i = 0; i < 20; ++i) QCoreApplication::processEvents(QEventLoop::AllEvents, 10);
  EXPECT_EQ(m_changes, 2) << "the first and the last";
}

TEST_F(ReachControllerTest, IsSilentWhileTheJointsAreUnknown) {
  m_joints.reset();
  m_reach.setFeature(point(0.75));
  for (int i = 0; i < 20; ++i) QCoreApplication::processEvents(QEventLoop::AllEvents, 10);
  EXPECT_EQ(m_changes, 0);
}

}  // namespace
}  // namespace longarm::session
