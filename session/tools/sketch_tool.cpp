#include "session/tools/sketch_tool.h"

#include "session/tools/line_tool.h"
#include "session/tools/measure_tool.h"
#include "session/tools/pipe_tool.h"
#include "session/tools/plane_tool.h"
#include "session/tools/point_tool.h"
#include "session/tools/select_tool.h"
#include "session/tools/triad_tool.h"

namespace longarm::session {

std::unique_ptr<SketchTool> makeTool(ToolKind kind) {
  switch (kind) {
    case ToolKind::kSelect: return std::make_unique<SelectTool>();
    case ToolKind::kPoint: return std::make_unique<PointTool>();
    case ToolKind::kLine: return std::make_unique<LineTool>();
    case ToolKind::kPipe: return std::make_unique<PipeTool>();
    case ToolKind::kMeasure: return std::make_unique<MeasureTool>();
    case ToolKind::kPlane: return std::make_unique<PlaneTool>();
    case ToolKind::kTriad: return std::make_unique<TriadTool>();
  }
  return std::make_unique<SelectTool>();
}

}  // namespace longarm::session
