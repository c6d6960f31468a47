#pragma once

/// @file
/// Finds the file that a URDF's mesh name means, and only below the folders a model may read from.

#include <string>
#include <vector>

#include "core/result.h"

namespace longarm::planning::internal {

/// Resolves `package://NAME/rest`, `file://` and relative names.
///
/// A package is a folder called NAME that holds the URDF, or that has a package.xml and stands in one of the
/// package paths or beside an ancestor of the URDF.  Relative names start at the URDF's folder and may climb up to
/// the folder of its own package (the nearest one above with a package.xml), no further.  After links are followed
/// the file must still lie below the folder it was looked up in: a description received from somebody else
/// cannot name /etc/passwd.  Thread-compatible.
class MeshResolver {
 public:
  MeshResolver(const std::string& urdf_path, std::vector<std::string> package_paths);

  /// @returns Absolute path of an existing file; kInvalidInput (not allowed) or kNotFound, each naming `uri`.
  Result<std::string> resolve(const std::string& uri) const;

 private:
  Result<std::string> resolvePackage(const std::string& uri, const std::string& rest) const;
  Result<std::string> resolveFile(const std::string& uri, const std::string& path) const;

  std::string m_folder;                     ///< Of the URDF.
  std::string m_model_root;                 ///< Of its package.
  std::vector<std::string> m_package_paths; ///< As given.
};

}  // namespace longarm::planning::internal
