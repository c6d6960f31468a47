#pragma once

/// @file
/// A robot that is where it is told to be at once, as snapshots, aiming and zooming see it.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planning/world/workcell.h"
#include "session/controllers/robot_feed.h"

namespace longarm::testing {

class StillRobot final : public session::RobotFeed {
 public:
  /// All joints stand in the middle of their travel, or at 0 where that is within it.
  explicit StillRobot(std::shared_ptr<const planning::Workcell> workcell) : m_workcell(std::move(workcell)) {
    const auto& model = *m_workcell->model;
    m_state.names = model.actuatedNames();
    m_state.positions = model.neutral();
    m_state.velocities = Eigen::VectorXd::Zero(m_state.positions.size());
    for (const auto& camera : m_workcell->cameras) {
      if (camera.zooms) m_zoom[camera.name] = 0;
    }
  }

  double now_s() const override { return time_s; }
  std::shared_ptr<const hardware::Frame> latestFrame(const std::string&) const override { return nullptr; }
  std::shared_ptr<const JointState> jointState() const override { return std::make_shared<const JointState>(m_state); }
  Result<JointState> jointStateAt(double) const override { return m_state; }
  Status movePanTilt(const std::string& pan_tilt, double pan, double tilt) override {
    ++turns;
    for (const auto& spec : m_workcell->pan_tilts) {
      if (spec.name != pan_tilt) continue;
      setJoint(spec.pan_joint, pan);
      setJoint(spec.tilt_joint, tilt);
      return {};
    }
    return {ErrorCode::kNotFound, "no pan-tilt " + pan_tilt};
  }
  Result<std::optional<double>> zoomAt(const std::string& camera, double) const override {
    const auto found = m_zoom.find(camera);
    return found == m_zoom.end() ? std::optional<double>() : std::optional<double>(found->second);
  }
  Status setZoom(const std::string& camera, double zoom01) override {
    if (m_zoom.count(camera) == 0) return {ErrorCode::kRefused, camera + " has no zoom"};
    m_zoom[camera] = zoom01;
    ++zooms;
    return {};
  }
  Status setFocus(const std::string& camera, double focus01) override {
    m_focus[camera] = focus01;
    return {};
  }
  Status focusItself(const std::string& camera) override {
    m_focus[camera] = -1;
    return {};
  }
  std::optional<double> focus(const std::string& camera) const override {
    const auto found = m_focus.find(camera);
    return found == m_focus.end() ? 1.0 : found->second;
  }

  void setJoint(const std::string& name, double position) {
    for (std::size_t i = 0; i < m_state.names.size(); ++i) {
      if (m_state.names[i] == name) m_state.positions(static_cast<Eigen::Index>(i)) = position;
    }
  }
  double joint(const std::string& name) const { return m_state.position(name).value(); }
  const JointState& state() const { return m_state; }

  double time_s = 100;
  int turns = 0, zooms = 0;                // commands

 private:
  std::shared_ptr<const planning::Workcell> m_workcell;
  JointState m_state;
  std::map<std::string, double> m_zoom, m_focus;
};

}  // namespace longarm::testing
