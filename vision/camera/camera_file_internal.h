#pragma once

/// @file
/// Parts of the camera file reader and writer; not for other folders.

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/result.h"
#include "vision/camera/camera_file.h"

namespace longarm::vision::internal {

/// An OpenCV FileStorage XML text as the JSON its YAML twin would give.  No DTD; depth and count bounded.
Result<nlohmann::json> jsonFromOpenCvXml(std::string_view text);
/// Whether an XML text is a zoom camera file (root SR_world).
bool isZoomXml(std::string_view text);
/// The camera of a zoom file at one setting.
Result<CameraFile> cameraFromZoomXml(std::string_view text, double zoom);

/// Text as content of an XML element; control bytes, which XML cannot hold, become blanks.
std::string escapedXml(const std::string& text);

std::string rosYaml(const nlohmann::json& camera);
std::string openCvYaml(const nlohmann::json& camera);
std::string openCvXml(const nlohmann::json& camera);

}  // namespace longarm::vision::internal
