#pragma once

/// @file
/// RobotServer: the virtual robot behind a WebSocket on this machine.

#include <memory>

#include <QObject>
#include <QTcpServer>
#include <QTimer>
#include <QWebSocketServer>

#include "app/virtual_robot/virtual_robot.h"
#include "core/clock.h"

class QWebSocket;

namespace longarm::virtual_robot {

/// Serves one client on 127.0.0.1: a second is refused while the first lives, that is, until it closes or has sent
/// nothing for two seconds.  Its robot keeps its state from one client to the next.  Main thread only.
class RobotServer final : public QObject {
  Q_OBJECT

 public:
  explicit RobotServer(QObject* parent = nullptr);
  ~RobotServer() override;

  /// Builds the robot and listens.  @param port  0: any.
  /// @returns the robot's errors, or kRefused when the port cannot be had.
  Status start(const RobotOptions& options, quint16 port);
  quint16 port() const { return m_listener.serverPort(); }

 Q_SIGNALS:
  void quitAsked();

 private:
  void acceptSockets();
  void acceptClient();
  void endClient();
  bool clientLives() const;
  void tick();
  void send(const Frame& frame);

  QTcpServer m_listener;
  QWebSocketServer m_server;
  QTimer m_timer, m_ping;
  SteadyClock m_clock;
  double m_start_s = 0;                  // when the robot's clock read 0
  double m_heard_s = 0;                  // from the client
  QWebSocket* m_client = nullptr;        // owned by m_server until it is deleted
  std::unique_ptr<VirtualRobot> m_robot;
};

}  // namespace longarm::virtual_robot
