#pragma once

/// @file
/// IntrinsicsController: the intrinsics wizard without its window.

#include <deque>
#include <optional>

#include <QObject>
#include <QString>
#include <QStringList>

#include "session/calibration/auto_capture.h"
#include "session/calibration/board_collection.h"
#include "session/controllers/job_runner.h"

namespace longarm::session {

/// The newest live picture that was searched.
struct LiveBoard {
  cv::Mat image;
  std::optional<double> zoom;                      ///< Setting of the lens; empty: fixed, or not known.
  std::optional<calibration::BoardView> board;
  AutoCapture::Verdict verdict = AutoCapture::Verdict::kNoBoard;
};

/// Searches pictures for the board and solves, both off the GUI thread; solves anew after every change of the
/// collection.  GUI thread only.
class IntrinsicsController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; outlives this.
  explicit IntrinsicsController(JobRunner& jobs, QObject* parent = nullptr);

  const calibration::BoardSpec& board() const { return m_board; }
  /// Another board: every picture is searched again.
  void setBoard(const calibration::BoardSpec& board);
  const calibration::LensChoice& lens() const { return m_lens; }
  void setLens(const calibration::LensChoice& lens);

  /// One after the other; those without the board stay in the list with the reason.
  void addFiles(const QStringList& paths);
  /// A live picture; dropped while the one before is being searched.
  /// @param zoom Setting of its lens; empty: fixed, or not known.
  void offerLive(const cv::Mat& picture, double stamp_s, std::optional<double> zoom = {});
  bool autoCapture() const { return m_auto; }
  void setAutoCapture(bool on) { m_auto = on; }
  QString whyNotCapture() const;
  /// Keeps the newest live picture.
  void capture();
  /// Another camera is looked through: what was live is forgotten.
  void leaveLive();

  void setIncluded(std::size_t picture, bool included);
  void remove(std::size_t picture);
  void clear();

  const BoardCollection& boards() const { return m_boards; }
  const std::optional<LiveBoard>& live() const { return m_live; }
  /// What the included pictures give; empty while there is nothing, or why() says why not.
  const std::optional<IntrinsicsOutcome>& outcome() const { return m_outcome; }
  QString why() const { return m_why; }
  bool searching() const { return m_searching || !m_waiting.empty(); }
  bool solving() const { return m_solving; }

  QString whyNotSave() const;
  /// Camera name in the file, path.  Ends in saved() or failed().
  void save(const QString& camera_name, const QString& path);

 Q_SIGNALS:
  void changed();                                  ///< Pictures, outcome, or what is under way.
  void liveChanged();
  void captured(const QString& name);
  void saved(const QString& path);
  void failed(const QString& sentence);

 private:
  struct Waiting {
    std::string name;
    cv::Mat image;                                 ///< Empty: read the file of this name.
    bool included = true;
    std::optional<double> zoom;
  };
  struct Seen {
    std::optional<calibration::BoardView> board;
    double sharpness = 0;
  };
  void searchNext();
  void take(Result<BoardPicture> picture);
  void seen(const cv::Mat& picture, double stamp_s, std::optional<double> zoom, Result<Seen> result);
  void watchZoom(std::optional<double> zoom);
  void collectionChanged();
  void solve();
  void finishSolve(Result<IntrinsicsOutcome>& outcome);

  JobRunner& m_jobs;
  calibration::BoardSpec m_board;
  calibration::LensChoice m_lens;
  BoardCollection m_boards;
  std::deque<Waiting> m_waiting;
  bool m_searching = false, m_solving = false, m_stale = false, m_looking = false, m_auto = true;
  int m_generation = 0;                            // Of searches: those of an earlier board or collection are dropped.
  AutoCapture m_capture;
  std::optional<double> m_capture_zoom;            // setting through which its places were seen
  std::optional<LiveBoard> m_live;
  std::optional<IntrinsicsOutcome> m_outcome;
  QString m_why;
  int m_captured = 0;
};

}  // namespace longarm::session
