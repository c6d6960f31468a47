#include "hardware/drivers/rosbridge/socket_worker.h"

#include <algorithm>
#include <clocale>
#include <mutex>

#include <QCoreApplication>
#include <QEvent>
#include <QNetworkProxy>
#include <QTcpSocket>
#include <QUrl>

#include "core/text.h"

namespace longarm::hardware {
namespace {

constexpr int kTurn_ms = 10;
constexpr double kPing_s = 1;
constexpr double kSettled_s = 1;         // A link that lived for so long is tried again at once.

}  // namespace

void ensureApplication() {
  static std::mutex mutex;
  std::lock_guard<std::mutex> lock(mutex);
  if (QCoreApplication::instance() != nullptr) return;
  // It would take over the locale of the environment; programs that use this library choose their own.
  const char* before = std::setlocale(LC_ALL, nullptr);
  const std::string locale = before != nullptr ? before : "C";
  static int argc = 1;
  static char name[] = "longarm";
  static char* argv[] = {name, nullptr};
  new QCoreApplication(argc, argv);      // lives as long as the program
  std::setlocale(LC_ALL, locale.c_str());
}

SocketWorker::SocketWorker(const ConnectionSettings& settings, SocketOwner& owner)
    : m_settings(settings), m_owner(owner) {}

SocketWorker::~SocketWorker() = default;

void SocketWorker::begin() {
  m_retry_s = m_settings.first_retry_s;
  m_retry = std::make_unique<QTimer>();
  m_retry->setSingleShot(true);
  m_turn = std::make_unique<QTimer>();
  m_turn->setTimerType(Qt::PreciseTimer);
  m_turn->setInterval(kTurn_ms);
  connect(m_retry.get(), &QTimer::timeout, this, [this] { connectNow(); });
  connect(m_turn.get(), &QTimer::timeout, this, [this] {
    watch();
    m_owner.onTurn();
  });
  m_turn->start();
  connectNow();
}

// A new socket for every attempt: nothing of the one before is left.
void SocketWorker::makeSocket() {
  m_socket = std::make_unique<QWebSocket>();
  auto* socket = m_socket.get();
  socket->setProxy(QNetworkProxy::NoProxy);
  socket->setMaxAllowedIncomingFrameSize(rosbridge::kMaxFrameBytes);
  socket->setMaxAllowedIncomingMessageSize(rosbridge::kMaxFrameBytes);
  connect(socket, &QWebSocket::connected, this, [this] { opened(); });
  connect(socket, &QWebSocket::disconnected, this, [this] {
    const auto said = m_socket->closeReason().toStdString();
    lost(said.empty() ? m_socket->errorString().toStdString() : said);
  });
  connect(socket, QOverload<QAbstractSocket::SocketError>::of(&QWebSocket::error), this,
          [this] { lost(m_socket->errorString().toStdString()); });
  connect(socket, &QWebSocket::pong, this, [this] { m_heard_s = m_steady.now_s(); });
  connect(socket, &QWebSocket::textMessageReceived, this, [this](const QString& text) { heard(text.toUtf8(), false); });
  connect(socket, &QWebSocket::binaryMessageReceived, this, [this](const QByteArray& bytes) { heard(bytes, true); });
}

void SocketWorker::opened() {
  m_open = true;
  m_connecting = false;
  m_opened_s = m_heard_s = m_pinged_s = m_steady.now_s();
  // Horizons are small and must not wait for each other.
  for (auto* tcp : m_socket->findChildren<QTcpSocket*>()) tcp->setSocketOption(QAbstractSocket::LowDelayOption, 1);
  m_owner.onOpened();
}

void SocketWorker::heard(const QByteArray& bytes, bool binary) {
  m_heard_s = m_steady.now_s();
  if (m_open) m_owner.onFrame({bytes.constData(), static_cast<std::size_t>(bytes.size())}, binary);
}

void SocketWorker::end() {
  m_ending = true;
  m_owner.onTurn();
  if (m_socket) {
    m_socket->disconnect(this);
    if (m_open) {
      m_socket->flush();
      m_socket->close();
    } else {
      m_socket->abort();
    }
  }
  m_turn.reset();
  m_retry.reset();
  m_socket.reset();
}

void SocketWorker::wake() {
  if (m_woken.exchange(true)) return;
  QCoreApplication::postEvent(this, new QEvent(QEvent::User), Qt::HighEventPriority);
}

bool SocketWorker::event(QEvent* event) {
  if (event->type() != QEvent::User) return QObject::event(event);
  m_woken.store(false);
  if (m_socket && !m_ending) m_owner.onTurn();
  return true;
}

bool SocketWorker::write(const std::string& text) {
  if (!m_open) return false;
  const QString message = QString::fromUtf8(text.data(), static_cast<int>(text.size()));
  return m_socket->sendTextMessage(message) >= 0;
}

void SocketWorker::flush() {
  if (m_open) m_socket->flush();
}

void SocketWorker::connectNow() {
  if (m_ending || m_open) return;
  m_connecting = true;
  m_began_s = m_steady.now_s();
  makeSocket();
  m_socket->open(QUrl(QString::fromStdString(m_settings.url)));
}

// Once per connection or attempt: error() and disconnected() both come.
void SocketWorker::lost(const std::string& why) {
  if (!m_open && !m_connecting) return;
  if (m_open && m_steady.now_s() - m_opened_s > kSettled_s) m_retry_s = m_settings.first_retry_s;
  m_open = m_connecting = false;
  m_retry->start(static_cast<int>(m_retry_s * 1000));
  m_retry_s = std::min(2 * m_retry_s, m_settings.last_retry_s);
  m_owner.onClosed(why.empty() ? "the other side closed it" : why);
}

void SocketWorker::abandon(const std::string& why) {
  if (!m_open && !m_connecting) return;
  lost(why);
  m_socket->abort();
}

void SocketWorker::watch() {
  const double now_s = m_steady.now_s();
  if (m_owner.awaitsAnswer()) m_heard_s = now_s;
  if (m_connecting && now_s - m_began_s > m_settings.connect_timeout_s) {
    abandon("no answer within " + formatNumber(m_settings.connect_timeout_s) + " s");
  }
  if (!m_open) return;
  if (now_s - m_heard_s > m_settings.silence_s) {
    abandon("silent for " + formatNumber(m_settings.silence_s) + " s");
  } else if (static_cast<std::size_t>(m_socket->bytesToWrite()) > m_settings.max_backlog_bytes) {
    abandon(std::to_string(m_socket->bytesToWrite()) + " bytes could not be sent");
  } else if (now_s - m_pinged_s > kPing_s) {
    m_pinged_s = now_s;
    m_socket->ping();
  }
}

}  // namespace longarm::hardware
