// calibrate pose
#include <cmath>

#include "app/verbs/calibrate_verbs.h"
#include "calibration/pose/observations_file.h"
#include "calibration/pose/solve_loop.h"
#include "core/text.h"

namespace longarm::app {
namespace {

using calibration::LoopOptions;
using calibration::LoopResult;
using calibration::LoopUnknown;

constexpr double kDegrees = 180 / 3.14159265358979323846;

struct Options {
  std::string observations, solve, also, sigma_px, kin_sigma, out;
  bool skew = false, plain = false;
  int distortion = -1;
};

std::size_t indexOf(LoopUnknown unknown) {
  return unknown == LoopUnknown::kExt ? 0 : unknown == LoopUnknown::kDev ? 1 : 2;
}

Result<std::vector<LoopUnknown>> unknownsOf(const Options& options) {
  const auto first = calibration::loopUnknownFromText(options.solve);
  if (!first) return Error{first.error().code, "--solve: " + first.error().message};
  std::vector<LoopUnknown> out = {*first};
  if (options.also.empty()) return out;
  for (const auto& word : split(options.also, ',')) {
    const auto unknown = calibration::loopUnknownFromText(std::string(trimmed(word)));
    if (!unknown) return Error{unknown.error().code, "--also: " + unknown.error().message};
    out.push_back(*unknown);
  }
  return out;
}

// "0.0005,0.00087": metres and radians.
Result<std::optional<calibration::KinPrior>> priorOf(const std::string& text) {
  if (text.empty()) return std::optional<calibration::KinPrior>();
  const auto numbers = numbersOption("--kin-sigma", text);
  if (!numbers) return numbers.error();
  if (numbers->size() != 2 || !((*numbers)[0] > 0) || !((*numbers)[1] > 0)) {
    return Error{ErrorCode::kInvalidInput, "--kin-sigma: write two numbers above 0, metres,radians (1 sigma per axis)"};
  }
  return std::optional<calibration::KinPrior>(calibration::KinPrior{(*numbers)[1], (*numbers)[0]});
}

Result<LoopOptions> loopOptions(const Options& options, const std::vector<LoopUnknown>& unknowns, const calibration::Observations& file) {
  LoopOptions out;
  out.unknowns = unknowns;
  out.starts = file.given;
  out.has_camera_start = file.has_camera;
  out.sigma_px = file.sigma_px;
  out.robust = !options.plain;
  if (!options.sigma_px.empty()) {
    const auto sigma = numbersOption("--sigma-px", options.sigma_px);
    if (!sigma) return sigma.error();
    if (sigma->size() != 1 || !((*sigma)[0] > 0)) return Error{ErrorCode::kInvalidInput, "--sigma-px: write one number of pixels above 0"};
    out.sigma_px = (*sigma)[0];
  }
  const auto prior = priorOf(options.kin_sigma);
  if (!prior) return prior.error();
  out.kin_prior = *prior;
  if (options.distortion >= 0) out.lens.distortion = options.distortion;
  if (options.skew) out.lens.skew = true;
  return out;
}

nlohmann::json transformJson(const calibration::Observations& file, const LoopResult& result, LoopUnknown unknown) {
  return poseJson({file.parents[indexOf(unknown)], result.T[indexOf(unknown)]});
}

nlohmann::json observationsJson(const calibration::LoopProblem& problem, const LoopResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& o : result.observations) {
    const auto& view = problem.views[static_cast<std::size_t>(o.view)];
    const double miss = o.residual_px.norm();
    nlohmann::json one = {{"view", view.name}, {"point", o.point}, {"leverage", o.leverage}, {"used", o.used}};
    one["residual_px"] = std::isfinite(miss) ? nlohmann::json(miss) : nlohmann::json(nullptr);
    if (std::isfinite(miss)) one["error_px"] = {o.residual_px.x(), o.residual_px.y()};
    if (o.leave_one_out_px >= 0 && std::isfinite(o.leave_one_out_px)) one["leave_one_out_px"] = o.leave_one_out_px;
    out.push_back(one);
  }
  return out;
}

nlohmann::json alternativesJson(const calibration::Observations& file, const LoopResult& result, LoopUnknown unknown) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& a : result.alternatives) {
    out.push_back({{"transform", poseJson({file.parents[indexOf(unknown)], a.T})}, {"rms_px", a.rms_px}});
  }
  return out;
}

// Rows of the covariance that belong to the i-th unknown.
Eigen::MatrixXd blockOf(const LoopResult& result, const std::vector<LoopUnknown>& unknowns, std::size_t which) {
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < which; ++i) at += unknowns[i] == LoopUnknown::kIntrinsics ? result.lens.count() : 6;
  const Eigen::Index size = unknowns[which] == LoopUnknown::kIntrinsics ? result.lens.count() : 6;
  return result.covariance.block(at, at, size, size);
}

// The ten-parameter covariance from that of the free ones.
Eigen::MatrixXd lensCovariance(const Eigen::MatrixXd& of_free, const calibration::LensMask& lens) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(calibration::kLensParameters, calibration::kLensParameters);
  const auto free = lens.indices();
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < free.size(); ++j) out(free[i], free[j]) = of_free(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
  return out;
}

