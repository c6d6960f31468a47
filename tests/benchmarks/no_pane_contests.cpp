// A build without a window has no panes to measure.
#include "tests/benchmarks/gate.h"

namespace longarm::benchmarks {

std::vector<Contest> paneContests(std::map<std::string, std::string>* skipped) {
  (*skipped)["video_pane"] = "this build has no window (LONGARM_BUILD_GUI=OFF)";
  return {};
}

std::vector<Budget> paneBudgets(std::map<std::string, std::string>* skipped) {
  (*skipped)["drag_to_repaint"] = "this build has no window (LONGARM_BUILD_GUI=OFF)";
  return {};
}

}  // namespace longarm::benchmarks
