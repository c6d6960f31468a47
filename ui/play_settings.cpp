#include "ui/play_settings.h"

namespace longarm::ui {

namespace {

const QString kHold = QStringLiteral("play/hold_to_run"), kAuto = QStringLiteral("play/at_once");

}  // namespace

PlaySettings::PlaySettings(Workbench& bench, Actions& actions, QSettings& settings, QObject* parent)
    : QObject(parent), m_bench(bench), m_actions(actions) {
  m_bench.hand().setHoldToRun(settings.value(kHold, false).toBool());
  m_bench.setAutoPlay(settings.value(kAuto, false).toBool());
  connect(m_actions.at(ActionId::kHoldToRun), &QAction::triggered, this, [this, &settings](bool on) {
    m_bench.hand().setHoldToRun(on);
    settings.setValue(kHold, on);
    if (on) m_bench.say(tr("Hold to run: the arm moves only while Play, Back up or their key is held."));
  });
  connect(m_actions.at(ActionId::kAutoPlay), &QAction::triggered, this, [this, &settings](bool on) {
    m_bench.setAutoPlay(on);
    settings.setValue(kAuto, on);
    if (on) m_bench.say(tr("Auto-play: a motion planned by its button moves the arm at once, without Play."));
  });
  connect(&m_bench.hand(), &session::PlayHand::changed, this, &PlaySettings::refresh);
  connect(&m_bench, &Workbench::autoPlayChanged, this, &PlaySettings::refresh);
  refresh();
}

void PlaySettings::refresh() {
  m_actions.at(ActionId::kHoldToRun)->setChecked(m_bench.hand().holdToRun());
  m_actions.at(ActionId::kAutoPlay)->setChecked(m_bench.autoPlay());
}

}  // namespace longarm::ui
