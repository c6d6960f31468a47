#pragma once

/// @file
/// LineTool: marks the two ends of a line in both pictures.

#include "session/tools/draw_tool.h"

namespace longarm::session {

/// States and gestures: DrawTool.
class LineTool final : public DrawTool {
 public:
  LineTool() : DrawTool(vision::FeatureKind::kLine) {}
  ToolKind kind() const override { return ToolKind::kLine; }

 protected:
  std::string vertexName(int vertex) const override { return "end " + std::to_string(vertex + 1); }
  Eigen::Vector2d startPlace(int vertex) const override { return {vertex == 0 ? 0.35 : 0.65, 0.5}; }
};

}  // namespace longarm::session
