#pragma once

/// @file
/// What the `calibrate` verbs share.

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/verbs/cli.h"
#include "calibration/solve/lens_parameters.h"
#include "core/result.h"
#include "vision/camera/camera_file.h"

namespace longarm::app {

// One per file; `calibrate` is the parent.
void addIntrinsicsVerb(Cli& cli, CLI::App& calibrate);
void addFixtureVerb(Cli& cli, CLI::App& calibrate);
void addPoseVerb(Cli& cli, CLI::App& calibrate);
void addStereoVerb(Cli& cli, CLI::App& calibrate);
void addZoomVerb(Cli& cli, CLI::App& calibrate);
void addCompareVerb(Cli& cli, CLI::App& calibrate);

/// {"fx": 1.2, ...}: square roots of the diagonal, of the estimated parameters only.
nlohmann::json lensSigmaJson(const Eigen::MatrixXd& covariance, const calibration::LensMask& estimated);
/// Row-major list of all entries.
nlohmann::json matrixRowsJson(const Eigen::MatrixXd& matrix);
/// Square roots of the diagonal, as a list.
nlohmann::json sigmaListJson(const Eigen::MatrixXd& covariance);
/// Rows "fx  533.0  +-0.4" for people.
std::string lensTable(const vision::CameraModel& camera, const Eigen::MatrixXd& covariance,
                      const calibration::LensMask& estimated);
std::string warningLines(const std::vector<std::string>& warnings);

/// "WIDTHxHEIGHT" as two whole numbers from `low` to `high`; kInvalidInput naming `option`.
Result<std::pair<int, int>> sizeOption(const std::string& option, const std::string& text, int low, int high);
/// 0, 2, 4 or 5 (5 only if `k3`); -1 means left open.
Status checkDistortion(int value, bool k3);
/// A file written beside and renamed, unless `path` is empty; the message names the option.
Status saveCamera(const std::string& path, const vision::CameraFile& file);

}  // namespace longarm::app
