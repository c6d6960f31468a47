#include "vision/camera/camera_file.h"

#include <nlohmann/json.hpp>

#include "core/printable.h"
#include "core/text.h"
#include "vision/camera/bounded_yaml.h"
#include "vision/camera/camera_file_internal.h"

namespace longarm::vision {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxBytes = 4u << 20;

bool looksLikeXml(std::string_view text) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  text = trimmed(text);
  return !text.empty() && text.front() == '<';
}

Result<CameraFile> cameraFromText(const std::string& text, std::optional<double> zoom) {
  const bool xml = looksLikeXml(text);
  if (xml && internal::isZoomXml(text)) {
    if (!zoom) {
      return Error{ErrorCode::kInvalidInput, "is a zoom camera; say at which `zoom` (0 to 1) it was used"};
    }
    return internal::cameraFromZoomXml(text, *zoom);
  }
  if (zoom) {
    return Error{ErrorCode::kInvalidInput,
                 "`zoom` " + formatNumber(*zoom) + " was given, but this camera file has no zoom settings"};
  }
  const Result<json> content = xml ? internal::jsonFromOpenCvXml(text) : jsonFromYaml(text);
  if (!content) return content.error();
  return cameraFromJson(*content);
}

bool endsWith(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() && text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

CameraFileFormat formatByEnding(const std::string& path) {
  if (endsWith(path, ".xml")) return CameraFileFormat::kOpenCvXml;
  return endsWith(path, ".yml") ? CameraFileFormat::kOpenCvYaml : CameraFileFormat::kRosYaml;
}

}  // namespace

Result<CameraFile> readCameraFile(const std::string& path, std::optional<double> zoom) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return text.error();
  auto file = cameraFromText(*text, zoom);
  if (!file) return printable(Error{file.error().code, "camera file " + path + ": " + file.error().message});
  return file;
}

Status writeCameraFile(const std::string& path, const CameraFile& file, std::optional<CameraFileFormat> format) {
  if (auto status = validate(file.camera); !status) return status;
  const json content = toJson(file);
  switch (format.value_or(formatByEnding(path))) {
    case CameraFileFormat::kRosYaml: return writeFileAtomically(path, internal::rosYaml(content));
    case CameraFileFormat::kOpenCvYaml: return writeFileAtomically(path, internal::openCvYaml(content));
    case CameraFileFormat::kOpenCvXml: return writeFileAtomically(path, internal::openCvXml(content));
  }
  return {ErrorCode::kInternal, "unknown camera file format"};
}

}  // namespace longarm::vision
