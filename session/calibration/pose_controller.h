#pragma once

/// @file
/// PoseController: finds where a camera, an aiming device or an object is, from known points clicked in pictures.

#include <optional>
#include <vector>

#include <QObject>
#include <QString>

#include "calibration/pose/single_pose.h"
#include "calibration/pose/solve_loop.h"
#include "session/calibration/calibration_controller.h"
#include "session/calibration/known_geometry.h"
#include "session/calibration/landmarks.h"
#include "session/controllers/job_runner.h"
#include "vision/sketch/pointer_event.h"

namespace longarm::session {

/// One click: this landmark is there in that picture.
struct LandmarkPick {
  Landmark landmark;
  SnapshotId snapshot;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// What the solver made of them.
struct PoseOutcome {
  calibration::LoopResult result;
  std::vector<std::size_t> pick;           ///< Of each observation of `result`: index in picks().
};

/// The loop of transforms is p_C = T_ext T_kin T_dev T_obj^-1 x.  T_ext: the camera in its link (one camera, all views).
/// T_dev: the foot of the camera's pan-tilt in the robot's root.  T_obj: the pose of one object of the workcell.
/// Solves off the GUI thread after every click.  GUI thread only.
class PoseController final : public QObject {
  Q_OBJECT

 public:
  using Unknown = calibration::LoopUnknown;

  /// Everything is borrowed and outlives this.
  PoseController(Document& document, CalibrationController& calibration, JobRunner& jobs, QObject* parent = nullptr);
  ~PoseController() override;

  void setCamera(const QString& camera);
  const std::string& camera() const { return m_camera; }
  void setUnknown(Unknown unknown);
  Unknown unknown() const { return m_unknown; }
  /// The camera on its mount is not known either: both are found together, from pictures at several angles of the pan-tilt
  /// or poses of the arm.  For T_dev and T_obj; T_ext stands alone.
  void setCameraToo(bool too);
  bool cameraToo() const { return m_camera_too && m_unknown != Unknown::kExt; }
  /// Of the workcell, for T_obj.
  void setObject(const QString& object);
  const std::string& object() const { return m_object; }

  /// Those that can serve for what is unknown.
  const std::vector<Landmark>& landmarks() const { return m_landmarks; }
  void setLandmark(int index);             ///< The one a click will mean; -1: none.
  int landmark() const { return m_landmark; }
  /// Makes a landmark of what a ray of the root frame points at, in the configuration of the shown picture, and chooses it:
  /// a corner within `snap_rad` of the ray, else an edge, else the surface itself.
  /// @returns kNotFound with a sentence when there is nothing that could serve.
  Status stick(const Eigen::Vector3d& from, const Eigen::Vector3d& along, double snap_rad);
  /// The same through a pixel of the shown picture, against the geometry as it is drawn there.
  Status stickAtPixel(const Eigen::Vector2d& pixel, double radius_px);
  /// Pictures of the camera with the robot's state, oldest first.
  std::vector<SnapshotPtr> snapshots() const;
  void setSnapshot(SnapshotId id);
  SnapshotPtr snapshot() const;            ///< Null: none.

  /// The chosen landmark is here; replaces an earlier click on it in this picture, and goes on to the landmark that
  /// would help most.
  void pick(const Eigen::Vector2d& pixel);
  void remove(std::size_t pick);
  void clear();
  const std::vector<LandmarkPick>& picks() const { return m_picks; }

  /// The operator's own guess, on top of what is in use: turn [rad] and shift [m] in the camera's (T_ext), the root's (T_dev)
  /// or the object's parent frame.  A start for the search and what is drawn until there is a solution.
  void setGuess(const Vector6d& increment);

  /// Another pose that fits about as well becomes the answer, to be compared with the picture.  @pre the outcome has alternatives
  void takeAlternative();

  const std::optional<PoseOutcome>& outcome() const { return m_outcome; }
  QString why() const { return m_why; }    ///< Why there is no outcome, with what to do.
  bool solving() const { return m_solving; }
  /// The unknown as it stands: solved, else guessed, as it stands in the loop (T_obj: its inverse).
  Pose estimate() const;
  /// The picture's camera with the estimate; empty without a picture.
  std::optional<vision::View> viewNow() const;
  /// Landmarks, edges, clicks and 10-fold misses over the shown picture.
  vision::Overlay overlay() const;
  /// Index of the landmark whose place in the picture lies within `radius_px` of a pixel; -1: none.
  int landmarkNear(const Eigen::Vector2d& pixel, double radius_px) const;
  /// Clicked minus projected with the calibration in use, of clicks in pictures taken since it is [px].
  std::vector<Eigen::Vector2d> offsetsInUse() const;
  /// rms of all clicks with the calibration in use [px]; empty without clicks.
  std::optional<double> missInUse() const;

