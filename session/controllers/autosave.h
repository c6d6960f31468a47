#pragma once

/// @file
/// Autosave: writes the sketch beside the program's data soon after each change, for the day the power goes.

#include <memory>

#include <QObject>
#include <QString>
#include <QTimer>

#include "session/controllers/job_runner.h"
#include "session/document/document.h"

namespace longarm::session {

/// GUI thread only; files are written in the pool.
class Autosave final : public QObject {
  Q_OBJECT

 public:
  /// @param folder Empty: "autosave" below QStandardPaths::AppLocalDataLocation.
  Autosave(Document& document, JobRunner& jobs, const QString& folder = {}, QObject* parent = nullptr);
  ~Autosave() override;

  QString folder() const { return m_folder; }
  void setDelay(int milliseconds) { m_timer.setInterval(milliseconds); }   ///< Default 1000.
  /// Whether a sketch of an earlier run waits there.
  bool hasRecovery() const;
  /// Loads it into the document, which forgets what it had.  Clear the history afterwards.
  Status recover();
  /// Writes now, on this thread, when something changed since the last time.
  Status flush();
  /// Removes the saved sketch: it was saved elsewhere or thrown away on purpose.
  void discard();

 Q_SIGNALS:
  void saved();
  void failed(const QString& sentence);

 private:
  void save();

  Document& m_document;
  JobRunner& m_jobs;
  QString m_folder;
  QTimer m_timer;
  struct Gate;
  std::shared_ptr<Gate> m_gate;            // One writer at a time; work queued before flush or discard is void.
  bool m_dirty = false, m_saving = false;
  int m_observer = 0;
};

}  // namespace longarm::session
