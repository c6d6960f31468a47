// The zoom camera file of SAND2004-6198, Appendix D: reading and writing.
#include <algorithm>
#include <cmath>

#include <pugixml.hpp>

#include "core/text.h"
#include "vision/camera/camera_file_internal.h"
#include "vision/camera/zoom_camera.h"

namespace longarm::vision {
namespace {

constexpr std::size_t kMaxNodes = 1000, kMaxCameras = 64, kMaxHeaders = 256, kMaxBytes = 4u << 20;
constexpr const char* kInterior = "fx fy fxy u0 v0 k1 k2 p1 p2";
constexpr const char* kExterior = "dx dy dz and the rotation vector";

Error bad(const std::string& where, const std::string& what) { return {ErrorCode::kInvalidInput, where + ": " + what}; }

std::string ownText(const pugi::xml_node& node) {
  for (const auto& child : node.children()) {
    if (child.type() == pugi::node_pcdata && !trimmed(child.value()).empty()) return std::string(trimmed(child.value()));
  }
  return {};
}

bool hasCommaDecimals(std::string_view text) {
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (text[i] == ',' && text[i - 1] >= '0' && text[i - 1] <= '9' && text[i + 1] >= '0' && text[i + 1] <= '9') return true;
  }
  return false;
}

// "{1 2 3}" as numbers.
Result<std::vector<double>> bracedNumbers(const pugi::xml_node& zoom, const char* name, const char* content, const std::string& where) {
  const pugi::xml_node node = zoom.child(name);
  if (!node) return bad(where, std::string("<") + name + "> is missing; expected <" + name + ">{" + content + "}</" + name + ">");
  if (node.next_sibling(name)) return bad(where, std::string("<") + name + "> is given twice; remove one");
  const std::string place = where + " " + name, text = ownText(node);
  const bool opens = !text.empty() && text.front() == '{', closes = !text.empty() && text.back() == '}';
  if (!opens || !closes) {
    return bad(place, std::string("the ") + (opens ? "closing brace }" : closes ? "opening brace {" : "pair of braces { }") +
                          " is missing; write {" + content + "}");
  }
  const std::string inside = text.substr(1, text.size() - 2);
  if (inside.find_first_of("{}") != std::string::npos) return bad(place, "holds a brace too many; write {" + std::string(content) + "}");
  if (hasCommaDecimals(inside)) return bad(place, "decimals are written with a comma (\"" + inside.substr(0, 40) + "\"); write 740.09, not 740,09");
  auto numbers = parseNumbers(inside);
  if (!numbers) return bad(place, numbers.error().message);
  for (const double number : *numbers) {
    if (!std::isfinite(number)) return bad(place, "holds a number that is not finite");
  }
  return numbers;
}

Result<ZoomNode> readNode(const pugi::xml_node& zoom, std::vector<std::string>* warnings) {
  ZoomNode node;
  const std::string text = ownText(zoom);
  const auto value = parseNumber(text);
  if (!value || !(*value >= 0 && *value <= 1)) return bad("SR_zoom", "\"" + text.substr(0, 40) + "\" is not a zoom from 0 to 1 (decimals with a point)");
  node.zoom = *value;
  const std::string where = "SR_zoom " + formatNumber(node.zoom);
  const auto interior = bracedNumbers(zoom, "SR_cam_int", kInterior, where);
  if (!interior) return interior.error();
  if (interior->size() != 9 && interior->size() != 7) {
    return bad(where + " SR_cam_int", "holds " + std::to_string(interior->size()) + " numbers; expected 9 (" + kInterior + ")");
  }
  if (interior->size() == 7) warnings->push_back(where + ": seven intrinsic values; p1 and p2 are taken as 0");
  std::copy(interior->begin(), interior->end(), node.interior.begin());
  if (!(node.interior[0] > 0 && node.interior[1] > 0)) {
    return bad(where + " SR_cam_int", "focal lengths " + formatNumber(node.interior[0]) + ", " + formatNumber(node.interior[1]) + " are not positive");
  }
  const auto exterior = bracedNumbers(zoom, "SR_cam_ext", kExterior, where);
  if (!exterior) return exterior.error();
  if (exterior->size() != 6) return bad(where + " SR_cam_ext", "holds " + std::to_string(exterior->size()) + " numbers; expected 6 (" + kExterior + ")");
  std::copy(exterior->begin(), exterior->end(), node.exterior.begin());
  return node;
}

Result<ZoomCamera> readCamera(const pugi::xml_node& element, std::vector<std::string>* warnings) {
  ZoomCamera camera;
  camera.name = ownText(element);
  if (camera.name.size() > 256) return bad("SR_cam", "its name is longer than 256 characters");
  std::vector<double> seen;
  for (const auto& zoom : element.children("SR_zoom")) {
    if (camera.nodes.size() >= kMaxNodes) return bad("SR_cam", "has more than " + std::to_string(kMaxNodes) + " settings");
    const auto node = readNode(zoom, warnings);
    if (!node) return node.error();
    if (std::find(seen.begin(), seen.end(), node->zoom) != seen.end()) {
      return bad("SR_zoom " + formatNumber(node->zoom), "is given twice; remove one of the two settings");
    }
    seen.push_back(node->zoom);
    camera.nodes.push_back(*node);
    if (isNominal(*node)) {
      warnings->push_back("SR_zoom " + formatNumber(node->zoom) + ": looks nominal, not measured (fx equals fy, principal point exactly in the middle); calibrate this setting");
    }
  }
  if (camera.nodes.empty()) return bad("SR_cam", "has no <SR_zoom> setting");
  if (!std::is_sorted(seen.begin(), seen.end())) warnings->push_back("SR_cam " + camera.name + ": the settings are not in order of zoom; they are used sorted");
  return camera;
}

template <std::size_t N>
std::string braced(const std::array<double, N>& numbers) {
  std::string out;
  for (const double number : numbers) out += (out.empty() ? "{" : " ") + formatNumber(number);
  return out + "}";
}

}  // namespace

