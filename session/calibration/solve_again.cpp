#include "session/calibration/solve_again.h"

#include <algorithm>

#include "calibration/fixture/calibrate_fixture.h"
#include "calibration/intrinsics/calibrate_intrinsics.h"
#include "calibration/intrinsics/corners_file.h"
#include "calibration/pose/observations_file.h"
#include "calibration/pose/solve_loop.h"
#include "calibration/solve/lens_parameters.h"
#include "core/text.h"

namespace longarm::session {

using calibration::LoopUnknown;

namespace {

Result<SolvedAgain> intrinsicsAgain(const CalibrationRecord& record, CameraChange change) {
  const auto file = vision::readCameraFile(record.file);
  const auto views = calibration::readCornersFile(record.raw);
  if (!file) return file.error();
  if (!views) return views.error();
  const auto result = calibration::calibrateIntrinsics(*views, file->camera.width, file->camera.height, {});
  if (!result) return result.error();
  change.lens = result->camera;
  change.lens_covariance = result->covariance;
  change.rms_px = result->rms_px;
  for (const auto& view : result->views) change.observations += view.used ? view.corners - view.outliers : 0;
  return SolvedAgain{change, {}};
}

Result<SolvedAgain> fixtureAgain(const CalibrationRecord& record, CameraChange change) {
  const auto file = vision::readCameraFile(record.file);
  const auto points = calibration::readFixturePoints(record.raw);
  if (!file) return file.error();
  if (!points) return points.error();
  const auto result = calibration::calibrateFixture(*points, file->camera.width, file->camera.height);
  if (!result) return result.error();
  change.lens = result->camera;
  change.lens_covariance = result->covariance.topLeftCorner<10, 10>();
  change.rms_px = result->rms_px;
  change.observations = static_cast<int>(points->corners.size());
  return SolvedAgain{change, {}};
}

Result<calibration::LoopResult> loopAgain(const CalibrationRecord& record, LoopUnknown unknown) {
  const auto observations = calibration::readObservations(record.raw, {unknown});
  if (!observations) return observations.error();
  calibration::LoopOptions options;
  options.unknowns = {unknown};
  options.starts = observations->given;
  return calibration::solveLoop(observations->problem, options);
}

int used(const calibration::LoopResult& result) {
  return static_cast<int>(std::count_if(result.observations.begin(), result.observations.end(), [](const auto& o) { return o.used; }));
}

Result<SolvedAgain> poseAgain(const CalibrationRecord& record, CameraChange change) {
  const auto result = loopAgain(record, LoopUnknown::kExt);
  if (!result) return result.error();
  const Matrix6d J = calibration::inverseIncrement(result->T[0]);
  change.X_LC = result->T[0].inverse();
  change.pose_covariance = J * result->covariance.topLeftCorner<6, 6>() * J.transpose();
  change.rms_px = result->rms_px;
  change.observations = used(*result);
  return SolvedAgain{change, {}};
}

Result<SolvedAgain> objectAgain(const CalibrationRecord& record, PlaceChange change) {
  const auto before = readPlacement(record.file);
  if (!before) return before.error();
  const auto result = loopAgain(record, LoopUnknown::kObj);
  if (!result) return result.error();
  const Matrix6d J = calibration::inverseIncrement(result->T[2]);
  change.placement = {{before->pose.parent, result->T[2].inverse()}, J * result->covariance.topLeftCorner<6, 6>() * J.transpose()};
  change.rms_px = result->rms_px;
  change.observations = used(*result);
  return SolvedAgain{{}, change};
}

}  // namespace

Result<SolvedAgain> solveAgain(const CalibrationRecord& record) {
  if (record.raw.empty()) return Error{ErrorCode::kNotFound, "There are no raw data with this calibration: it was made without any."};
  const auto raw = readTextFile(record.raw, 64u << 20);
  if (!raw) return raw.error();
  CameraChange camera;
  camera.camera = record.name;
  camera.kind = record.kind;
  camera.note = "solved again from " + record.id;
  camera.raw = *raw;
  camera.raw_ending = record.raw.substr(record.raw.find_last_of('.') + 1);
  PlaceChange place;
  place.subject = record.subject;
  place.name = record.name;
  place.note = camera.note;
  place.raw = camera.raw;
  place.raw_ending = camera.raw_ending;
  if (record.subject == Subject::kObject) return objectAgain(record, place);
  if (record.subject == Subject::kCamera && record.kind == "intrinsics") return intrinsicsAgain(record, camera);
  if (record.subject == Subject::kCamera && record.kind == "fixture") return fixtureAgain(record, camera);
  if (record.subject == Subject::kCamera && record.kind == "pose") return poseAgain(record, camera);
  return Error{ErrorCode::kRefused, "A calibration of kind \"" + record.kind + "\" is made anew on its own page: its answer depends on more than the clicks kept with it."};
}

}  // namespace longarm::session
