#pragma once

/// @file
/// PipeTool: the line tool's option for round things: marks two outlines in both pictures, which give axis and radius.

#include "session/tools/draw_tool.h"

namespace longarm::session {

/// States and gestures: DrawTool.  Ends of an outline need not be the same places in both pictures, so no curve holds them.
class PipeTool final : public DrawTool {
 public:
  PipeTool() : DrawTool(vision::FeatureKind::kLine, true) {}
  ToolKind kind() const override { return ToolKind::kPipe; }

 protected:
  std::string vertexName(int vertex) const override {
    return std::string("end ") + (vertex % 2 == 0 ? "1" : "2") + " of the " + (vertex < 2 ? "first" : "second") + " outline";
  }
  Eigen::Vector2d startPlace(int vertex) const override { return {vertex % 2 == 0 ? 0.35 : 0.65, vertex < 2 ? 0.46 : 0.54}; }
};

}  // namespace longarm::session
