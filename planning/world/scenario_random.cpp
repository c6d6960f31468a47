#include <algorithm>
#include <cmath>
#include <random>

#include "planning/world/scenario.h"

namespace longarm::planning {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTableWidth = 0.26, kTableMargin = 0.05;  // across and beyond the pipe's ends [m]
constexpr double kPipeAboveTable = 0.13;                   // room for fingers under the pipe [m]
constexpr double kStandThickness = 0.022, kStandWidth = 0.05, kStandFromEnd = 0.015;
constexpr int kTries = 400;

/// Uniform numbers that are the same with every standard library.
class Draw {
 public:
  explicit Draw(unsigned seed) : m_engine(seed) {}
  double between(double a, double b) { return a + (b - a) * (static_cast<double>(m_engine()) / 4294967296.0); }

 private:
  std::mt19937 m_engine;
};

struct PipePlace {
  Vector3d middle = Vector3d::Zero();
  Vector3d direction = Vector3d::UnitX();   ///< Unit, along the pipe.
  double length = 0.3;

  Vector2d across() const { return Vector2d(-direction.y(), direction.x()).normalized(); }
  Vector2d along() const { return direction.head<2>().normalized(); }
};

PipePlace drawPlace(const RandomPipe& ranges, Draw& draw) {
  PipePlace place;
  const double distance = draw.between(ranges.min_distance, ranges.max_distance);
  const double bearing = draw.between(-ranges.max_bearing, ranges.max_bearing);
  const double height = draw.between(ranges.min_height, ranges.max_height);
  const double turn = draw.between(-ranges.max_turn, ranges.max_turn);
  const double slope = draw.between(-ranges.max_slope, ranges.max_slope);
  place.length = draw.between(ranges.min_length, ranges.max_length);
  place.middle = {distance * std::cos(bearing), distance * std::sin(bearing), height};
  const double heading = bearing + M_PI / 2 + turn;
  place.direction = {std::cos(slope) * std::cos(heading), std::cos(slope) * std::sin(heading), std::sin(slope)};
  return place;
}

/// Whether the table (a rectangle) and the box keep apart, by separating axes.
bool tableIsClear(const PipePlace& place, const Eigen::Vector4d& box) {
  const Vector2d half_table(place.length / 2 + kTableMargin, kTableWidth / 2);
  const Vector2d u = place.along(), v = place.across();
  const Vector2d center = (box.head<2>() + box.tail<2>()) / 2, half_box = (box.tail<2>() - box.head<2>()) / 2;
  const Vector2d offset = place.middle.head<2>() - center;
  const auto apart = [&](const Vector2d& axis) {
    const double reach = half_table.x() * std::abs(u.dot(axis)) + half_table.y() * std::abs(v.dot(axis)) +
                         half_box.x() * std::abs(axis.x()) + half_box.y() * std::abs(axis.y());
    return std::abs(offset.dot(axis)) > reach;
  };
  return apart(Vector2d::UnitX()) || apart(Vector2d::UnitY()) || apart(u) || apart(v);
}

PipePlace drawClearPlace(const RandomPipe& ranges, Draw& draw) {
  PipePlace place = drawPlace(ranges, draw);
  for (int i = 0; i < kTries && !tableIsClear(place, ranges.keep_clear); ++i) place = drawPlace(ranges, draw);
  return place;
}

WorldObject* find(Scenario& scenario, const std::string& name) {
  for (ScenarioObject& object : scenario.objects) {
    if (object.body.name == name) return &object.body;
  }
  return nullptr;
}

/// A body standing upright, turned with the pipe, with its middle at `center`.
Pose uprightAt(const Vector3d& center, const PipePlace& place) {
  return poseFromRpy(center, {0, 0, std::atan2(place.direction.y(), place.direction.x())});
}

void placePipe(Scenario& scenario, const RandomPipe& names, const PipePlace& place) {
  WorldObject* pipe = find(scenario, names.object);
  auto* cylinder = pipe == nullptr ? nullptr : std::get_if<Cylinder>(&pipe->shape);
  if (cylinder == nullptr) return;
  cylinder->length = place.length;
  pipe->X_WO.linear() = rotationWithZ(place.direction);
  pipe->X_WO.translation() = place.middle;
}

/// The table's slab; @returns the height of its upper face.
double placeTable(Scenario& scenario, const RandomPipe& names, const PipePlace& place) {
  WorldObject* table = find(scenario, names.table);
  auto* slab = table == nullptr ? nullptr : std::get_if<Box>(&table->shape);
  if (slab == nullptr) return 0;
  const double thickness = slab->size.z();
  const double top = std::max(place.middle.z() - kPipeAboveTable, thickness + 0.02);
  slab->size = {place.length + 2 * kTableMargin, kTableWidth, thickness};
  table->X_WO = uprightAt({place.middle.x(), place.middle.y(), top - thickness / 2}, place);
  return top;
}

void placeLegs(Scenario& scenario, const RandomPipe& names, const PipePlace& place, double underside) {
  const double x = place.length / 2 + kTableMargin - 0.03, y = kTableWidth / 2 - 0.03;
  const Vector2d corners[4] = {{x, y}, {x, -y}, {-x, y}, {-x, -y}};
  for (std::size_t i = 0; i < names.legs.size() && i < 4; ++i) {
    WorldObject* leg = find(scenario, names.legs[i]);
    auto* post = leg == nullptr ? nullptr : std::get_if<Cylinder>(&leg->shape);
    if (post == nullptr) continue;
    post->length = std::max(underside, 0.005);
    const Vector2d at = place.middle.head<2>() + corners[i].x() * place.along() + corners[i].y() * place.across();
    leg->X_WO = uprightAt({at.x(), at.y(), post->length / 2}, place);
  }
}

void placeStands(Scenario& scenario, const RandomPipe& names, const PipePlace& place, double top, double radius) {
  const double reach = place.length / 2 - kStandFromEnd - kStandThickness / 2;
  for (std::size_t i = 0; i < names.stands.size(); ++i) {
    WorldObject* stand = find(scenario, names.stands[i]);
    auto* block = stand == nullptr ? nullptr : std::get_if<Box>(&stand->shape);
    if (block == nullptr) continue;
    const double s = names.stands.size() < 2 ? 0 : -1 + 2.0 * static_cast<double>(i) / static_cast<double>(names.stands.size() - 1);
    const Vector3d on_axis = place.middle + s * reach * place.direction;
    const double height = std::max(on_axis.z() - radius - top, 0.005);
    block->size = {kStandThickness, kStandWidth, height};
    stand->X_WO = uprightAt({on_axis.x(), on_axis.y(), top + height / 2}, place);
  }
}

}  // namespace

Scenario randomised(const Scenario& scenario, unsigned seed) {
  Scenario result = scenario;
  if (seed == 0 || !scenario.random_pipe) return result;
  const RandomPipe& names = *scenario.random_pipe;
  Draw draw(seed);
  const PipePlace place = drawClearPlace(names, draw);
  placePipe(result, names, place);
  const double top = placeTable(result, names, place);
  const WorldObject* table = find(result, names.table);
  const auto* slab = table == nullptr ? nullptr : std::get_if<Box>(&table->shape);
  placeLegs(result, names, place, slab == nullptr ? top : top - slab->size.z());
  const WorldObject* pipe = find(result, names.object);
  const auto* cylinder = pipe == nullptr ? nullptr : std::get_if<Cylinder>(&pipe->shape);
  placeStands(result, names, place, top, cylinder == nullptr ? 0 : cylinder->radius);
  return result;
}

}  // namespace longarm::planning
