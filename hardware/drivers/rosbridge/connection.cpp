#include "hardware/drivers/rosbridge/connection.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <QThread>
#include <nlohmann/json.hpp>

#include "core/log.h"
#include "core/text.h"
#include "hardware/drivers/rosbridge/outbox.h"
#include "hardware/drivers/rosbridge/socket_worker.h"

namespace longarm::hardware {
namespace {

using rosbridge::Operation;

constexpr const char* kCategory = "longarm.hardware.rosbridge";
constexpr int kGarbageLimit = 50;        // Frames in a row that cannot be read: not a rosbridge server.
constexpr double kComplaint_s = 1;       // At most one complaint in this time.

struct Subscription {
  rosbridge::Subscribe what;
  Connection::Handler handler;
};

// One call that waits for its answer.
struct Call {
  std::optional<Result<rosbridge::Body>> answer;
};

}  // namespace

struct Connection::Impl final : SocketOwner {
  const ConnectionSettings settings;
  const Clock& clock;
  const SteadyClock steady;
  const std::string heartbeat;           // encoded once
  const std::string heartbeat_advertisement;

  std::mutex life_mutex;                 // One start or end at a time.
  std::unique_ptr<QThread> thread;

  std::mutex mutex;                      // Guards what follows; held while callbacks run.
  std::uint64_t next_id = 1;
  std::map<std::uint64_t, Events> listeners;
  std::map<std::uint64_t, Subscription> subscriptions;
  std::map<std::string, std::string> advertised;   // topic -> type
  int garbage = 0;                       // Unreadable frames in a row.
  double complained_s = -1e9;

  // Leaf lock: nothing is called under it but the waking of the thread.
  std::mutex out_mutex;
  Outbox outbox;
  SocketWorker* worker = nullptr;

  std::mutex call_mutex;
  std::condition_variable call_changed;
  std::map<std::string, Call> calls;
  std::uint64_t call_count = 0;
  std::atomic<int> calls_waiting{0};

  std::atomic<bool> is_up{false}, was_up{false}, knows_dialect{false};
  std::atomic<rosbridge::Dialect> dialect{rosbridge::Dialect::kRos1};
  std::atomic<double> next_heartbeat_s{0};   // Connection's thread only.

  Impl(ConnectionSettings s, const Clock& c)
      : settings(std::move(s)),
        clock(c),
        heartbeat(rosbridge::encodeText(rosbridge::publish(settings.heartbeat_topic, rosbridge::EmptyMessage{}))),
        heartbeat_advertisement(rosbridge::encodeText(
            rosbridge::Advertise{settings.heartbeat_topic, rosbridge::EmptyMessage::kType, {}})),
        outbox(settings.mailbox) {}

  void start();
  void finish() noexcept;
  void onOpened() noexcept override;
  void onClosed(const std::string& why) noexcept override;
  void onFrame(std::string_view bytes, bool binary) noexcept override;
  void onTurn() noexcept override;
  bool awaitsAnswer() const noexcept override { return calls_waiting > 0; }

