#pragma once

/// @file
/// A workcell with a crate, snapshots made without a robot, and an operator who clicks what a true camera sees.

#include <memory>
#include <optional>
#include <string>

#include <QTemporaryDir>

#include "session/calibration/pose_controller.h"
#include "session/controllers/snapshot_maker.h"
#include "tests/calibration/synthetic.h"
#include "tests/session/event_loop.h"

namespace longarm::session {

class Field : public longarm::testing::EventLoopTest {
 protected:
  void SetUp() override {
    auto made = planning::loadBuiltInWorkcell().value();
    planning::WorldObject crate;
    crate.name = "crate";
    crate.shape = planning::Box{{0.4, 0.3, 0.25}};
    crate.X_WO = poseFromRpy({1.4, 0.1, 0.3}, {0, 0, 0.4});
    made.objects.push_back(crate);
    plain = std::make_shared<planning::Workcell>(made);
    calibration.setWorkcell(plain);
    document.setWorkcell(calibration.workcellInUse());
    const auto use = [this] { document.setWorkcell(calibration.workcellInUse()); };
    QObject::connect(&calibration, &CalibrationController::applied, use);
    QObject::connect(&calibration, &CalibrationController::placed, use);
  }
  JointState arm(double a1, double a2, double a3, double a5 = 0) {
    JointState state;
    state.names = {"arm_1_joint", "arm_2_joint", "arm_3_joint", "arm_5_joint"};
    state.positions.resize(4);
    state.positions << a1, a2, a3, a5;
    state.velocities = Eigen::VectorXd::Zero(4);
    return state;
  }
  SnapshotId addSnapshot(const std::string& camera, const JointState& state, double wall_s = 1e9, std::optional<double> zoom = {}) {
    vision::Snapshot snapshot;
    snapshot.id = document.nextSnapshotId();
    snapshot.view = cameraView(*document.workcell(), camera, state, zoom).value();
    snapshot.image = cv::Mat(480, 640, CV_8U, cv::Scalar(90));
    snapshot.robot_state = state;
    snapshot.source = "live";
    snapshot.wall_time_s = wall_s;
    document.insertSnapshot(document.snapshots().size(), std::make_shared<const vision::Snapshot>(snapshot));
    return snapshot.id;
  }
  /// Where the link that carries a camera is.
  std::optional<Pose> linkPose(const JointState& state, const std::string& camera) const {
    const auto& model = *document.workcell()->model;
    const auto link = model.linkIndex(document.workcell()->camera(camera)->link);
    Eigen::VectorXd q = model.neutral();
    model.assign(state, q);
    return link ? std::optional<Pose>(model.forward(q, *link)) : std::nullopt;
  }
  /// The workcell as the next start of the program would have it.
  std::shared_ptr<const planning::Workcell> afterRestart() {
    CalibrationController next(document, jobs, folder.path());
    next.setWorkcell(plain);
    return next.workcellInUse();
  }
  bool solved(const PoseController& pose) {
    return waitFor([&] { return !pose.solving(); });
  }

  QTemporaryDir folder;
  JobRunner jobs{1};
  Document document;
  std::shared_ptr<const planning::Workcell> plain;       ///< As its file says.
  CalibrationController calibration{document, jobs, folder.path()};
};

// Clicks every landmark that the true camera sees, with the tremble of a hand; at most `most` of each picture.
inline int clickAll(PoseController* pose, const Document& document, SnapshotId id, const Pose& X_WC, tests::Random* random, int most) {
  pose->setSnapshot(id);
  const auto snapshot = document.snapshot(id);
  const auto& model = *document.workcell()->model;
  Eigen::VectorXd q = model.neutral();
  model.assign(snapshot->robot_state, q);
  int clicked = 0;
  for (std::size_t i = 0; i < pose->landmarks().size() && clicked < most; ++i) {
    const auto at = pose->landmarks()[i].inRoot(model, q);
    const auto pixel = at ? snapshot->view.camera.project(X_WC.inverse() * *at) : Result<Eigen::Vector2d>(ErrorCode::kNotFound, "");
    if (!pixel || !snapshot->view.camera.containsPixel(*pixel, -3)) continue;
    pose->setLandmark(static_cast<int>(i));
    pose->pick(*pixel + Eigen::Vector2d(random->normal(0.5), random->normal(0.5)));
    ++clicked;
  }
  return clicked;
}

}  // namespace longarm::session
