#include "vision/snapshot/view.h"

namespace longarm::vision {

Result<Eigen::Vector2d> View::project(const Eigen::Vector3d& p_W) const {
  return camera.project(X_WC.linear().transpose() * (p_W - X_WC.translation()));
}

}  // namespace longarm::vision
