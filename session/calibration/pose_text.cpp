#include "session/calibration/pose_text.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "vision/camera/camera_file.h"

namespace longarm::session {

namespace {

nlohmann::json poseJson(const Pose& X) {
  const Eigen::Vector3d p = X.translation();
  const Eigen::Vector4d q = quaternionXyzw(X.linear());
  return {{"xyz", {p.x(), p.y(), p.z()}}, {"quaternion_xyzw", {q[0], q[1], q[2], q[3]}}};
}

}  // namespace

std::string poseText(const Pose& X) {
  const Eigen::Vector3d p = X.translation(), rpy = X.linear().eulerAngles(2, 1, 0).reverse();
  std::string out = "xyz";
  for (int i = 0; i < 3; ++i) out += " " + formatFixed(p[i], 4);
  out += " m, rpy";
  for (int i = 0; i < 3; ++i) out += " " + formatFixed(rpy[i], 5);
  return out + " rad";
}

std::string observationsText(const calibration::LoopProblem& problem, double sigma_px) {
  nlohmann::json views = nlohmann::json::array();
  for (const auto& view : problem.views) {
    nlohmann::json points = nlohmann::json::array();
    for (const auto& p : view.points) {
      points.push_back({{"xyz", {p.xyz.x(), p.xyz.y(), p.xyz.z()}}, {"u", p.pixel.x()}, {"v", p.pixel.y()}, {"sigma_m", p.sigma_m}});
    }
    views.push_back({{"name", view.name}, {"T_ext", poseJson(view.T_ext)}, {"T_kin", poseJson(view.T_kin)}, {"T_dev", poseJson(view.T_dev)},
                     {"T_obj", poseJson(view.T_obj)}, {"points", points}});
  }
  return nlohmann::json{{"camera", vision::toJson({problem.camera, {}, {}})}, {"sigma_px", sigma_px}, {"views", views}}.dump(2) + "\n";
}

}  // namespace longarm::session
