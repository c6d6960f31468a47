#include "session/task/synthetic_operator.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/text.h"

namespace longarm::session {
namespace {

// Two joints that turn some cameras; the rest of the robot stays.
class Aim {
 public:
  static Result<Aim> make(const planning::Workcell& workcell, const std::string& pan_tilt, const JointState& now) {
    Aim out;
    out.m_model = workcell.model.get();
    for (const auto& spec : workcell.pan_tilts) {
      if (spec.name != pan_tilt) continue;
      for (const auto& [joint, axis] : {std::pair(spec.pan_joint, &out.m_pan), std::pair(spec.tilt_joint, &out.m_tilt)}) {
        const auto index = workcell.model->jointIndex(joint);
        if (!index) return index.error();
        *axis = workcell.model->joints()[static_cast<std::size_t>(*index)];
      }
    }
    if (out.m_pan.q_index < 0 || out.m_tilt.q_index < 0) {
      return Error{ErrorCode::kNotFound, "the workcell has no pan-tilt \"" + pan_tilt + "\" that moves"};
    }
    out.m_q = workcell.model->neutral();
    workcell.model->assign(now, out.m_q);
    return out;
  }

  void carry(int link) { m_links.push_back(link); }

  // Sum of the squared angles between the cameras' axes and the point.
  double cost(const Eigen::Vector2d& angles, const Eigen::Vector3d& p_R) const {
    Eigen::VectorXd q = m_q;
    q[m_pan.q_index] = angles[0];
    q[m_tilt.q_index] = angles[1];
    double sum = 0;
    for (const int link : m_links) {
      const Pose X_RC = m_model->forward(q, link);
      const double angle = std::acos(std::clamp(X_RC.linear().col(2).dot((p_R - X_RC.translation()).normalized()), -1.0, 1.0));
      sum += angle * angle;
    }
    return sum;
  }

  // A grid over the limits, refined around its best point again and again.
  Eigen::Vector2d best(const Eigen::Vector3d& p_R) const {
    const auto limit = [](double v) { return std::clamp(v, -M_PI, M_PI); };
    const Eigen::Vector2d lower(limit(m_pan.lower), limit(m_tilt.lower)), upper(limit(m_pan.upper), limit(m_tilt.upper));
    Eigen::Vector2d center = 0.5 * (lower + upper), half = 0.5 * (upper - lower), found = center;
    constexpr int kGrid = 6, kRounds = 12;
    for (int round = 0; round < kRounds; ++round) {
      double least = cost(found, p_R);
      for (int i = -kGrid; i <= kGrid; ++i) {
        for (int k = -kGrid; k <= kGrid; ++k) {
          const Eigen::Vector2d at = (center + half.cwiseProduct(Eigen::Vector2d(i, k)) / kGrid).cwiseMax(lower).cwiseMin(upper);
          const double here = cost(at, p_R);
          if (here >= least) continue;
          least = here;
          found = at;
        }
      }
      center = found;
      half *= 2.0 / kGrid;
    }
    return found;
  }

 private:
  const planning::RobotModel* m_model = nullptr;
  planning::Joint m_pan, m_tilt;
  Eigen::VectorXd m_q;
  std::vector<int> m_links;
};

}  // namespace

Result<std::pair<std::string, std::string>> measuringPair(const planning::Workcell& workcell) {
  for (const auto& camera : workcell.cameras) {
    if (camera.role == "stereo_left" && workcell.camera(camera.stereo_partner) != nullptr) {
      return std::pair(camera.name, camera.stereo_partner);
    }
  }
  std::vector<std::string> aimed;
  for (const auto& camera : workcell.cameras) {
    if (camera.role == "ptz") aimed.push_back(camera.name);
  }
  if (aimed.size() < 2) {
    return Error{ErrorCode::kNotFound, "the workcell " + workcell.name + " has neither a stereo head nor two pan-tilt cameras"};
  }
  return std::pair(aimed[0], aimed[1]);
}

Result<std::vector<AimWish>> aimAt(const planning::Workcell& workcell, const std::vector<std::string>& cameras,
                                   const Eigen::Vector3d& p_R, const JointState& now) {
  std::map<std::string, Aim> aims;
  for (const auto& name : cameras) {
    const auto* camera = workcell.camera(name);
    if (camera == nullptr || camera->pan_tilt.empty()) {
      return Error{ErrorCode::kNotFound, "no pan-tilt aims camera \"" + name + "\""};
    }
    if (aims.count(camera->pan_tilt) == 0) {
      auto aim = Aim::make(workcell, camera->pan_tilt, now);
      if (!aim) return aim.error();
      aims.emplace(camera->pan_tilt, *aim);
    }
    const auto link = workcell.model->linkIndex(camera->link);
    if (!link) return link.error();
    aims.at(camera->pan_tilt).carry(*link);
  }
  std::vector<AimWish> out;
  for (const auto& [name, aim] : aims) {
    const Eigen::Vector2d angles = aim.best(p_R);
    out.push_back({name, angles[0], angles[1]});
  }
  return out;
}

Result<Eigen::Vector2d> SyntheticHand::click(const vision::CameraModel& camera, const Pose& X_WC,
                                             const Eigen::Vector3d& p_W) {
  const auto pixel = camera.project(X_WC.inverse() * p_W);
  if (!pixel) return pixel.error();
  if (!camera.containsPixel(*pixel)) {
    return Error{ErrorCode::kDegenerate, "the point lies at " + formatFixed(pixel->x(), 0) + ", " +
                                             formatFixed(pixel->y(), 0) + " px, outside the picture of " + camera.name};
  }
  std::normal_distribution<double> tremble(0, 1);
  const double u = tremble(m_random), v = tremble(m_random);
  return Eigen::Vector2d(*pixel + m_sigma_px * Eigen::Vector2d(u, v));
}

}  // namespace longarm::session