Result<ZoomFile> parseZoomFile(std::string_view text) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) {
    const auto at = std::min<std::size_t>(text.size(), static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset)));
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    return bad("line " + std::to_string(line), std::string("broken XML: ") + parsed.description() + "; every element must be closed");
  }
  const pugi::xml_node world = document.document_element();
  if (std::string(world.name()) != "SR_world") return bad("root element", "<" + std::string(world.name()).substr(0, 40) + "> is not <SR_world>");
  ZoomFile file;
  for (const auto& child : world.children()) {
    const std::string name = child.name();
    if (name == "SR_filename" || name == "SR_comment") {
      if (file.headers.size() >= kMaxHeaders) return bad(name, "more than " + std::to_string(kMaxHeaders) + " comments");
      file.headers.emplace_back(name, ownText(child));
    } else if (name == "SR_cam") {
      if (file.cameras.size() >= kMaxCameras) return bad("SR_world", "has more than " + std::to_string(kMaxCameras) + " cameras");
      auto camera = readCamera(child, &file.warnings);
      if (!camera) return camera.error();
      file.cameras.push_back(std::move(*camera));
    }
  }
  if (file.cameras.empty()) return bad("SR_world", "has no <SR_cam>");
  return file;
}

Result<ZoomFile> readZoomFile(const std::string& path) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return text.error();
  auto file = parseZoomFile(*text);
  if (!file) return Error{file.error().code, path + ": " + file.error().message};
  return file;
}

std::string zoomFileText(const ZoomFile& file) {
  std::string out = "<?xml version=\"1.0\"?>\n<SR_world>\n";
  for (const auto& [name, text] : file.headers) out += "<" + name + "> " + internal::escapedXml(text) + " </" + name + ">\n";
  for (const auto& camera : file.cameras) {
    out += "<SR_cam> " + internal::escapedXml(camera.name) + "\n";
    for (const auto& node : camera.nodes) {
      out += "<SR_zoom> " + formatNumber(node.zoom) + "\n<SR_cam_int> " + braced(node.interior) + " </SR_cam_int>\n<SR_cam_ext> " +
             braced(node.exterior) + " </SR_cam_ext>\n</SR_zoom>\n";
    }
    out += "</SR_cam>\n";
  }
  return out + "</SR_world>\n";
}

Status writeZoomFile(const std::string& path, const ZoomFile& file) { return writeFileAtomically(path, zoomFileText(file)); }

namespace internal {

Result<CameraFile> cameraFromZoomXml(std::string_view text, double zoom) {
  const auto file = parseZoomFile(text);
  if (!file) return file.error();
  const auto node = zoomAt(file->cameras.front(), zoom);
  if (!node) return node.error();
  return cameraFileOf(file->cameras.front(), *node);
}

}  // namespace internal
}  // namespace longarm::vision
