#include "session/controllers/job_runner.h"

#include <QMetaObject>
#include <QRunnable>
#include <QThreadPool>

#include "core/log.h"

namespace longarm::session {

namespace {

/// Lives on the GUI thread and hands results over: it outlives every job, a context object may not.
class Courier final : public QObject {
 public:
  /// Any thread.
  void post(std::function<void()> call) {
    QMetaObject::invokeMethod(this, [call = std::move(call)] { barrier(call); }, Qt::QueuedConnection);
  }

 private:
  static void barrier(const std::function<void()>& call) {
    try {
      call();
    } catch (const std::exception& problem) {
      logLine(LogLevel::kError, "session.jobs", std::string("delivering a result failed: ") + problem.what());
    }
  }
};

class Job final : public QRunnable {
 public:
  explicit Job(std::function<void()> work) : m_work(std::move(work)) {}
  void run() override { m_work(); }

 private:
  std::function<void()> m_work;
};

}  // namespace

struct JobRunner::Impl {
  Courier courier;
  QThreadPool pool;
};

JobRunner::JobRunner(int threads) : m_impl(std::make_unique<Impl>()) {
  m_impl->pool.setMaxThreadCount(threads < 1 ? 1 : threads);
}

JobRunner::~JobRunner() {
  m_impl->pool.clear();
  m_impl->pool.waitForDone();
}

void JobRunner::start(QObject* context, std::function<void()> work, std::function<void()> deliver) {
  Courier* courier = &m_impl->courier;
  // The pointer is made and read on the GUI thread only; the job merely carries it.
  auto guard = std::make_shared<QPointer<QObject>>(context);
  m_impl->pool.start(new Job([courier, guard, work = std::move(work), deliver = std::move(deliver)] {
    work();
    courier->post([guard, deliver] {
      if (!guard->isNull()) deliver();
    });
  }));
}

void JobRunner::wait() { m_impl->pool.waitForDone(); }

}  // namespace longarm::session
