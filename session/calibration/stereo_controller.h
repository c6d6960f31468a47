#pragma once

/// @file
/// StereoController: how two cameras stand to each other, from boards that both see.

#include <array>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include <QObject>
#include <QString>
#include <QStringList>

#include "calibration/intrinsics/stereo_pair.h"
#include "session/calibration/auto_capture.h"
#include "session/calibration/board_collection.h"
#include "session/calibration/calibration_controller.h"
#include "session/controllers/job_runner.h"

namespace longarm::session {

/// Left and right picture of one instant, searched for the board.
struct PicturePair {
  std::array<BoardPicture, 2> side;
  bool included = true;

  bool usable() const { return side[0].view && side[1].view; }
};

struct StereoOutcome {
  calibration::StereoResult result;
  std::vector<std::size_t> pair;           ///< Of each pair of `result`: index in pairs().
};

/// Searches pairs of pictures for the board and solves, both off the GUI thread; solves anew after every change.  Starts
/// from the lenses that the two cameras of the workcell use.  GUI thread only.
class StereoController final : public QObject {
  Q_OBJECT

 public:
  /// Everything is borrowed and outlives this.
  StereoController(Document& document, CalibrationController& calibration, JobRunner& jobs, QObject* parent = nullptr);

  void setCameras(const QString& left, const QString& right);
  const std::string& camera(int side) const { return m_cameras[static_cast<std::size_t>(side)]; }
  /// Another board: every pair is searched again.
  void setBoard(const calibration::BoardSpec& board);
  const calibration::BoardSpec& board() const { return m_board; }
  /// Whether the lenses are refined with the pose.
  void setRefine(bool refine);

  /// Pairs by their names: alternating, or all left ones first.
  void addFiles(const QStringList& paths);
  /// Live pictures; searched when both sides are there and were taken at once, to kTogether_s.
  void offerLive(int side, const cv::Mat& picture, double stamp_s);
  void setAutoCapture(bool on) { m_auto = on; }
  QString whyNotCapture() const;
  void capture();                          ///< Keeps the newest live pair.
  void leaveLive();
  const std::optional<PicturePair>& live() const { return m_live; }
  QString liveWords() const { return m_live_words; }

  const std::vector<PicturePair>& pairs() const { return m_pairs; }
  void setIncluded(std::size_t pair, bool included);
  void remove(std::size_t pair);
  void clear();

  const std::optional<StereoOutcome>& outcome() const { return m_outcome; }
  QString why() const { return m_why; }    ///< Why there is no outcome, with what to do.
  bool searching() const { return m_searching || !m_waiting.empty(); }
  bool solving() const { return m_solving; }
  /// The answer in numbers with what it is worth; empty without one.
  QString resultText() const;

  QString whyNotSave() const;
  /// Two camera files, the right one with its pose in the left one.  Ends in saved() or failed().
  void save(const QString& left_path, const QString& right_path);
  QString whyNotApply() const;
  /// The right camera's mount (and both lenses when they were refined), the left camera's mount taken as it is.
  /// @pre whyNotApply() is empty
  std::vector<CameraChange> changes() const;

  static constexpr double kTogether_s = 0.3;   ///< A board at rest is the same in both.
  static constexpr std::size_t kLeast = 3, kMost = 100;

 Q_SIGNALS:
  void changed();
  void liveChanged();
  void captured(int count);
  void saved(const QString& left, const QString& right);
  void failed(const QString& sentence);

 private:
  struct Waiting {
    std::array<std::string, 2> name;
    std::array<cv::Mat, 2> image;          // empty: read the file of this name
    bool included = true;
  };
  struct Live {
    cv::Mat image;
    double stamp_s = -1e9;
  };
  void searchNext();
  void take(Result<PicturePair> pair, bool included);
  void seen(PicturePair pair, std::array<double, 2> sharpness, double stamp_s);
  void collectionChanged();
  void solve();
  std::vector<std::size_t> usable() const;
  std::string rawText() const;
  /// The right camera's link in the left one's; empty when a joint between them moves.
  std::optional<Pose> betweenLinks() const;
  Result<vision::CameraFile> lens(int side) const;
  /// The right camera in the left one as the robot stands now.
  std::optional<Pose> pairInUse() const;
  QString squareWarning() const;

  Document& m_document;
  CalibrationController& m_calibration;
  JobRunner& m_jobs;
  std::array<std::string, 2> m_cameras;
  calibration::BoardSpec m_board;
  bool m_refine = false, m_auto = true, m_searching = false, m_solving = false, m_stale = false, m_looking = false;
  int m_generation = 0, m_captured = 0;
  std::deque<Waiting> m_waiting;
  std::array<Live, 2> m_newest;
  std::array<AutoCapture, 2> m_capture;
  std::optional<PicturePair> m_live;
  QString m_live_words;
  std::vector<PicturePair> m_pairs;
  std::optional<StereoOutcome> m_outcome;
  QString m_why;
};

}  // namespace longarm::session