  void take(const Operation& operation, double received_s);
  void deliver(const rosbridge::Publish& message, double received_s);
  void answer(const rosbridge::ServiceResponse& response);
  void complain(const Error& error);
  void learnDialect(const rosbridge::Body& message);
  void beat();
  void wakeLocked() {
    if (worker != nullptr) worker->wake();
  }
  Error down() const { return {ErrorCode::kDisconnected, "no link to " + settings.url}; }
  Status push(const Operation& operation, bool motion);
};

void Connection::Impl::start() {
  ensureApplication();
  auto* made = new SocketWorker(settings, *this);
  thread = std::make_unique<QThread>();
  thread->setObjectName(QStringLiteral("rosbridge"));
  made->moveToThread(thread.get());
  {
    std::lock_guard<std::mutex> lock(out_mutex);
    worker = made;
  }
  QObject::connect(thread.get(), &QThread::started, made, [made] { made->begin(); });
  QObject::connect(thread.get(), &QThread::finished, made, [made] { made->end(); }, Qt::DirectConnection);
  thread->start();
}

void Connection::Impl::finish() noexcept {
  if (!thread) return;
  thread->quit();
  thread->wait();
  SocketWorker* ended = nullptr;
  {
    std::lock_guard<std::mutex> lock(out_mutex);
    std::swap(ended, worker);
    outbox.clear();
  }
  delete ended;                          // its thread is over: nothing of it runs
  thread.reset();
  is_up = false;
  was_up = false;
  call_changed.notify_all();
}

void Connection::Impl::onOpened() noexcept {
  try {
    std::lock_guard<std::mutex> lock(mutex);
    {
      std::lock_guard<std::mutex> out_lock(out_mutex);
      outbox.clear();
    }
    garbage = 0;
    worker->write(heartbeat_advertisement);
    for (const auto& [topic, type] : advertised) {
      worker->write(rosbridge::encodeText(rosbridge::Advertise{topic, type, {}}));
    }
    for (const auto& [id, subscription] : subscriptions) worker->write(rosbridge::encodeText(subscription.what));
    {
      std::lock_guard<std::mutex> call_lock(call_mutex);
      is_up = true;
      was_up = true;
    }
    call_changed.notify_all();
    next_heartbeat_s = 0;
    logLine(LogLevel::kInfo, kCategory, "connected to " + settings.url);
    for (const auto& [id, listener] : listeners) {
      if (listener.up) listener.up();
    }
  } catch (const std::exception& e) {
    logLine(LogLevel::kError, kCategory, std::string("connecting: ") + e.what());
  }
}

void Connection::Impl::onClosed(const std::string& why) noexcept {
  try {
    std::lock_guard<std::mutex> lock(mutex);
    {
      std::lock_guard<std::mutex> call_lock(call_mutex);
      is_up = false;
      for (auto& [id, call] : calls) {
        call.answer = Error{ErrorCode::kDisconnected, "the link to " + settings.url + " was lost: " + why};
      }
    }
    call_changed.notify_all();
    {
      std::lock_guard<std::mutex> out_lock(out_mutex);
      outbox.clear();
    }
    const Error error{ErrorCode::kDisconnected,
                      std::string(was_up ? "the link to " : "no link to ") + settings.url +
                          (was_up ? " was lost: " : " yet: ") + why + "; it is tried again"};
    for (const auto& [id, listener] : listeners) {
      if (listener.down) listener.down(error);
    }
  } catch (const std::exception& e) {
    logLine(LogLevel::kError, kCategory, std::string("losing the link: ") + e.what());
  }
}

void Connection::Impl::onFrame(std::string_view bytes, bool binary) noexcept {
  const double received_s = clock.now_s();
  try {
    const auto operation = binary ? rosbridge::decodeBinary(bytes) : rosbridge::decodeText(bytes);
    std::lock_guard<std::mutex> lock(mutex);
    if (operation) {
      garbage = 0;
      take(*operation, received_s);
    } else if (++garbage == kGarbageLimit) {
      const Error error{ErrorCode::kInvalidInput,
                        settings.url + " does not speak rosbridge: " + std::to_string(kGarbageLimit) +
                            " messages in a row could not be read, the last: " + operation.error().message +
                            ". Check the address in the workcell"};
      for (const auto& [id, listener] : listeners) {
        if (listener.fault) listener.fault(error);
      }
    } else {
      complain(operation.error());
    }
  } catch (const std::exception& e) {
    logLine(LogLevel::kError, kCategory, std::string("a message: ") + e.what());
  }
}

// `mutex` is held in these four.
void Connection::Impl::take(const Operation& operation, double received_s) {
  if (const auto* message = std::get_if<rosbridge::Publish>(&operation)) {
    deliver(*message, received_s);
  } else if (const auto* response = std::get_if<rosbridge::ServiceResponse>(&operation)) {
    answer(*response);
  } else if (const auto* report = std::get_if<rosbridge::StatusReport>(&operation)) {
    if (report->level == "error" || report->level == "warning") {
      complain({ErrorCode::kRefused, "the robot's bridge says: " + report->text.substr(0, 400)});
    }
  }
}

void Connection::Impl::deliver(const rosbridge::Publish& message, double received_s) {
  if (!knows_dialect) learnDialect(message.message);
  for (const auto& [id, subscription] : subscriptions) {
    if (subscription.what.topic != message.topic) continue;
    if (auto status = subscription.handler(message, received_s); !status) {
      complain({status.error().code, message.topic + ": " + status.error().message});
    }
  }
}

void Connection::Impl::learnDialect(const rosbridge::Body& message) {
  const auto& json = message.json();
  if (!json.is_object() || !json.contains("header") || !json["header"].is_object()) return;
  const auto& header = json["header"];
  if (!header.contains("stamp") || !header["stamp"].is_object()) return;
  knows_dialect = true;
  if (header["stamp"].contains("nanosec")) dialect = rosbridge::Dialect::kRos2;
}

void Connection::Impl::complain(const Error& error) {
  const double now_s = steady.now_s();
  if (now_s - complained_s < kComplaint_s) return;
  complained_s = now_s;
  if (!listeners.empty() && listeners.begin()->second.trouble) listeners.begin()->second.trouble(error);
}

void Connection::Impl::answer(const rosbridge::ServiceResponse& response) {
  std::lock_guard<std::mutex> lock(call_mutex);
  const auto found = calls.find(response.id);
  if (found == calls.end()) return;      // its caller has given up
  if (response.result) {
    found->second.answer = response.values;
  } else {
    found->second.answer = Error{ErrorCode::kRefused, "the robot refuses: " + response.values.text().substr(0, 400)};
  }
  call_changed.notify_all();
}

// Heartbeats follow the console's clock, so that simulated time has them, too.
void Connection::Impl::beat() {
  if (!settings.alive_until_s) return;
  const double now_s = clock.now_s();
  if (now_s < next_heartbeat_s || now_s >= settings.alive_until_s->load()) return;
  const double due = next_heartbeat_s + settings.heartbeat_period_s;
  next_heartbeat_s = due > now_s ? due : now_s + settings.heartbeat_period_s;
  worker->write(heartbeat);
}

// A stop leaves the machine before anything else is looked at; heartbeats go before whatever waits, so that a call
// that advances simulated time finds them there.
void Connection::Impl::onTurn() noexcept {
  try {
    for (bool beaten = false; is_up;) {
      std::optional<Outbox::Next> next;
      {
        std::lock_guard<std::mutex> lock(out_mutex);
        next = outbox.pop(clock.now_s());
      }
      const bool urgent = next && next->urgent;
      if (!urgent && !std::exchange(beaten, true)) beat();
      if (!next) break;
      worker->write(next->text);
      if (urgent) worker->flush();
    }
    worker->flush();
  } catch (const std::exception& e) {
    logLine(LogLevel::kError, kCategory, std::string("sending: ") + e.what());
  }
}

Status Connection::Impl::push(const Operation& operation, bool motion) {
  if (!is_up) return down();
  Outbox::Item item{rosbridge::encodeText(operation), motion, clock.now_s() + settings.motion_deadline_s};
  std::lock_guard<std::mutex> lock(out_mutex);
  if (auto status = outbox.push(std::move(item)); !status) return status;
  wakeLocked();
  return {};
}

Connection::Connection(ConnectionSettings settings, const Clock& clock)
    : m_impl(std::make_unique<Impl>(std::move(settings), clock)) {}

Connection::~Connection() {
  std::lock_guard<std::mutex> life(m_impl->life_mutex);
  m_impl->finish();
}

const std::string& Connection::url() const { return m_impl->settings.url; }

std::uint64_t Connection::attach(Events events) {
  std::lock_guard<std::mutex> life(m_impl->life_mutex);
  std::uint64_t id = 0;
  {
    std::lock_guard<std::mutex> lock(m_impl->mutex);
    id = m_impl->next_id++;
    const auto& added = m_impl->listeners.emplace(id, std::move(events)).first->second;
    if (m_impl->is_up && added.up) added.up();
  }
  if (!m_impl->thread) m_impl->start();
  return id;
}

void Connection::detach(std::uint64_t id) noexcept {
  std::lock_guard<std::mutex> life(m_impl->life_mutex);
  bool last = false;
  {
    std::lock_guard<std::mutex> lock(m_impl->mutex);
    m_impl->listeners.erase(id);
    last = m_impl->listeners.empty();
  }
  if (last) m_impl->finish();
}

std::uint64_t Connection::subscribe(rosbridge::Subscribe what, Handler handler) {
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  const auto id = m_impl->next_id++;
  what.id = "longarm:" + std::to_string(id);
  if (m_impl->is_up) (void)m_impl->push(what, false);   // a link lost meanwhile subscribes again by itself
  m_impl->subscriptions[id] = {std::move(what), std::move(handler)};
  return id;
}

void Connection::unsubscribe(std::uint64_t id) noexcept {
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  const auto found = m_impl->subscriptions.find(id);
  if (found == m_impl->subscriptions.end()) return;
  try {
    const auto& what = found->second.what;
    if (m_impl->is_up) (void)m_impl->push(rosbridge::Unsubscribe{what.topic, what.id}, false);
  } catch (const std::exception& e) {    // for want of memory: the topic keeps coming and is ignored
    logLine(LogLevel::kWarning, kCategory, std::string("unsubscribing: ") + e.what());
  }
  m_impl->subscriptions.erase(found);
}

void Connection::advertise(const std::string& topic, const std::string& type) {
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  if (!m_impl->advertised.emplace(topic, type).second) return;
  if (m_impl->is_up) (void)m_impl->push(rosbridge::Advertise{topic, type, {}}, false);
}

bool Connection::up() const { return m_impl->is_up; }

rosbridge::Dialect Connection::dialect() const { return m_impl->dialect; }

Status Connection::requireUp() const {
  if (m_impl->is_up) return {};
  return m_impl->down();
}

Status Connection::post(const Operation& operation) { return m_impl->push(operation, false); }

Status Connection::postMotion(const Operation& operation) { return m_impl->push(operation, true); }

Status Connection::postUrgent(const Operation& operation) {
  if (!m_impl->is_up) return m_impl->down();
  std::string text = rosbridge::encodeText(operation);
  std::lock_guard<std::mutex> lock(m_impl->out_mutex);
  m_impl->outbox.pushUrgent(std::move(text));
  m_impl->wakeLocked();
  return {};
}

Result<rosbridge::Body> Connection::call(const std::string& service, const rosbridge::Body& arguments,
                                         double timeout_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  std::string id;
  {
    std::unique_lock<std::mutex> lock(m_impl->call_mutex);
    const bool connected = m_impl->call_changed.wait_until(
        lock, end, [&] { return m_impl->is_up.load() || m_impl->was_up.load(); });
    if (!connected || !m_impl->is_up) return Error{ErrorCode::kDisconnected, service + ": " + m_impl->down().message};
    id = "call:" + std::to_string(++m_impl->call_count);
    m_impl->calls[id] = {};
    ++m_impl->calls_waiting;
  }
  const auto posted = m_impl->push(rosbridge::CallService{service, arguments, id}, false);
  std::unique_lock<std::mutex> lock(m_impl->call_mutex);
  auto& call = m_impl->calls[id];
  if (posted) m_impl->call_changed.wait_until(lock, end, [&] { return call.answer.has_value(); });
  auto answer = std::move(call.answer);
  m_impl->calls.erase(id);
  --m_impl->calls_waiting;
  if (!posted) return Error{posted.error().code, service + ": " + posted.error().message};
  if (!answer) {
    return Error{ErrorCode::kTimeout, service + ": no answer within " + formatNumber(timeout_s) + " s"};
  }
  if (!*answer) return Error{answer->error().code, service + ": " + answer->error().message};
  return std::move(**answer);
}

}  // namespace longarm::hardware
