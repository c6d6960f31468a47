#include "app/virtual_robot/virtual_robot.h"

#include <algorithm>
#include <cmath>

#include "app/virtual_robot/shape_rays.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kRenderShare = 0.7;     // of the time, so that the console gets its part of the processor
constexpr double kFarthest_m = 100;
constexpr double kLongestRest_s = 0.3;   // counted of a picture that took long, as the first one does

// To what the middle of the picture shows: a body, the ground, or nothing far away [m].
double distanceAhead(const Pose& X_WC, const std::vector<planning::WorldObject>& objects) {
  const Eigen::Vector3d from = X_WC.translation(), ahead = X_WC.linear().col(2);
  double nearest = ahead.z() < -1e-6 && from.z() > 0 ? std::min(kFarthest_m, -from.z() / ahead.z()) : kFarthest_m;
  for (const auto& object : objects) {
    if (const auto there = rayDistance(object.shape, object.X_WO, from, ahead)) nearest = std::min(nearest, *there);
  }
  return nearest;
}

}  // namespace

Result<std::unique_ptr<VirtualRobot>> VirtualRobot::create(const RobotOptions& options, RobotOutlets outlets) {
  auto scenario = planning::loadScenario(options.scenario);
  if (!scenario) return scenario.error();
  if (!options.variant.empty()) scenario->variant = options.variant;
  if (options.ideal) scenario->imperfections = planning::Imperfections::none();
  const auto workcell = planning::workcellOf(*scenario);
  if (!workcell) return workcell.error();
  auto body = RobotBody::create(*workcell, *scenario, options.seed);
  if (!body) return body.error();
  auto rig = CameraRig::load(*workcell);
  if (!rig) return rig.error();
  for (const auto& object : scenario->objects) {
    if (object.before.empty() || rig->has(object.before)) continue;
    return Error{ErrorCode::kInvalidInput, scenario->path + ": object " + object.body.name + " is held before camera \"" + object.before + "\", which the robot does not have"};
  }
  return std::unique_ptr<VirtualRobot>(
      new VirtualRobot(options, std::move(outlets), std::move(*body), std::move(*rig)));
}

VirtualRobot::VirtualRobot(const RobotOptions& options, RobotOutlets outlets, std::unique_ptr<RobotBody> body,
                           CameraRig rig)
    : m_options(options), m_outlets(std::move(outlets)), m_body(std::move(body)), m_rig(std::move(rig)) {
  const WorldSnapshot start = m_body->snapshot();
  for (const auto& object : m_body->scenario().objects) {
    if (object.before.empty()) continue;
    m_spectators[object.before] = {start.X_WC.at(object.before) * m_rig.mount(object.before), m_rig.lens(object.before).fx};
  }
  showThings();
  std::function<void(double)> advance;
  if (options.lockstep) advance = [this](double seconds) { step(seconds); };
  m_services = std::make_unique<RobotServices>(*m_body, m_rig, advance, m_outlets.quit);
  m_protocol = std::make_unique<RobotProtocol>(*m_body, m_rig, *m_services, options.cameras, m_outlets.send);
  m_renderer = std::make_unique<RenderThread>(
      m_body->workcell(), m_body->scenario(), !options.lockstep, [this](Picture picture) { collect(std::move(picture)); },
      [this](std::string what) {
        {
          std::lock_guard<std::mutex> lock(m_mutex);
          m_complaints.push_back(std::move(what));
        }
        m_outlets.wake();
      });
}

void VirtualRobot::collect(Picture picture) {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_ready.push_back(std::move(picture));
  }
  m_outlets.wake();
}

void VirtualRobot::deliverPictures() {
  std::vector<Picture> ready;
  std::vector<std::string> complaints;
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    ready.swap(m_ready);
    complaints.swap(m_complaints);
  }
  for (auto& picture : ready) publish(std::move(picture));
  for (const auto& what : complaints) {
    m_outlets.log(what);
    m_protocol->tell("error", what);
  }
}

// A frozen camera goes on sending its last picture under new stamps.
void VirtualRobot::publish(Picture picture) {
  if (!m_body->faults().strikes("frozen_camera", picture.camera, usualCamera(m_body->workcell()))) {
    m_frozen[picture.camera] = picture.jpeg;
  } else if (const auto last = m_frozen.find(picture.camera); last != m_frozen.end()) {
    picture.jpeg = last->second;
  }
  m_protocol->publish(picture);
}

PictureRequest VirtualRobot::requestFor(const std::vector<std::string>& cameras) {
  PictureRequest request{m_body->snapshot(), {}};
  const FaultBoard& faults = static_cast<const RobotBody&>(*m_body).faults();
  const std::string usual = usualCamera(m_body->workcell());
  for (const auto& camera : cameras) {
    unsigned seed = m_options.seed;
    for (const char c : camera) seed = seed * 31 + static_cast<unsigned char>(c);
    Pose& X_WC = request.world.X_WC[camera];
    X_WC = X_WC * m_rig.mount(camera);
    const double distance = m_rig.zooms(camera) ? distanceAhead(X_WC, request.world.objects) : 1;
    m_rig.see(camera, distance);
    request.orders.push_back({camera, m_rig.lens(camera), m_body->scenario().imperfections.image_noise, seed,
                              faults.strikes("dark_camera", camera, usual), faults.strikes("glare", camera, usual),
                              m_rig.blur_px(camera, distance)});
  }
  return request;
}

// Pictures are exposed at the instants at which the joints are read.
void VirtualRobot::takePictures() {
  if (!m_options.cameras || !m_body->readingIsNew()) return;
  const double now_s = m_body->time_s();
  if (m_options.lockstep) {
    for (auto due = m_rig.takeDue(now_s); !due.empty(); due = m_rig.takeDue(now_s)) {
      m_renderer->request(requestFor(due));
      m_renderer->finish();
      deliverPictures();
    }
    return;
  }
  if (now_s < m_next_render_s || !m_renderer->idle()) return;
  const auto due = m_rig.takeDue(now_s);
  if (due.empty()) return;
  m_renderer->request(requestFor(due));
  m_next_render_s = now_s + std::min(m_renderer->lastDuration_s(), kLongestRest_s) / kRenderShare;
}

void VirtualRobot::showThings() {
  for (const auto& [camera, spectator] : m_spectators) m_body->showTo(camera, spectator.X_WC, m_rig.lens(camera).fx / spectator.fx);
}

void VirtualRobot::tick() {
  m_body->tick();
  m_rig.tick(RobotBody::kTick_s);
  showThings();
  m_protocol->afterTick();
  takePictures();
}

void VirtualRobot::step(double seconds) {
  const long ticks = std::max(1L, std::lround(seconds / RobotBody::kTick_s));
  for (long i = 0; i < ticks; ++i) tick();
}

void VirtualRobot::advanceTo(double robot_time_s) {
  if (m_options.lockstep) return;
  const double until_s = std::min(robot_time_s, m_body->time_s() + kMostAtOnce_s);
  while (m_body->time_s() + RobotBody::kTick_s <= until_s) tick();
}

}  // namespace longarm::virtual_robot
