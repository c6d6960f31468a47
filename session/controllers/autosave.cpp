#include "session/controllers/autosave.h"

#include <filesystem>
#include <mutex>

#include <QStandardPaths>

#include "session/document/document_file.h"

namespace longarm::session {

namespace {

bool touchesSketch(ChangeKind kind) {
  return kind != ChangeKind::kSelectionChanged && kind != ChangeKind::kPlanChanged &&
         kind != ChangeKind::kWorkcellChanged;
}

QString defaultFolder() {
  return QStandardPaths::writableLocation(QStandardPaths::AppLocalDataLocation) + QStringLiteral("/autosave");
}

}  // namespace

struct Autosave::Gate {
  std::mutex mutex;
  int epoch = 0;                           // Guarded by mutex.
};

Autosave::Autosave(Document& document, JobRunner& jobs, const QString& folder, QObject* parent)
    : QObject(parent), m_document(document), m_jobs(jobs), m_folder(folder.isEmpty() ? defaultFolder() : folder),
      m_gate(std::make_shared<Gate>()) {
  m_timer.setSingleShot(true);
  m_timer.setInterval(1000);
  connect(&m_timer, &QTimer::timeout, this, &Autosave::save);
  m_observer = m_document.observe([this](const Change& change) {
    if (!touchesSketch(change.kind)) return;
    m_dirty = true;
    // Not restarted: a steady stream of changes must not put off saving for ever.
    if (!m_timer.isActive()) m_timer.start();
  });
}

Autosave::~Autosave() { m_document.unobserve(m_observer); }

void Autosave::save() {
  if (!m_dirty) return;
  if (m_saving) {
    m_timer.start();
    return;
  }
  m_dirty = false;
  m_saving = true;
  // The state is a value whose pictures never change: the pool may write it while the sketch goes on.
  m_jobs.run<int>(
      this,
      [gate = m_gate, epoch = m_gate->epoch, folder = m_folder.toStdString(),
       state = m_document.state()]() -> Result<int> {
        const std::lock_guard<std::mutex> lock(gate->mutex);
        if (gate->epoch != epoch) return 0;
        const Status status = saveSketch(folder, state);
        if (!status) return status.error();
        return 0;
      },
      [this](Result<int> result) {
        m_saving = false;
        if (result) {
          Q_EMIT saved();
        } else {
          m_dirty = true;
          Q_EMIT failed(QString::fromStdString(result.error().message));
        }
      });
}

Status Autosave::flush() {
  m_timer.stop();
  const std::lock_guard<std::mutex> lock(m_gate->mutex);
  if (!m_dirty && !m_saving) return {};
  ++m_gate->epoch;
  const Status status = saveSketch(m_folder.toStdString(), m_document.state());
  if (status) m_dirty = false;
  return status;
}

bool Autosave::hasRecovery() const {
  std::error_code error;
  return std::filesystem::exists(std::filesystem::path(m_folder.toStdString()) / kSketchFileName, error);
}

Status Autosave::recover() {
  auto state = loadSketch(m_folder.toStdString());
  if (!state) return state.error();
  m_document.reset(std::move(*state));
  m_timer.stop();
  m_dirty = false;
  return {};
}

void Autosave::discard() {
  m_timer.stop();
  const std::lock_guard<std::mutex> lock(m_gate->mutex);
  ++m_gate->epoch;
  m_dirty = false;
  std::error_code error;
  std::filesystem::remove(std::filesystem::path(m_folder.toStdString()) / kSketchFileName, error);
}

}  // namespace longarm::session
