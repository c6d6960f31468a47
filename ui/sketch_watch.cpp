#include "ui/sketch_watch.h"

#include <algorithm>

#include "session/tools/baseline_watch.h"
#include "session/tools/calibration_watch.h"

namespace longarm::ui {

namespace {

const QString kKey = QStringLiteral("calibration"), kBaselineKey = QStringLiteral("baseline"),
              kStaleKey = QStringLiteral("stale"), kOnRobotKey = QStringLiteral("own-link");

}  // namespace

SketchWatch::SketchWatch(Workbench& bench, NoticeBar& notices, QObject* parent)
    : QObject(parent), m_bench(bench), m_notices(notices) {
  connect(&m_bench.targeting(), &session::TargetingController::featuresChanged, this, &SketchWatch::refresh);
  connect(&m_bench.targeting(), &session::TargetingController::featuresChanged, this,
          &SketchWatch::refreshStale);
  connect(&m_bench.world(), &session::WorldController::changed, this, &SketchWatch::refreshStale);
  connect(&m_bench.targeting(), &session::TargetingController::panesChanged, this, &SketchWatch::refreshBaseline);
  connect(&m_bench.targeting(), &session::TargetingController::featuresChanged, this, &SketchWatch::refreshOnRobot);
  connect(&m_bench.targeting(), &session::TargetingController::panesChanged, this, &SketchWatch::refreshOnRobot);
  refresh();
  refreshBaseline();
}

void SketchWatch::refreshOnRobot() {
  const auto picks = session::picksOnRobot(m_bench.document(), m_bench.targeting().ownLinks());
  const QString text = picks.empty() ? QString() : QString::fromStdString(session::onRobotText(m_bench.document(), picks.front()));
  if (text == m_on_robot_said) return;
  m_on_robot_said = text;
  if (text.isEmpty()) return m_notices.clear(kOnRobotKey);
  const FeatureId id = picks.front().item;
  const auto advice = m_bench.adviser().advise(id);
  std::vector<NoticeAnswer> answers;
  if (advice && !advice->already_shown) {
    answers.push_back({advice->snapshot.valid() ? tr("Show it") : tr("Take it"), [this, id] { m_bench.showClearestView(id); }});
  }
  answers.push_back({tr("Select it"), [this, id] { m_bench.targeting().select(id); }});
  answers.push_back({tr("Understood"), {}});
  m_notices.post(kOnRobotKey, text + QLatin1Char(' ') + QString::fromStdString(advice ? advice->text : advice.error().message), answers);
}

// Told when the pair comes into the panes, before anything is picked in it.
void SketchWatch::refreshBaseline() {
  const auto left = m_bench.document().paneSnapshot(vision::PaneSide::kLeft), right = m_bench.document().paneSnapshot(vision::PaneSide::kRight);
  const QString text = left && right && left != right ? QString::fromStdString(session::baselineWarning(left->view, right->view)) : QString();
  if (text == m_baseline_said) return;
  m_baseline_said = text;
  if (text.isEmpty()) return m_notices.clear(kBaselineKey);
  m_notices.post(kBaselineKey, text, {{tr("Understood"), {}}});
}

// Told again whenever another mark has been made.
void SketchWatch::refreshStale() {
  const auto& document = m_bench.document();
  const auto features = std::count_if(document.items().begin(), document.items().end(),
                                      [&](const auto& item) { return document.measurement(item.id).stale; });
  const auto bodies = std::count_if(document.world().begin(), document.world().end(),
                                    [&](const auto& body) { return document.stale(body); });
  QString text;
  const QString why = features + bodies > 0 ? m_bench.whyNotReregister() : QString();
  if (features + bodies > 0) {
    text = tr("The base was driven: %1 features and %2 bodies are stale. %3")
               .arg(features)
               .arg(bodies)
               .arg(why.isEmpty() ? tr("Enough corners are marked again to move them.") : why);
  }
  if (text == m_stale_said) return;
  m_stale_said = text;
  if (text.isEmpty()) return m_notices.clear(kStaleKey);
  std::vector<NoticeAnswer> answers;
  if (why.isEmpty()) answers.push_back({tr("Re-register"), [this] { m_bench.reregister(); }});
  answers.push_back({tr("Understood"), {}});
  m_notices.post(kStaleKey, text, answers);
}

void SketchWatch::refresh() {
  const auto concern = session::calibrationConcern(m_bench.document());
  const QString text = QString::fromStdString(session::calibrationWarning(m_bench.document(), concern));
  if (text == m_said) return;
  m_said = text;
  if (text.isEmpty()) return m_notices.clear(kKey);
  std::vector<NoticeAnswer> answers;
  if (!concern.off.empty()) {
    const FeatureId id = concern.off.front().item;
    answers.push_back({tr("Select it"), [this, id] { m_bench.targeting().select(id); }});
  }
  answers.push_back({tr("Understood"), {}});
  m_notices.post(kKey, text, answers);
}

}  // namespace longarm::ui
