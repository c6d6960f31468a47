// A build without a window has no panes to measure.
#include "tests/benchmarks/gate.h"

namespace longarm::benchmarks {

std::vector<Contest> paneContests(std::map<std::string, std::string>* skipped) {
  (*skipped)["video_pane"] = "this build has no window (LONGARM_BUILD_GUI=OFF)";
  return {};
}

std::vector<Budget> paneBudgets(std::map<std::string, std::string>* skipped) {
  for (const char* name : {"drag_to_repaint", "click_to_text"}) (*skipped)[name] = "this build has no window (LONGARM_BUILD_GUI=OFF)";
  return {};
}

std::vector<Budget> sceneBudgets(std::map<std::string, std::string>* skipped) {
  for (const char* name : {"own_links", "click_to_scene"}) (*skipped)[name] = "this build has no window (LONGARM_BUILD_GUI=OFF)";
  return {};
}

}  // namespace longarm::benchmarks
