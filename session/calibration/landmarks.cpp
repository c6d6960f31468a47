#include "session/calibration/landmarks.h"

#include <algorithm>
#include <array>
#include <variant>

namespace longarm::session {

namespace {

using planning::Box;
using planning::Cylinder;
using planning::Shape;

constexpr double kSame_m = 0.004;          // Corners nearer to each other than this cannot be told apart.
constexpr double kFeatureSigma_m = 0.002;

std::vector<Eigen::Vector3d> boxCorners(const Box& box) {
  std::vector<Eigen::Vector3d> out;
  for (const double z : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      for (const double x : {-0.5, 0.5}) out.push_back(Eigen::Vector3d(x, y, z).cwiseProduct(box.size));
    }
  }
  return out;
}

std::vector<Eigen::Vector3d> meshCorners(const planning::TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> out;
  if (mesh.vertices.empty()) return out;
  for (const auto& direction : boxCorners(Box{{1, 1, 1}})) {
    const Eigen::Vector3d* farthest = &mesh.vertices.front();
    for (const auto& v : mesh.vertices) {
      if (v.dot(direction) > farthest->dot(direction)) farthest = &v;
    }
    bool known = false;
    for (const auto& v : out) known = known || (v - *farthest).norm() < kSame_m;
    if (!known) out.push_back(*farthest);
  }
  return out;
}

std::vector<Eigen::Vector3d> cornersOf(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return boxCorners(*box);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return {{0, 0, -cylinder->length / 2}, {0, 0, cylinder->length / 2}};
  if (const auto* mesh = std::get_if<std::shared_ptr<const planning::TriangleMesh>>(&shape)) return *mesh ? meshCorners(**mesh) : std::vector<Eigen::Vector3d>{};
  return {};
}

void addCorners(const std::string& thing, const std::string& link, const Pose& X_LO, const Shape& shape, std::vector<Landmark>* out) {
  // A link may have several shapes: its corners are counted through.
  auto number = std::count_if(out->begin(), out->end(), [&](const Landmark& each) { return each.thing == thing; });
  for (const auto& corner : cornersOf(shape)) {
    Landmark mark;
    mark.name = thing + " corner " + std::to_string(++number);
    mark.thing = thing;
    mark.link = link;
    mark.xyz = corner;
    mark.X_LO = X_LO;
    out->push_back(mark);
  }
}

void addLinks(const planning::Workcell& workcell, std::vector<Landmark>* out) {
  Landmark tip;
  tip.name = tip.thing = tip.link = workcell.arm.tip_link;
  tip.name += " (between the fingers)";
  tip.xyz.setZero();
  out->push_back(tip);
  for (const auto& link : workcell.model->links()) {
    const auto& shapes = link.visuals.empty() ? link.collisions : link.visuals;
    for (const auto& shape : shapes) addCorners(link.name, link.name, shape.X_LS, shape.shape, out);
  }
}

void addFeatures(const Document& document, std::vector<Landmark>* out) {
  for (const auto& item : document.items()) {
    const auto& feature = document.measurement(item.id).feature;
    if (!feature) continue;
    for (std::size_t i = 0; i < feature->vertices.size(); ++i) {
      Landmark mark;
      mark.thing = item.name;
      mark.name = item.name + " vertex " + std::to_string(i + 1);
      mark.xyz = feature->vertices[i].xyz;
      mark.sigma_m = std::max(kFeatureSigma_m, std::sqrt(feature->vertices[i].covariance.trace() / 3));
      out->push_back(mark);
    }
  }
}

}  // namespace

Result<Eigen::Vector3d> Landmark::inRoot(const planning::RobotModel& model, const Eigen::VectorXd& q) const {
  const Eigen::Vector3d in_link = X_LO * xyz;
  if (link.empty()) return in_link;
  const auto index = model.linkIndex(link);
  if (!index) return index.error();
  return Eigen::Vector3d(model.forward(q, *index) * in_link);
}

std::vector<Landmark> landmarksOf(const planning::Workcell& workcell, const Document& document) {
  std::vector<Landmark> out;
  for (const auto& object : workcell.objects) addCorners(object.name, object.attached_link, object.X_WO, object.shape, &out);
  addFeatures(document, &out);
  if (workcell.model) addLinks(workcell, &out);
  return out;
}

}  // namespace longarm::session
