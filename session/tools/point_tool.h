#pragma once

/// @file
/// PointTool: marks one point in both pictures.

#include "session/tools/draw_tool.h"

namespace longarm::session {

/// States and gestures: DrawTool.
class PointTool final : public DrawTool {
 public:
  PointTool() : DrawTool(vision::FeatureKind::kPoint) {}
  ToolKind kind() const override { return ToolKind::kPoint; }

 protected:
  std::string vertexName(int) const override { return "the point"; }
  Eigen::Vector2d startPlace(int) const override { return {0.5, 0.5}; }
};

}  // namespace longarm::session
