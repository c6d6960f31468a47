#include "app/virtual_robot/robot_server.h"

#include <cstdio>

#include <QTcpSocket>
#include <QUrl>
#include <QWebSocket>
#include <QWebSocketCorsAuthenticator>

namespace longarm::virtual_robot {
namespace {

constexpr int kTickMs = 5;
constexpr int kPingMs = 1000;
constexpr double kSilence_s = 2;
constexpr quint64 kMaxIncoming = 4u << 20;       // bytes of one message
constexpr qint64 kMaxWaiting = 8 << 20;          // bytes not yet taken: pictures are dropped
constexpr std::size_t kSmallFrame = 16384;       // joint states and answers are never dropped

bool isLocal(const QString& origin) {
  if (origin.isEmpty()) return true;
  const QString host = QUrl(origin).host();
  return host == QStringLiteral("127.0.0.1") || host == QStringLiteral("localhost");
}

}  // namespace

RobotServer::RobotServer(QObject* parent)
    : QObject(parent), m_server(QStringLiteral("longarm-virtual-robot"), QWebSocketServer::NonSecureMode) {
  m_listener.setMaxPendingConnections(4);
  m_timer.setTimerType(Qt::PreciseTimer);
  m_timer.setInterval(kTickMs);
  m_ping.setInterval(kPingMs);
  connect(&m_listener, &QTcpServer::newConnection, this, &RobotServer::acceptSockets);
  connect(&m_server, &QWebSocketServer::newConnection, this, &RobotServer::acceptClient);
  // A web page that a browser shows on this machine must not reach the robot.
  connect(&m_server, &QWebSocketServer::originAuthenticationRequired, this,
          [](QWebSocketCorsAuthenticator* request) { request->setAllowed(isLocal(request->origin())); });
  connect(&m_timer, &QTimer::timeout, this, &RobotServer::tick);
  connect(&m_ping, &QTimer::timeout, this, [this] {
    if (m_client != nullptr) m_client->ping();
  });
}

RobotServer::~RobotServer() {
  if (m_client != nullptr) m_client->disconnect(this);
  m_listener.close();
  m_robot.reset();
}

Status RobotServer::start(const RobotOptions& options, quint16 port) {
  RobotOutlets outlets;
  outlets.send = [this](const Frame& frame) { send(frame); };
  outlets.wake = [this] {
    QMetaObject::invokeMethod(this, [this] { m_robot->deliverPictures(); }, Qt::QueuedConnection);
  };
  outlets.quit = [this] { QMetaObject::invokeMethod(this, [this] { Q_EMIT quitAsked(); }, Qt::QueuedConnection); };
  outlets.log = [](const std::string& what) { std::fprintf(stderr, "longarm-virtual-robot: %s\n", what.c_str()); };
  auto robot = VirtualRobot::create(options, std::move(outlets));
  if (!robot) return robot.error();
  m_robot = std::move(*robot);
  if (!m_listener.listen(QHostAddress::LocalHost, port)) {
    return {ErrorCode::kRefused, "cannot listen on 127.0.0.1:" + std::to_string(port) + ": " +
                                     m_listener.errorString().toStdString()};
  }
  m_start_s = m_clock.now_s();
  if (!options.lockstep) m_timer.start();
  m_ping.start();
  return {};
}

void RobotServer::tick() {
  const double now_s = m_clock.now_s();
  m_robot->advanceTo(now_s - m_start_s);
  // After a long sleep of the machine the robot's clock goes on from where it was.
  const double behind_s = now_s - m_start_s - m_robot->body().time_s();
  if (behind_s > VirtualRobot::kMostAtOnce_s) m_start_s += behind_s;
  if (m_client != nullptr) m_client->flush();
}

// Sockets are taken by hand because small messages must not wait for each other (TCP_NODELAY).
void RobotServer::acceptSockets() {
  while (QTcpSocket* socket = m_listener.nextPendingConnection()) {
    socket->setSocketOption(QAbstractSocket::LowDelayOption, 1);
    m_server.handleConnection(socket);
  }
}

bool RobotServer::clientLives() const {
  return m_client != nullptr && m_client->isValid() && m_clock.now_s() - m_heard_s < kSilence_s;
}

void RobotServer::acceptClient() {
  while (QWebSocket* socket = m_server.nextPendingConnection()) {
    if (clientLives()) {
      socket->close(QWebSocketProtocol::CloseCodePolicyViolated, QStringLiteral("the robot serves another console"));
      connect(socket, &QWebSocket::disconnected, socket, &QObject::deleteLater);
      continue;
    }
    if (m_client != nullptr) endClient();
    m_client = socket;
    m_heard_s = m_clock.now_s();
    socket->setMaxAllowedIncomingMessageSize(kMaxIncoming);
    socket->setMaxAllowedIncomingFrameSize(kMaxIncoming);
    connect(socket, &QWebSocket::textMessageReceived, this, [this, socket](const QString& text) {
      if (socket != m_client) return;
      tick();
      m_heard_s = m_clock.now_s();
      m_robot->protocol().receiveText(text.toStdString());
    });
    connect(socket, &QWebSocket::binaryMessageReceived, this, [this, socket](const QByteArray& bytes) {
      if (socket != m_client) return;
      tick();
      m_heard_s = m_clock.now_s();
      m_robot->protocol().receiveBinary({bytes.constData(), static_cast<std::size_t>(bytes.size())});
    });
    connect(socket, &QWebSocket::pong, this, [this, socket] {
      if (socket == m_client) m_heard_s = m_clock.now_s();
    });
    connect(socket, &QWebSocket::disconnected, this, [this, socket] {
      if (socket == m_client) endClient();
    });
    m_robot->protocol().connected();
  }
}

void RobotServer::endClient() {
  QWebSocket* gone = m_client;
  m_client = nullptr;
  tick();
  m_robot->protocol().disconnected();
  gone->abort();
  gone->deleteLater();
}

void RobotServer::send(const Frame& frame) {
  if (m_client == nullptr) return;
  if (frame.bytes.size() > kSmallFrame && m_client->bytesToWrite() > kMaxWaiting) return;
  if (frame.binary) {
    m_client->sendBinaryMessage(QByteArray(frame.bytes.data(), static_cast<int>(frame.bytes.size())));
  } else {
    m_client->sendTextMessage(QString::fromUtf8(frame.bytes.data(), static_cast<int>(frame.bytes.size())));
  }
}

}  // namespace longarm::virtual_robot
