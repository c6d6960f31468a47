#include "core/resource_path.h"

#include <cstdlib>
#include <filesystem>
#include <vector>

namespace longarm {

namespace fs = std::filesystem;

std::string executableFolder() {
  std::error_code ec;
  const auto exe = fs::read_symlink("/proc/self/exe", ec);
  return ec ? std::string(".") : exe.parent_path().string();
}

Result<std::string> resourcePath(const std::string& relative) {
  std::vector<fs::path> roots;
  if (const char* env = std::getenv("LONGARM_RESOURCES")) roots.emplace_back(env);
  roots.emplace_back(LONGARM_SOURCE_RESOURCES);
  roots.push_back(fs::path(executableFolder()).parent_path() / "share" / "longarm");
  std::string tried;
  for (const auto& root : roots) {
    std::error_code ec;
    const fs::path candidate = root / relative;
    if (fs::exists(candidate, ec)) return fs::weakly_canonical(candidate, ec).string();
    tried += (tried.empty() ? "" : ", ") + root.string();
  }
  return Error{ErrorCode::kNotFound, "resource \"" + relative + "\" not found in " + tried +
                                         "; set LONGARM_RESOURCES to the folder that holds it"};
}

}  // namespace longarm
