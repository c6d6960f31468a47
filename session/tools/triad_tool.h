#pragma once

/// @file
/// TriadTool: marks the corner of a box and the ends of its three edges in both pictures.

#include "session/tools/draw_tool.h"

namespace longarm::session {

/// States and gestures: DrawTool.
class TriadTool final : public DrawTool {
 public:
  TriadTool() : DrawTool(vision::FeatureKind::kTriad) {}
  ToolKind kind() const override { return ToolKind::kTriad; }

 protected:
  std::string vertexName(int vertex) const override {
    return vertex == 0 ? "the common corner" : "the end of edge " + std::to_string(vertex);
  }
  Eigen::Vector2d startPlace(int vertex) const override {
    static const Eigen::Vector2d places[] = {{0.5, 0.52}, {0.34, 0.62}, {0.66, 0.62}, {0.5, 0.3}};
    return places[vertex];
  }
};

}  // namespace longarm::session
