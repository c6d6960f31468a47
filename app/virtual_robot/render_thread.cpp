#include "app/virtual_robot/render_thread.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <exception>

#include "core/clock.h"

namespace longarm::virtual_robot {
namespace {

constexpr int kNiceness = 5;            // joint states come first; threads of the GL library inherit it

void lowerPriority() { (void)setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNiceness); }

}  // namespace

RenderThread::RenderThread(planning::Workcell workcell, planning::Scenario scenario, bool behind,
                           std::function<void(Picture)> deliver, std::function<void(std::string)> failed)
    : m_workcell(std::move(workcell)),
      m_scenario(std::move(scenario)),
      m_behind(behind),
      m_deliver(std::move(deliver)),
      m_failed(std::move(failed)) {}

RenderThread::~RenderThread() {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_end = true;
  }
  m_changed.notify_all();
  if (m_thread.joinable()) m_thread.join();
}

void RenderThread::request(PictureRequest request) {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (!m_thread.joinable()) m_thread = std::thread([this] { run(); });
  m_next = std::move(request);
  m_changed.notify_all();
}

bool RenderThread::idle() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return !m_busy && !m_next;
}

void RenderThread::finish() {
  std::unique_lock<std::mutex> lock(m_mutex);
  m_changed.wait(lock, [this] { return !m_busy && !m_next; });
}

double RenderThread::lastDuration_s() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_duration_s;
}

void RenderThread::complain(const std::string& what) {
  if (what == m_complaint) return;
  m_complaint = what;
  m_failed(what);
}

void RenderThread::work(PictureMaker* maker, const PictureRequest& request) {
  if (maker == nullptr) return;
  try {
    for (const auto& order : request.orders) {
      auto picture = maker->take(request.world, order);
      if (picture) m_deliver(std::move(*picture));
      if (!picture) complain(picture.error().message);
    }
  } catch (const std::exception& e) {
    complain(std::string("rendering failed: ") + e.what());
  }
}

void RenderThread::run() {
  if (m_behind) lowerPriority();
  auto maker = PictureMaker::create(m_workcell, m_scenario);
  if (!maker) complain(maker.error().message);
  const SteadyClock clock;
  std::unique_lock<std::mutex> lock(m_mutex);
  while (!m_end) {
    if (!m_next) {
      m_changed.wait(lock);
      continue;
    }
    const PictureRequest request = std::move(*m_next);
    m_next.reset();
    m_busy = true;
    lock.unlock();
    const double start_s = clock.now_s();
    work(maker ? maker->get() : nullptr, request);
    lock.lock();
    m_duration_s = clock.now_s() - start_s;
    m_busy = false;
    m_changed.notify_all();
  }
}

}  // namespace longarm::virtual_robot
