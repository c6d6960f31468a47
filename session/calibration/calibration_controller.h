#pragma once

/// @file
/// CalibrationController: what the wizards share: the library, and which calibration each camera uses.

#include <memory>
#include <optional>

#include <QObject>
#include <QString>

#include "session/calibration/calibration_change.h"
#include "session/calibration/camera_library.h"
#include "session/calibration/intrinsics_controller.h"
#include "session/document/document.h"

namespace longarm::session {

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

  /// @param zoom  Setting, for a camera with a table; its pose is then in the camera's link.
  /// @returns kNotFound (no such camera; a table and no setting), or as CameraCalibration::read and at.
  Result<vision::CameraFile> fileInUse(const std::string& camera, std::optional<double> zoom = {}) const;
  /// The optical frame in the camera's link by the calibration in use; identity where that does not say, or says it of another
  /// frame.  Outside the settings of a table: of its wide end.
  Pose mountInUse(const std::string& camera, std::optional<double> zoom = {}) const;
  /// The record in use; empty: the workcell's own file is.
  std::optional<CalibrationRecord> recordInUse(const std::string& camera) const;
  /// The camera file that a change would give.  @returns kInvalidInput: the picture's size differs; as fileInUse.
  Result<vision::CameraFile> changed(const CameraChange& change) const;
  /// The placement in use; empty: the workcell's own files say where it stands.
  std::optional<CalibrationRecord> recordInUse(Subject subject, const std::string& name) const;
  /// Where a record (empty: the workcell's own files) has a pan-tilt or an object stand.  @returns kNotFound; as readPlacement.
  Result<Placement> placementOf(Subject subject, const std::string& name, const std::string& id) const;
  /// A sentence when the change is less certain than what is in use; else empty.
  QString whyWorse(const CameraChange& change) const;
  QString whyWorse(const PlaceChange& change) const;

  /// Keeps it in the library and uses it from now on; snapshots keep the camera they were taken with.
  Status apply(const CameraChange& change);
  /// The same for the table of a zoom camera.  @returns kInvalidInput: a camera that has no zoom.
  Status applyTable(const std::string& camera, const vision::ZoomFile& table);
  /// Uses a record of the library; empty id: the workcell's own file.
  Status use(const std::string& camera, const std::string& id);
  /// Keeps in the library where something stands and uses it from now on.  @returns kNotFound, or as CameraLibrary::add.
  Status apply(const PlaceChange& change);
  /// Makes a calibration of the library anew from its raw data, off the GUI thread, and keeps the answer beside it, not in use.
  /// Ends in solvedAgain() or failed().
  void solveAgain(const std::string& id);
  Status usePlacement(Subject subject, const std::string& name, const std::string& id);

 Q_SIGNALS:
  void applied(const QString& camera);             ///< workcellInUse() is another.
  void placed(const QString& name);                ///< So it is here.
  void libraryChanged();
  void solvedAgain(const QString& id);
  void failed(const QString& sentence);

 private:
  std::optional<Placement> placementInUse(Subject subject, const std::string& name) const;
  bool knows(Subject subject, const std::string& name) const;

  bool hasTable(const std::string& camera) const;
  Result<CalibrationRecord> keep(const CameraChange& change);
  Result<CalibrationRecord> keepMount(const CameraChange& change, CalibrationRecord record);
  Result<CalibrationRecord> keep(const PlaceChange& change);

  Document& m_document;
  JobRunner& m_jobs;
  CameraLibrary m_library;
  std::shared_ptr<const planning::Workcell> m_plain;
  IntrinsicsController m_intrinsics;
};

/// Index of a pan-tilt's first joint.  @returns kNotFound.
Result<int> panJointOf(const planning::Workcell& workcell, const std::string& pan_tilt);
/// 1 sigma of a camera's mount, of a place one metre before it [m]; empty: the file does not say.
std::optional<double> mountUncertainty(const vision::CameraFile& file);
/// Mean uncertainty of a camera file's lens over the picture [px]; empty when the file has no covariance or size.
std::optional<double> meanUncertainty(const vision::CameraFile& file);

}  // namespace longarm::session