  /// Where another picture would help most, in words with what it would bring; empty: no advice yet.
  QString nextPicture() const { return m_next_picture; }

  QString whyNotApply() const;
  /// T_ext, alone or too: what to give to CalibrationController::apply.  @pre whyNotApply() is empty
  CameraChange change() const;
  /// T_dev, T_obj: the same for what is no camera.  @pre whyNotApply() is empty
  PlaceChange placeChange() const;
  /// A sentence when the answer is less certain than what is in use; else empty.
  QString whyWorse() const;
  /// T_obj: the object's solved pose in its parent.
  Pose solvedObjectPose() const;
  /// The solved transform in numbers as files write them.
  QString resultText() const;

  static constexpr double kClick_px = 0.7;       ///< 1 sigma of a hand, per axis.

 Q_SIGNALS:
  void changed();                          ///< Clicks, outcome, choices.
  void landmarksChanged();
  void snapshotsChanged();

 private:
  void documentChanged(const Change& change);
  void refreshGeometry();
  void refreshLandmarks();
  bool serves(const std::string& thing, const std::string& link) const;
  void restart();
  void solve();
  void advise();
  /// One more picture that could be taken, and the known points that it might hold.
  struct PictureOffer {
    QString words;
    std::vector<calibration::PoseObservation> points;
  };
  void advisePicture();
  void offerAngles(std::vector<PictureOffer>* offers) const;
  void offerPoses(std::vector<PictureOffer>* offers) const;
  void offerGripper(std::vector<PictureOffer>* offers) const;
  std::vector<calibration::PoseObservation> observed() const;
  std::vector<calibration::PoseObservation> seenFrom(const Eigen::VectorXd& q) const;
  bool isCarriedByArm() const;
  Placement footPlacement() const;
  /// The link that carries the pan-tilt, in the root; empty when it moved between the pictures.
  std::optional<Pose> footOfPanTilt() const;
  void refreshMount();
  /// T_ext as it stands: solved together with another, else as in use.
  Pose extNow(const Pose& in_use) const;
  Pose mountAt(const vision::Snapshot* snapshot) const;    // the camera in its link, as in use at the picture's zoom
  Pose inUseAt(const vision::Snapshot& snapshot) const;
  bool severalZooms() const;               // among the pictures that are clicked in
  std::optional<calibration::LoopView> loopViewAt(const Eigen::VectorXd& q, const std::string& name, const Pose& T_ext) const;
  std::optional<calibration::PoseObservation> observationAt(const Landmark& landmark, const Eigen::VectorXd& q, const Pose& T_ext) const;
  std::string rawText() const;
  Eigen::VectorXd configurationNow() const;
  Pose inUse() const;
  /// Everything of the loop but the unknown, for one picture.  Empty: a link is missing.
  std::optional<calibration::LoopView> loopView(const vision::Snapshot& snapshot) const;
  /// Landmark in the frame that the loop begins with.
  std::optional<Eigen::Vector3d> loopPoint(const Landmark& landmark, const vision::Snapshot& snapshot) const;
  std::optional<Eigen::Vector2d> projected(const Landmark& landmark, const vision::Snapshot& snapshot, const Pose& unknown) const;
  std::optional<Eigen::Vector2d> projectedInUse(const Landmark& landmark, const vision::Snapshot& snapshot) const;
  std::optional<calibration::PoseObservation> observation(const Landmark& landmark, const vision::Snapshot& snapshot) const;
  Eigen::VectorXd configuration(const vision::Snapshot& snapshot) const;
  const planning::CameraSpec* spec() const;
  const planning::WorldObject* objectSpec() const;
  bool hangsOnPanTilt(const std::string& link) const;

  Document& m_document;
  CalibrationController& m_calibration;
  JobRunner& m_jobs;
  int m_observer = 0;
  std::string m_camera, m_object;
  Unknown m_unknown = Unknown::kExt;
  bool m_camera_too = false;
  KnownGeometry m_geometry;
  Pose m_X_LC = Pose::Identity();          // the camera in its link, as in use
  std::vector<Landmark> m_landmarks, m_stuck;
  QString m_next_picture;
  int m_landmark = -1;
  SnapshotId m_snapshot;
  std::vector<LandmarkPick> m_picks;
  Vector6d m_guess = Vector6d::Zero();
  std::optional<PoseOutcome> m_outcome;
  QString m_why;
  bool m_solving = false, m_stale = false;
  std::optional<Pose> m_chosen;            // of several poses that fit
};

}  // namespace longarm::session
