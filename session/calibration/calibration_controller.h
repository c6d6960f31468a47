#pragma once

/// @file
/// CalibrationController: what the wizards share: the library, and which calibration each camera uses.

#include <map>
#include <memory>
#include <optional>

#include <QObject>
#include <QString>

#include "session/calibration/camera_library.h"
#include "session/calibration/intrinsics_controller.h"
#include "session/document/document.h"

namespace longarm::session {

/// What a calibration found out about one camera; what is empty stays as it is.
struct CameraChange {
  std::string camera;                              ///< Of the workcell.
  std::string kind;                                ///< As CalibrationRecord::kind.
  std::string note;
  std::optional<vision::CameraModel> lens;
  Eigen::Matrix<double, 10, 10> lens_covariance = Eigen::Matrix<double, 10, 10>::Zero();
  std::optional<Pose> X_LC;                        ///< Optical frame in the camera's link.
  Matrix6d pose_covariance = Matrix6d::Zero();     ///< Of its split increment.
  int observations = 0;
  double rms_px = 0;
  std::string raw, raw_ending;                     ///< What it was made from, as text; "csv", "json".
};

/// Accepted calibrations live in the library, not in the workcell's files: those are what the integrator wrote, and can
/// always be gone back to.  GUI thread only.
class CalibrationController final : public QObject {
  Q_OBJECT

 public:
  /// Everything is borrowed and outlives this.  @param library_folder Empty: the program's own.
  CalibrationController(Document& document, JobRunner& jobs, const QString& library_folder, QObject* parent = nullptr);

  IntrinsicsController& intrinsics() { return m_intrinsics; }
  const IntrinsicsController& intrinsics() const { return m_intrinsics; }
  const CameraLibrary& library() const { return m_library; }

  /// The workcell as its file says.
  void setWorkcell(std::shared_ptr<const planning::Workcell> workcell) { m_plain = std::move(workcell); }
  const std::shared_ptr<const planning::Workcell>& plainWorkcell() const { return m_plain; }
  /// The same with the calibrations in use in place of the cameras' own files.
  std::shared_ptr<const planning::Workcell> workcellInUse() const;

  /// @returns kNotFound (no such camera), or as readCameraFile.
  Result<vision::CameraFile> fileInUse(const std::string& camera) const;
  /// The record in use; empty: the workcell's own file is.
  std::optional<CalibrationRecord> recordInUse(const std::string& camera) const;
  /// The camera file that a change would give.  @returns kInvalidInput: the picture's size differs; as fileInUse.
  Result<vision::CameraFile> changed(const CameraChange& change) const;
  /// A sentence when the change is less certain than what is in use; else empty.
  QString whyWorse(const CameraChange& change) const;

  /// Keeps it in the library and uses it from now on; snapshots keep the camera they were taken with.
  Status apply(const CameraChange& change);
  /// Uses a record of the library; empty id: the workcell's own file.
  Status use(const std::string& camera, const std::string& id);
  /// An object of the workcell stands elsewhere than its file says, until the window is closed.  kNotFound.
  Status placeObject(const std::string& object, const Pose& X_WO);

 Q_SIGNALS:
  void applied(const QString& camera);             ///< workcellInUse() is another.
  void objectPlaced(const QString& object);        ///< So it is here.
  void libraryChanged();

 private:
  Document& m_document;
  CameraLibrary m_library;
  std::shared_ptr<const planning::Workcell> m_plain;
  std::map<std::string, Pose> m_placed;            // objects by name
  IntrinsicsController m_intrinsics;
};

/// Mean uncertainty of a camera file's lens over the picture [px]; empty when the file has no covariance or size.
std::optional<double> meanUncertainty(const vision::CameraFile& file);

}  // namespace longarm::session
