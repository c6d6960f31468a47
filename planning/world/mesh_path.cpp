#include "planning/world/mesh_path.h"

#include <algorithm>
#include <filesystem>
#include <optional>

namespace longarm::planning::internal {
namespace {

namespace fs = std::filesystem;

constexpr int kAncestors = 8;             ///< How far above the URDF packages are looked for.
constexpr std::size_t kLongestName = 255;

fs::path resolved(const fs::path& path) {
  std::error_code ec;
  const auto result = fs::weakly_canonical(path, ec);
  return ec ? path : result;
}

bool isBelow(const fs::path& path, const fs::path& root) {
  const auto [at_root, at_path] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  (void)at_path;
  return at_root == root.end() || (std::next(at_root) == root.end() && at_root->empty());
}

/// The file `root`/`rest` when it exists and is still below `root` with all links followed.
std::optional<std::string> fileBelow(const fs::path& root, const fs::path& rest) {
  std::error_code ec;
  const fs::path folder = resolved(root);
  const fs::path file = resolved(folder / rest);
  if (!isBelow(file, folder) || !fs::is_regular_file(file, ec)) return std::nullopt;
  return file.string();
}

std::vector<fs::path> ancestorsOf(const fs::path& folder) {
  std::vector<fs::path> ancestors;
  fs::path at = folder;
  for (int i = 0; i < kAncestors && at.has_relative_path(); ++i) {
    ancestors.push_back(at);
    at = at.parent_path();
  }
  return ancestors;
}

bool hasPackageFile(const fs::path& folder) {
  std::error_code ec;
  return fs::is_regular_file(folder / "package.xml", ec);
}

Error refused(const std::string& uri, const std::string& why) {
  return {ErrorCode::kInvalidInput, "\"" + uri.substr(0, kLongestName) + "\" " + why};
}

}  // namespace

MeshResolver::MeshResolver(const std::string& urdf_path, std::vector<std::string> package_paths)
    : m_package_paths(std::move(package_paths)) {
  std::error_code ec;
  const fs::path folder = resolved(fs::absolute(urdf_path, ec)).parent_path();
  m_folder = folder.string();
  m_model_root = m_folder;
  for (const auto& ancestor : ancestorsOf(folder)) {
    if (!hasPackageFile(ancestor)) continue;
    m_model_root = ancestor.string();
    break;
  }
}

Result<std::string> MeshResolver::resolve(const std::string& uri) const {
  if (uri.empty()) return refused(uri, "names no file");
  if (uri.size() > kLongestName) return refused(uri, "... is longer than 255 characters");
  if (uri.find('\0') != std::string::npos || uri.find('\\') != std::string::npos || uri.find('%') != std::string::npos) {
    return refused(uri, "holds a character that file names here may not have (\\ or % or NUL)");
  }
  if (uri.rfind("package://", 0) == 0) return resolvePackage(uri, uri.substr(10));
  if (uri.rfind("model://", 0) == 0) return resolvePackage(uri, uri.substr(8));
  if (uri.rfind("file://", 0) == 0) return resolveFile(uri, uri.substr(7));
  if (uri.find("://") != std::string::npos) {
    return refused(uri, "is not a file; expected package://, file:// or a relative path");
  }
  return resolveFile(uri, uri);
}

Result<std::string> MeshResolver::resolvePackage(const std::string& uri, const std::string& rest) const {
  const auto slash = rest.find('/');
  const std::string package = rest.substr(0, slash);
  if (slash == std::string::npos || package.empty() || package == "." || package == "..") {
    return refused(uri, "has no package and path; expected package://NAME/path");
  }
  const fs::path inside = fs::path(rest.substr(slash + 1)).lexically_normal();
  if (inside.empty() || inside.is_absolute() || *inside.begin() == "..") {
    return refused(uri, "leaves its package by \"..\"; expected a path inside it");
  }
  std::vector<fs::path> packages;
  for (const auto& path : m_package_paths) {
    packages.push_back(fs::path(path) / package);
    if (fs::path(path).filename() == package) packages.emplace_back(path);
  }
  for (const auto& ancestor : ancestorsOf(m_folder)) {
    if (ancestor.filename() == package) packages.push_back(ancestor);
    if (hasPackageFile(ancestor / package)) packages.push_back(ancestor / package);
  }
  for (const auto& root : packages) {
    if (const auto found = fileBelow(root, inside)) return *found;
  }
  return Error{ErrorCode::kNotFound, "\"" + uri + "\" not found in " + std::to_string(packages.size()) +
                                         " folders named \"" + package +
                                         "\" around the robot file; add its folder to package_paths"};
}

Result<std::string> MeshResolver::resolveFile(const std::string& uri, const std::string& path) const {
  const fs::path wanted = fs::path(path).is_absolute() ? fs::path(path) : fs::path(m_folder) / path;
  const fs::path file = resolved(wanted);
  std::vector<fs::path> roots{m_folder, m_model_root};
  for (const auto& package : m_package_paths) roots.push_back(resolved(package));
  const bool allowed =
      std::any_of(roots.begin(), roots.end(), [&](const fs::path& root) { return isBelow(file, root); });
  if (!allowed) return refused(uri, "lies outside the robot's folder " + m_model_root + "; move it below");
  std::error_code ec;
  if (!fs::is_regular_file(file, ec)) return Error{ErrorCode::kNotFound, "\"" + uri + "\" not found as " + file.string()};
  return file.string();
}

}  // namespace longarm::planning::internal
