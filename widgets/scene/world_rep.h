#pragma once

/// @file
/// Draws bodies of the world: the workcell's fixed objects, sketched boxes, things held, a scenario's truth.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/pose.h"
#include "planning/world/shape.h"
#include "widgets/scene/representation.h"

namespace longarm::scene {

/// Surface of an object by name: "wood", "concrete", "metal", "checker", "carton", "noise"; other: plain colour.
using SurfaceNames = std::map<std::string, std::string>;   // object name -> surface

/// Bodies.  Shapes are rebuilt only where name, shape, colour or surface changed; otherwise matrices only.
class WorldRep final : public Representation {
 public:
  WorldRep();
  ~WorldRep() override;

  /// @param objects   what to draw; one whose attached_link is set stands in that link's frame.
  /// @param X_WL      poses of links by name, for attached objects; an object whose link is missing is hidden.
  /// @param surfaces  procedural pictures on objects.
  void update(const std::vector<planning::WorldObject>& objects, const std::map<std::string, Pose>& X_WL = {},
              const SurfaceNames& surfaces = {});
  /// Opacity of all objects, 0 ... 1.
  void setOpacity(double opacity);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::scene