void addUnknown(const calibration::Observations& file, const LoopResult& result, const std::vector<LoopUnknown>& unknowns, std::size_t which,
                nlohmann::json* json, std::string* table) {
  const LoopUnknown unknown = unknowns[which];
  Eigen::MatrixXd covariance = blockOf(result, unknowns, which);
  nlohmann::json value, sigma;
  if (unknown == LoopUnknown::kIntrinsics) {
    covariance = lensCovariance(covariance, result.lens);
    value = vision::toJson({result.camera, {}, covariance});
    sigma = lensSigmaJson(covariance, result.lens);
    *table += lensTable(result.camera, covariance, result.lens);
    (*json)["camera"] = value;
  } else {
    value = transformJson(file, result, unknown);
    sigma = sigmaListJson(covariance);
    const Pose& T = result.T[indexOf(unknown)];
    const Eigen::Vector3d turn = logSO3(T.linear()) * kDegrees;
    *table += std::string(calibration::toString(unknown)) + ": xyz " + formatFixed(T.translation().x(), 4) + " " + formatFixed(T.translation().y(), 4) +
              " " + formatFixed(T.translation().z(), 4) + " m, rotation vector " + formatFixed(turn.x(), 3) + " " + formatFixed(turn.y(), 3) + " " +
              formatFixed(turn.z(), 3) + " degrees; +-" + formatFixed(kDegrees * std::sqrt(covariance.topLeftCorner<3, 3>().trace()), 3) +
              " degrees, +-" + formatFixed(1e3 * std::sqrt(covariance.bottomRightCorner<3, 3>().trace()), 2) + " mm (1 sigma)\n";
    (*json)["transforms"][calibration::toString(unknown)] = value;
  }
  if (which == 0) {
    if (unknown != LoopUnknown::kIntrinsics) (*json)["transform"] = value;
    (*json)["sigma"] = sigma;
    (*json)["covariance"] = matrixRowsJson(covariance);
  } else {
    (*json)["also"][calibration::toString(unknown)] = {{"sigma", sigma}, {"covariance", matrixRowsJson(covariance)}};
  }
}

std::string misfitsTable(const calibration::LoopProblem& problem, const LoopResult& result) {
  std::vector<std::vector<std::string>> rows = {{"view", "point", "residual px", "leverage", "used"}};
  for (const auto& o : result.observations) {
    rows.push_back({problem.views[static_cast<std::size_t>(o.view)].name, std::to_string(o.point + 1), formatFixed(o.residual_px.norm(), 2),
                    formatFixed(o.leverage, 2), o.used ? "yes" : "no"});
  }
  return tableText(rows);
}

Result<Answer> answerOf(const Options& options, const calibration::Observations& file, const std::vector<LoopUnknown>& unknowns,
                        const LoopResult& result) {
  nlohmann::json json = {{"solve", options.solve}, {"rms_px", result.rms_px}, {"sigma_px", result.sigma_px}, {"reduced_chi2", result.reduced_chi2},
                         {"iterations", result.iterations}, {"observability", vectorJson(result.observability)}, {"weakest", result.weakest},
                         {"per_observation", observationsJson(file.problem, result)}, {"warnings", result.warnings}};
  std::string table;
  for (std::size_t i = 0; i < unknowns.size(); ++i) addUnknown(file, result, unknowns, i, &json, &table);
  if (unknowns.size() == 1 && unknowns[0] != LoopUnknown::kIntrinsics) json["alternatives"] = alternativesJson(file, result, unknowns[0]);
  if (!options.out.empty()) {
    if (!json.contains("camera")) return Error{ErrorCode::kInvalidInput, "--out: a camera file can be written only when C_int is solved"};
    const auto camera = vision::cameraFromJson(json["camera"]);
    if (!camera) return camera.error();
    if (auto status = saveCamera(options.out, *camera); !status) return status.error();
  }
  table += "rms " + formatFixed(result.rms_px, 3) + " px per component; weakest: " + result.weakest + "\n" + misfitsTable(file.problem, result) +
           warningLines(result.warnings);
  return Answer{json, table, kExitDone};
}

Result<Answer> run(const Options& options) {
  if (auto status = checkDistortion(options.distortion, true); !status) return status.error();
  const auto unknowns = unknownsOf(options);
  if (!unknowns) return unknowns.error();
  const auto file = calibration::readObservations(options.observations, *unknowns);
  if (!file) return file.error();
  const auto how = loopOptions(options, *unknowns, *file);
  if (!how) return how.error();
  const auto result = calibration::solveLoop(file->problem, *how);
  if (!result) return Error{result.error().code, options.observations + ": " + result.error().message};
  return answerOf(options, *file, *unknowns, *result);
}

}  // namespace

void addPoseVerb(Cli& cli, CLI::App& calibrate) {
  cli.addVerb<Options>(
      calibrate, "pose", "Any unknown of the transform loop camera - mount - device - object, from points seen in views",
      "longarm calibrate pose --observations observations.json --solve T_ext --also T_obj --json",
      [](CLI::App& verb, Options& options) {
        verb.add_option("--observations", options.observations, "Views with transforms and points (observations.json)")->required();
        verb.add_option("--solve", options.solve, "What is unknown: T_ext, T_dev, T_obj or C_int")->required();
        verb.add_option("--also", options.also, "Further unknowns, solved together, with commas between");
        verb.add_option("--sigma-px", options.sigma_px, "Noise of a pixel per axis; left out: from the file or the residuals");
        verb.add_option("--kin-sigma", options.kin_sigma, "Lets T_kin of each view err by metres,radians (1 sigma per axis)");
        verb.add_option("--distortion", options.distortion, "With C_int: estimate exactly 0, 2, 4 or 5 coefficients");
        verb.add_flag("--skew", options.skew, "With C_int: estimate the skew too");
        verb.add_flag("--plain", options.plain, "Plain least squares over all observations, none left out");
        verb.add_option("--out", options.out, "With C_int: camera file to write");
      },
      run);
}

}  // namespace longarm::app
