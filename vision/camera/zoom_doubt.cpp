#include "vision/camera/zoom_doubt.h"

#include <algorithm>
#include <cmath>

namespace longarm::vision {
namespace {

constexpr std::size_t kNearest = 3;
constexpr double kShare = 1 / 1.5;                 // Of a squared miss that is a setting's own.
constexpr Eigen::Index kNumbers = 10, kFx = 0, kFy = 1, kCx = 3;

}  // namespace

std::vector<ZoomPrediction> predictFromOthers(const ZoomCamera& camera) {
  auto nodes = camera.nodes;
  std::sort(nodes.begin(), nodes.end(), [](const ZoomNode& a, const ZoomNode& b) { return a.zoom < b.zoom; });
  std::vector<ZoomPrediction> out;
  for (std::size_t k = 1; k + 1 < nodes.size(); ++k) {
    ZoomCamera others{camera.name, nodes};
    others.nodes.erase(others.nodes.begin() + static_cast<std::ptrdiff_t>(k));
    if (const auto predicted = zoomAt(others, nodes[k].zoom)) out.push_back({nodes[k], *predicted});
  }
  return out;
}

std::optional<Eigen::MatrixXd> lensDoubt(const std::vector<ZoomPrediction>& predictions, const ZoomNode& node) {
  std::vector<const ZoomPrediction*> measured;
  for (const auto& prediction : predictions) {
    if (!isNominal(prediction.truth)) measured.push_back(&prediction);
  }
  if (measured.empty()) return std::nullopt;
  const auto away = [&](const ZoomPrediction* p) { return std::abs(p->truth.zoom - node.zoom); };
  std::sort(measured.begin(), measured.end(), [&](const auto* a, const auto* b) { return away(a) < away(b); });
  if (measured.size() > kNearest) measured.resize(kNearest);
  double focal = 0;
  Eigen::Vector2d boresight = Eigen::Vector2d::Zero();
  for (const auto* prediction : measured) {
    // In pixels of the wanted setting: a turn of the axis is magnified as everything else.
    const Eigen::Vector2d miss = prediction->boresightError() * (node.interior[0] / prediction->truth.interior[0]);
    focal += prediction->focalError() * prediction->focalError();
    boresight += miss.cwiseAbs2();
  }
  const double share = kShare / static_cast<double>(measured.size());
  const Eigen::Vector2d f(node.interior[0], node.interior[1]);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(kNumbers, kNumbers);
  out.block<2, 2>(kFx, kFx) = share * focal * f * f.transpose();
  out.block<2, 2>(kCx, kCx) = (share * boresight).asDiagonal();
  static_assert(kFy == kFx + 1);
  return out;
}

}  // namespace longarm::vision
