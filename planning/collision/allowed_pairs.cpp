#include <map>
#include <random>

#include "planning/collision/collision_bodies.h"
#include "planning/collision/collision_world.h"

namespace longarm::planning {
namespace {

constexpr double kAlwaysShare = 0.95;

std::pair<int, int> ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// Top link of the rigid piece that each link belongs to.
std::vector<int> rigidPieces(const RobotModel& model) {
  std::vector<int> piece(model.links().size());
  const auto top = [&model](int link) {
    while (true) {
      const int j = model.links()[static_cast<std::size_t>(link)].parent_joint;
      if (j < 0 || model.joints()[static_cast<std::size_t>(j)].type != JointType::kFixed) return link;
      link = model.joints()[static_cast<std::size_t>(j)].parent_link;
    }
  };
  for (std::size_t i = 0; i < piece.size(); ++i) piece[i] = top(static_cast<int>(i));
  return piece;
}

void addRigid(const RobotModel& model, AllowedPairs& out) {
  const std::vector<int> piece = rigidPieces(model);
  for (std::size_t i = 0; i < piece.size(); ++i) {
    for (std::size_t j = i + 1; j < piece.size(); ++j) {
      if (piece[i] == piece[j]) out.emplace(static_cast<int>(i), static_cast<int>(j));
    }
  }
}

void addNeighbours(const RobotModel& model, AllowedPairs& out) {
  for (std::size_t i = 0; i < model.links().size(); ++i) {
    int link = static_cast<int>(i);
    do {
      const int j = model.links()[static_cast<std::size_t>(link)].parent_joint;
      link = j < 0 ? -1 : model.joints()[static_cast<std::size_t>(j)].parent_link;
    } while (link >= 0 && model.links()[static_cast<std::size_t>(link)].collisions.empty());
    if (link >= 0) out.insert(ordered(link, static_cast<int>(i)));
  }
}

Eigen::VectorXd randomConfiguration(const RobotModel& model, std::mt19937_64& engine) {
  Eigen::VectorXd q(model.dof());
  for (int i = 0; i < model.dof(); ++i) {
    const Joint& joint = model.joints()[static_cast<std::size_t>(model.actuatedJoints()[static_cast<std::size_t>(i)])];
    const double low = std::max(joint.lower, -M_PI), high = std::min(joint.upper, M_PI);
    const double unit = static_cast<double>(engine() >> 11) * 0x1.0p-53;
    q[i] = low <= high ? low + unit * (high - low) : joint.lower;
  }
  return q;
}

void addAlwaysTouching(const std::shared_ptr<const RobotModel>& model, unsigned seed, int samples, AllowedPairs& out) {
  CollisionWorld::Impl world;
  world.model = model;
  world.addLinkBodies();
  world.addPairs(out);
  std::map<std::pair<int, int>, int> touched;
  std::mt19937_64 engine(seed);
  internal::PlacedState state;
  for (int k = 0; k < samples; ++k) {
    world.placeAll(randomConfiguration(*model, engine), state);
    std::set<std::pair<int, int>> now;
    for (const auto& pair : world.pairs) {
      if (pair.allowed || world.bound(pair, state) > 0) continue;
      const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
      if (!internal::fclTouch(*world.bodies[a].geometry, state.poses[a], *world.bodies[b].geometry, state.poses[b])) continue;
      now.insert(ordered(world.bodies[a].link, world.bodies[b].link));
    }
    for (const auto& pair : now) ++touched[pair];
  }
  for (const auto& [pair, count] : touched) {
    if (count >= kAlwaysShare * samples) out.insert(pair);
  }
}

}  // namespace

AllowedPairs allowedPairs(const std::shared_ptr<const RobotModel>& model, unsigned seed, int samples) {
  AllowedPairs out;
  addRigid(*model, out);
  if (model->srdfAllowedPairs()) {
    out.insert(model->srdfAllowedPairs()->begin(), model->srdfAllowedPairs()->end());
    return out;
  }
  addNeighbours(*model, out);
  addAlwaysTouching(model, seed, samples, out);
  return out;
}

AllowedPairs allowedPairs(const Workcell& workcell) {
  AllowedPairs pairs = allowedPairs(workcell.model);
  std::vector<int> links;
  for (const auto& name : workcell.gripper ? workcell.gripper->links : std::vector<std::string>{}) {
    if (const auto link = workcell.model->linkIndex(name)) links.push_back(*link);
  }
  for (const int a : links) {
    for (const int b : links) {
      if (a < b) pairs.insert({a, b});
    }
  }
  return pairs;
}

}  // namespace longarm::planning
