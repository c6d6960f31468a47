#include "session/controllers/snapshot_maker.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/clock.h"
#include "core/text.h"
#include "session/controllers/calibrated_camera.h"
#include "vision/camera/camera_file.h"
#include "vision/snapshot/image_file.h"
#include "vision/snapshot/views_file.h"

namespace longarm::session {

namespace {

namespace fs = std::filesystem;

double largestSpeed(const JointState& state, std::string* joint) {
  double largest = 0;
  for (Eigen::Index i = 0; i < state.velocities.size(); ++i) {
    if (std::abs(state.velocities(i)) <= largest) continue;
    largest = std::abs(state.velocities(i));
    *joint = state.names[static_cast<std::size_t>(i)];
  }
  return largest;
}

/// Empty when nothing moves between the two exposures.
std::string motionBetween(const StampedFrame& a, const StampedFrame& b, const PairLimits& limits) {
  const JointChange change = largestChange(a.state, b.state);
  if (change.change > limits.moving_change) {
    return change.joint + " moved by " + formatFixed(change.change, 4) + " (limit " +
           formatFixed(limits.moving_change, 4) + ")";
  }
  for (const StampedFrame* frame : {&a, &b}) {
    std::string joint;
    const double speed = largestSpeed(frame->state, &joint);
    if (speed > limits.moving_velocity) {
      return joint + " moved at " + formatFixed(speed, 3) + " /s (limit " + formatFixed(limits.moving_velocity, 3) + ")";
    }
  }
  return {};
}

Status checkSize(const cv::Mat& image, const vision::CameraModel& camera, const std::string& what) {
  if (camera.width <= 0 || camera.height <= 0 || (image.cols == camera.width && image.rows == camera.height)) return {};
  return {ErrorCode::kInvalidInput, what + ": the picture is " + std::to_string(image.cols) + " x " +
                                        std::to_string(image.rows) + " px, its camera file says " +
                                        std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                                        ". Use the picture as it was taken, or the file of this camera."};
}

void giveSize(const cv::Mat& image, vision::CameraModel* camera) {
  if (camera->width <= 0) camera->width = image.cols;
  if (camera->height <= 0) camera->height = image.rows;
}

Result<vision::Snapshot> pictureOf(const vision::View& view, const std::string& path) {
  auto image = vision::loadImage(path);
  if (!image) return image.error();
  if (const Status fits = checkSize(*image, view.camera, path); !fits) return fits.error();
  vision::Snapshot snapshot;
  snapshot.view = view;
  giveSize(*image, &snapshot.view.camera);
  snapshot.image = std::move(*image);
  snapshot.wall_time_s = wallTime_s();
  snapshot.source = path;
  return snapshot;
}

}  // namespace

JointChange largestChange(const JointState& a, const JointState& b) {
  JointChange largest;
  for (std::size_t i = 0; i < a.names.size(); ++i) {
    const auto other = b.position(a.names[i]);
    if (!other) continue;
    const double change = std::abs(a.positions(static_cast<Eigen::Index>(i)) - *other);
    if (change > largest.change) largest = {change, a.names[i]};
  }
  return largest;
}

Status checkPair(const StampedFrame& a, const StampedFrame& b, const PairLimits& limits) {
  const double skew_s = std::abs(a.frame->stamp_s - b.frame->stamp_s);
  if (skew_s <= limits.max_skew_s) return {};
  const std::string motion = motionBetween(a, b, limits);
  if (motion.empty()) return {};
  return {ErrorCode::kRefused,
          "The pictures of " + a.frame->camera + " and " + b.frame->camera + " are " + formatFixed(skew_s * 1000, 0) +
              " ms apart and " + motion + "; while anything moves at most " + formatFixed(limits.max_skew_s * 1000, 0) +
              " ms is allowed. Wait until the robot stands still and take the pair again."};
}

Result<vision::View> cameraView(const planning::Workcell& workcell, const std::string& camera,
                                const JointState& state, std::optional<double> zoom) {
  const planning::CameraSpec* spec = workcell.camera(camera);
  if (spec == nullptr) return {ErrorCode::kNotFound, "The workcell " + workcell.name + " has no camera \"" + camera + "\"."};
  if (!workcell.model) return {ErrorCode::kNotFound, "The workcell " + workcell.name + " has no robot."};
  const auto link = workcell.model->linkIndex(spec->link);
  if (!link) return link.error();
  const auto calibration = calibrationOf(*spec);
  if (!calibration) return calibration.error();
  auto file = (*calibration)->at(zoom);
  if (!file) return file.error();
  vision::View view;
  view.name = camera;
  view.camera = file->camera;
  view.parent = workcell.model->links()[static_cast<std::size_t>(workcell.model->rootLink())].name;
  view.sigma_px = spec->sigma_px;
  view.zoom = zoom;
  Eigen::VectorXd q = workcell.model->neutral();
  workcell.model->assign(state, q);
  view.X_WC = workcell.model->forward(q, *link);
  // A calibrated mount: the optical frame where the link of the robot's description is not quite.  A zoom table's mount
  // is that link.
  const bool mounted = file->pose && ((*calibration)->hasTable() || file->pose->parent == spec->link);
  if (mounted) view.X_WC = view.X_WC * file->pose->pose;
  if (file->covariance) view.intrinsics_covariance = file->covariance->topLeftCorner<10, 10>();
  if (file->covariance && file->covariance->rows() == 16) {
    // The file's covariance is of the optical frame in its parent; turned to the root it keeps its size.
    Matrix6d turn = Matrix6d::Zero();
    const Eigen::Matrix3d R = file->pose ? Eigen::Matrix3d(view.X_WC.linear() * file->pose->pose.linear().transpose())
                                         : Eigen::Matrix3d::Identity();
    turn.topLeftCorner<3, 3>() = R;
    turn.bottomRightCorner<3, 3>() = R;
    view.pose_covariance = turn * file->covariance->bottomRightCorner<6, 6>() * turn.transpose();
  }
  return view;
}

Result<vision::Snapshot> makeSnapshot(const planning::Workcell& workcell, const StampedFrame& stamped) {
  auto view = cameraView(workcell, stamped.frame->camera, stamped.state, stamped.zoom);
  if (!view) return view.error();
  auto image = vision::decodeImage(stamped.frame->data);
  if (!image) return {image.error().code, "The picture of " + stamped.frame->camera + ": " + image.error().message};
  if (const Status fits = checkSize(*image, view->camera, "The picture of " + stamped.frame->camera); !fits) {
    return fits.error();
  }
  vision::Snapshot snapshot;
  snapshot.view = std::move(*view);
  giveSize(*image, &snapshot.view.camera);
  snapshot.image = std::move(*image);
  snapshot.stamp_s = stamped.frame->stamp_s;
  snapshot.wall_time_s = wallTime_s();
  snapshot.robot_state = stamped.state;
  snapshot.source = "live";
  return snapshot;
}

Result<vision::Snapshot> makeSnapshot(const PictureFiles& files) {
  auto file = vision::readCameraFile(files.camera);
  if (!file) return file.error();
  const auto& pose = files.pose ? files.pose : file->pose;
  if (!pose) {
    return {ErrorCode::kInvalidInput, files.camera + ": has no pose, and none was given with the picture " + files.image +
                                          ". Say where the camera was: add \"pose\" to the file, or use a views.yaml."};
  }
  vision::View view;
  view.name = files.name.empty() ? fs::path(files.image).stem().string() : files.name;
  view.camera = file->camera;
  view.parent = pose->parent;
  view.X_WC = pose->pose;
  view.sigma_px = files.sigma_px;
  if (file->covariance) view.intrinsics_covariance = file->covariance->topLeftCorner<10, 10>();
  if (!files.pose && file->covariance && file->covariance->rows() == 16) {
    view.pose_covariance = file->covariance->bottomRightCorner<6, 6>();
  }
  return pictureOf(view, files.image);
}

Result<std::vector<vision::Snapshot>> makeSnapshots(const std::string& views_yaml) {
  auto views = vision::readViewsFile(views_yaml);
  if (!views) return views.error();
  std::vector<vision::Snapshot> snapshots;
  for (const auto& entry : views->entries) {
    if (entry.image.empty()) continue;
    auto snapshot = pictureOf(entry.view, entry.image);
    if (!snapshot) return snapshot.error();
    snapshots.push_back(std::move(*snapshot));
  }
  if (snapshots.empty()) return {ErrorCode::kInvalidInput, views_yaml + ": no view names an image. Add \"image: FILE\" to the views."};
  return snapshots;
}

}  // namespace longarm::session
