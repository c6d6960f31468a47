#pragma once

/// @file
/// SnapshotController: takes pictures from the robot or from files into the document.

#include <functional>
#include <memory>
#include <vector>

#include <QObject>
#include <QString>
#include <QTimer>

#include "session/commands/edit_history.h"
#include "session/controllers/job_runner.h"
#include "session/controllers/robot_feed.h"
#include "session/controllers/snapshot_maker.h"

namespace longarm::session {

struct SnapshotTiming {
  double timeout_s = 3;                    ///< For a frame newer than the request.
  double settle_s = 1;                     ///< How long to wait for a pair that checkPair() accepts.
  int poll_ms = 10;
  PairLimits limits;
};

/// GUI thread only.  Each picture enters the library as one undo step per request.
class SnapshotController final : public QObject {
  Q_OBJECT

 public:
  enum class State { kIdle, kWaiting, kDecoding };

  /// Everything is borrowed and outlives this.
  SnapshotController(Document& document, EditHistory& history, JobRunner& jobs, QObject* parent = nullptr);

  /// The connected robot; null: none.
  void setFeed(RobotFeed* feed) { m_feed = feed; }
  void setTiming(const SnapshotTiming& timing) { m_timing = timing; }

  State state() const { return m_state; }
  /// Why takePair/take would refuse now; empty when they would not.
  QString whyNot() const;

  /// Takes one picture of each camera after now, the first to the left pane, the second to the right.  Ends in
  /// taken() or failed().
  void takePair(const QString& left_camera, const QString& right_camera);
  void take(const QString& camera, PaneSide side);
  /// Opens pictures from files.
  void openFiles(const PictureFiles& left, const PictureFiles& right);   ///< One undo step.
  void openFile(const PictureFiles& picture, PaneSide side);
  void openViews(const QString& views_yaml);
  void cancel();

 Q_SIGNALS:
  void stateChanged();
  void taken(const std::vector<longarm::SnapshotId>& ids);
  void failed(const QString& sentence);

 private:
  using Snapshots = std::vector<vision::Snapshot>;
  void request(std::vector<std::string> cameras, PaneSide side);
  void poll();
  void collect();
  bool zoomMoves(const std::string& camera, double stamp_s, std::optional<double> zoom);
  bool complete() const;
  /// The frames to use, nearest in time; kRefused as checkPair.  @pre complete()
  Result<std::vector<StampedFrame>> choose() const;
  void expire(double waited_s);
  void decode(std::function<Result<Snapshots>()> work, PaneSide side);
  void finish(Result<Snapshots> result, PaneSide side);
  void fail(const std::string& sentence);
  void setState(State state);

  Document& m_document;
  EditHistory& m_history;
  JobRunner& m_jobs;
  RobotFeed* m_feed = nullptr;
  SnapshotTiming m_timing;
  State m_state = State::kIdle;
  QTimer m_timer;
  int m_generation = 0;
  std::vector<std::string> m_cameras;
  std::vector<std::vector<StampedFrame>> m_frames;   // Per camera, newer than the request.
  PaneSide m_side = PaneSide::kLeft;
  double m_requested_s = 0;
  std::string m_refusal;                             // Of the best pair so far.
};

}  // namespace longarm::session
