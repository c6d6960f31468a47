#pragma once

/// @file
/// PlaneTool: marks two connected lines in both pictures; the corner they share is the second vertex.

#include "session/tools/draw_tool.h"

namespace longarm::session {

/// States and gestures: DrawTool.
class PlaneTool final : public DrawTool {
 public:
  PlaneTool() : DrawTool(vision::FeatureKind::kPlane) {}
  ToolKind kind() const override { return ToolKind::kPlane; }

 protected:
  std::string vertexName(int vertex) const override {
    return vertex == 1 ? "the shared corner" : "corner " + std::to_string(vertex + 1);
  }
  Eigen::Vector2d startPlace(int vertex) const override {
    return {vertex == 2 ? 0.62 : 0.38, vertex == 0 ? 0.36 : 0.62};
  }
};

}  // namespace longarm::session
