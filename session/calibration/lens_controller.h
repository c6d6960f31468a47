#pragma once

/// @file
/// LensController: distortion by hand and by plumb lines.

#include <optional>
#include <vector>

#include <QObject>
#include <QString>
#include <opencv2/core/mat.hpp>

#include "calibration/intrinsics/plumb_line.h"
#include "session/calibration/calibration_controller.h"
#include "session/controllers/job_runner.h"

namespace longarm::session {

/// One picture, guides laid along edges that are straight in the world, and coefficients that straighten them: moved by
/// hand or solved.  GUI thread only.
class LensController final : public QObject {
  Q_OBJECT

 public:
  /// Everything is borrowed and outlives this.
  LensController(CalibrationController& calibration, JobRunner& jobs, QObject* parent = nullptr);

  /// The camera whose lens it is; begins with the one in use.
  void setCamera(const QString& camera);
  const std::string& camera() const { return m_name; }
  /// Guides stay as long as the size stays.
  void setPicture(const cv::Mat& picture);
  void openFile(const QString& path);
  const cv::Mat& picture() const { return m_picture; }

  const vision::CameraModel& lens() const { return m_lens; }
  /// k1 k2 p1 p2 k3 by its index.
  void setCoefficient(int index, double value);
  /// Back to the lens in use, or to none.
  void reset();
  void straightenNothing();

  void addPoint(const Eigen::Vector2d& pixel);     ///< To the guide that is being laid.
  void endGuide();                                 ///< The next point begins another.
  void removeGuide();                              ///< The newest.
  const std::vector<calibration::PlumbLine>& guides() const { return m_guides; }
  /// Of the guides with three points or more, with the lens as it stands [px]; empty: none, or no inverse.
  std::optional<double> straightness() const;

  QString whyNotSolve() const;
  /// @param coefficients 1, 2 or 4.
  void solve(int coefficients);
  bool solving() const { return m_solving; }
  const std::optional<calibration::PlumbLineResult>& result() const { return m_result; }   ///< Until something changes.
  QString whyNotApply() const;
  CameraChange change() const;

 Q_SIGNALS:
  void changed();
  void failed(const QString& sentence);

 private:
  void touched();
  std::vector<calibration::PlumbLine> usable() const;

  CalibrationController& m_calibration;
  JobRunner& m_jobs;
  std::string m_name;
  cv::Mat m_picture;
  vision::CameraModel m_lens, m_in_use;
  std::vector<calibration::PlumbLine> m_guides;
  bool m_laying = false, m_solving = false;
  int m_generation = 0;
  std::optional<calibration::PlumbLineResult> m_result;
};

}  // namespace longarm::session
