#pragma once

/// @file
/// MeasureTool: distance between two vertices, or the angle at the second of three.

#include <optional>
#include <string>
#include <vector>

#include "session/document/dimension.h"
#include "session/tools/gesture_filter.h"
#include "session/tools/sketch_tool.h"

namespace longarm::session {

/// Writes nothing.  Vertices of any features, in either picture or in the scene.
///
/// | state    | event              | next     | answer                                            |
/// |----------|--------------------|----------|---------------------------------------------------|
/// | kFirst   | click on a handle  | kSecond  | takes it                                          |
/// | kSecond  | click on a handle  | kThird   | shows the distance                                |
/// | kThird   | click on a handle  | kDone    | shows the angle at the second                     |
/// | kDone    | click on a handle  | kSecond  | begins anew with it                               |
/// | any      | click elsewhere    | same     | hint                                              |
/// | kFirst   | Esc                | kFirst   | finished                                          |
/// | others   | Esc                | kFirst   | forgets what was taken                            |
class MeasureTool final : public SketchTool {
 public:
  enum class State { kFirst, kSecond, kThird, kDone };
  State state() const { return static_cast<State>(m_taken.size()); }

  ToolKind kind() const override { return ToolKind::kMeasure; }
  void activate(const Document& document) override;
  void deactivate() override;
  ToolReply onPointer(const vision::PointerEvent& event) override;
  ToolReply onKey(vision::SketchKey key, const vision::KeyModifiers& modifiers) override;
  ToolReply cancel() override;
  void documentChanged() override;
  std::vector<const SketchItem*> drafts() const override { return {}; }
  vision::Overlay preview(PaneSide side) const override;
  Handle activeHandle() const override { return {}; }
  void setActiveHandle(const Handle&) override {}
  bool busy() const override { return false; }
  std::optional<LiveMeasure> liveMeasure() const override { return std::nullopt; }
  std::optional<SceneDimension> dimension() const override;
  ToolReply onVertex(const VertexRef& vertex) override;
  std::string hint() const override;

 private:
  std::string nameOf(const VertexRef& ref) const;
  Result<Dimension> measured() const;
  std::optional<Eigen::Vector2d> placeIn(const vision::Snapshot& picture, const VertexRef& ref) const;

  const Document* m_document = nullptr;
  GestureFilter m_filter;
  std::vector<VertexRef> m_taken;          // At most three.
};

}  // namespace longarm::session
