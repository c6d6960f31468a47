#include "planning/collision/near_kernel.h"

#include <cmath>

#include "vision/stereo/processor_clones.h"

namespace longarm::planning::internal {
namespace {

constexpr std::size_t kLane = 16;
constexpr float kFar = 1e6F;
constexpr double kRounding = 1e-4;       // single precision at ten metres, with room [m]

// One box against all, in single precision.
struct Look {
  float x, y, z, half_x, half_y, half_z;
};

LONGARM_PROCESSOR_CLONES
void compare(const float* x, const float* y, const float* z, const float* half_x, const float* half_y, const float* half_z,
             std::size_t count, Look look, const unsigned char* asked, unsigned char* near) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool in_x = std::fabs(x[i] - look.x) <= half_x[i] + look.half_x;
    const bool in_y = std::fabs(y[i] - look.y) <= half_y[i] + look.half_y;
    const bool in_z = std::fabs(z[i] - look.z) <= half_z[i] + look.half_z;
    near[i] = static_cast<unsigned char>(in_x & in_y & in_z & asked[i]);
  }
}

}  // namespace

void Boxes::resize(std::size_t count) {
  const std::size_t filled = (count + kLane - 1) / kLane * kLane;
  for (auto* values : {&x, &y, &z}) values->assign(filled, kFar);
  for (auto* values : {&half_x, &half_y, &half_z}) values->assign(filled, 0);
}

void Boxes::set(std::size_t i, const Eigen::Vector3d& center, const Eigen::Vector3d& half) {
  x[i] = static_cast<float>(center.x());
  y[i] = static_cast<float>(center.y());
  z[i] = static_cast<float>(center.z());
  half_x[i] = static_cast<float>(half.x());
  half_y[i] = static_cast<float>(half.y());
  half_z[i] = static_cast<float>(half.z());
}

void nearBoxes(const Boxes& boxes, std::size_t of, double reach, const unsigned char* asked, unsigned char* near) {
  const auto more = static_cast<float>(reach + kRounding);
  const Look look{boxes.x[of], boxes.y[of], boxes.z[of], boxes.half_x[of] + more, boxes.half_y[of] + more, boxes.half_z[of] + more};
  compare(boxes.x.data(), boxes.y.data(), boxes.z.data(), boxes.half_x.data(), boxes.half_y.data(), boxes.half_z.data(), boxes.padded(),
          look, asked, near);
}

}  // namespace longarm::planning::internal
