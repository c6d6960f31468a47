#pragma once

/// @file
/// FixtureController: a camera from one picture of a fixture with points known in 3-D.

#include <optional>
#include <vector>

#include <QObject>
#include <QString>
#include <opencv2/core/mat.hpp>

#include "calibration/fixture/calibrate_fixture.h"
#include "calibration/fixture/dot_finder.h"
#include "session/calibration/calibration_controller.h"
#include "session/controllers/job_runner.h"

namespace longarm::session {

/// The operator opens a fixture and a picture, clicks six or more points, and lets the program match the rest.  Solves off
/// the GUI thread after every change.  GUI thread only.
class FixtureController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; outlives this.
  explicit FixtureController(JobRunner& jobs, QObject* parent = nullptr);

  void openFixture(const QString& path);
  void openPicture(const QString& path);
  void setPicture(const cv::Mat& picture, const QString& name);
  const std::optional<calibration::Fixture>& fixture() const { return m_fixture; }
  const cv::Mat& picture() const { return m_picture; }
  const std::vector<calibration::Dot>& dots() const { return m_dots; }

  void setPoint(int index);                        ///< The fixture's point that a click will mean; -1: none.
  int point() const { return m_point; }
  /// The chosen point is here, or at the dot within `radius_px`; goes on to the next point without a place.
  void click(const Eigen::Vector2d& pixel, double radius_px);
  void removeMatch(std::size_t match);
  void clearMatches();
  QString whyNotMatch() const;
  void matchRest();                                ///< Those not clicked, by the camera that the clicks give.
  const std::vector<calibration::DotMatch>& matches() const { return m_matches; }

  void setDistortion(std::optional<int> coefficients);
  const std::optional<calibration::FixtureResult>& result() const { return m_result; }
  QString why() const { return m_why; }
  bool busy() const { return m_busy; }
  /// Measured minus projected pixel of a match.  @pre result() and match < matches().size()
  Eigen::Vector2d residual(std::size_t match) const;

  /// Writes the camera with its pose in the fixture's frame; saved() or failed().
  void save(const QString& camera_name, const QString& path);
  /// The lens only: where the fixture stands on the robot nobody knows.
  CameraChange change(const std::string& camera) const;

 Q_SIGNALS:
  void changed();
  void fixtureChanged();
  void saved(const QString& path);
  void failed(const QString& sentence);

 private:
  calibration::BoardView view() const;
  void matchesChanged();
  void solve();
  void nextPoint();

  JobRunner& m_jobs;
  std::optional<calibration::Fixture> m_fixture;
  cv::Mat m_picture;
  QString m_picture_name;
  std::vector<calibration::Dot> m_dots;
  std::vector<calibration::DotMatch> m_matches;
  int m_point = -1;
  calibration::LensChoice m_lens;
  std::optional<calibration::FixtureResult> m_result;
  QString m_why;
  bool m_busy = false, m_stale = false;
  int m_generation = 0;
};

}  // namespace longarm::session
