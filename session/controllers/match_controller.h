#pragma once

/// @file
/// MatchController: looks for matches of what was just picked, off the GUI thread.

#include <vector>

#include <QObject>

#include "session/controllers/job_runner.h"
#include "session/controllers/targeting_controller.h"

namespace longarm::session {

/// Watches what the tool wishes and hands it what is found.  One search at a time, so that nudging a handle does not fill
/// the pool; what was found stays known for as long as it may be wished again (undo).  GUI thread only.
class MatchController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; both outlive this.
  MatchController(TargetingController& targeting, JobRunner& jobs, QObject* parent = nullptr);

  bool searching() const { return m_searching; }

 Q_SIGNALS:
  void found();                            ///< A search ended.

 private:
  void refresh();
  bool known(const MatchWish& wish) const;
  void search(const MatchWish& wish);
  void arrived(const MatchWish& wish, Result<std::vector<vision::Match>> matches);

  TargetingController& m_targeting;
  JobRunner& m_jobs;
  std::vector<MatchHelp> m_known;          // Oldest first.
  bool m_searching = false, m_refreshing = false;
};

}  // namespace longarm::session
