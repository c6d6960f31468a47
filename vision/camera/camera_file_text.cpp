// Writers of camera files.  Numbers in their shortest form that reads back the same, whatever the locale.
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "vision/camera/camera_file_internal.h"

namespace longarm::vision::internal {
namespace {

using nlohmann::json;

// Keys in the order in which ROS writes them.
const char* const kOrder[] = {"image_width",    "image_height",           "camera_name", "camera_matrix",
                              "distortion_model", "distortion_coefficients", "pose",        "covariance"};

// A JSON string is a YAML double-quoted scalar too.
std::string quoted(const std::string& text) {
  return json(text).dump(-1, ' ', true, json::error_handler_t::replace);
}

std::string number(const json& value) {
  return value.is_number_integer() ? std::to_string(value.get<long long>()) : formatNumber(value.get<double>());
}

std::string numbers(const json& list, const char* separator) {
  std::string out;
  for (const auto& value : list) out += (out.empty() ? "" : separator) + number(value);
  return out;
}

bool isMatrix(const json& value) { return value.is_object() && value.contains("data"); }

// "key: value" lines of both YAML flavours; OpenCV's matrices carry a tag and a type.
std::string yamlLines(const json& camera, bool opencv) {
  std::string out;
  for (const char* key : kOrder) {
    if (!camera.contains(key)) continue;
    const json& value = camera[key];
    out += std::string(key) + ":";
    if (isMatrix(value)) {
      out += opencv ? " !!opencv-matrix\n" : "\n";
      const std::string indent = opencv ? "   " : "  ";
      out += indent + "rows: " + number(value["rows"]) + "\n" + indent + "cols: " + number(value["cols"]) + "\n";
      if (opencv) out += indent + "dt: d\n";
      out += indent + "data: [" + numbers(value["data"], ", ") + "]\n";
    } else if (value.is_object()) {
      out += "\n  parent: " + quoted(value["parent"]) + "\n  xyz: [" + numbers(value["xyz"], ", ") +
             "]\n  quaternion_xyzw: [" + numbers(value["quaternion_xyzw"], ", ") + "]\n";
    } else {
      out += " " + (value.is_string() ? quoted(value) : number(value)) + "\n";
    }
  }
  return out;
}

std::string element(const std::string& name, const std::string& content, const std::string& attribute = {}) {
  return "<" + name + attribute + ">" + content + "</" + name + ">\n";
}

}  // namespace

std::string escapedXml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

std::string rosYaml(const json& camera) {
  std::string out = yamlLines(camera, false);
  // ROS's reader insists on these two; they say "not rectified".
  const json& m = camera["camera_matrix"]["data"];
  out += "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";
  out += "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [" + number(m[0]) + ", " + number(m[1]) + ", " +
         number(m[2]) + ", 0, 0, " + number(m[4]) + ", " + number(m[5]) + ", 0, 0, 0, 1, 0]\n";
  return out;
}

std::string openCvYaml(const json& camera) { return "%YAML:1.0\n---\n" + yamlLines(camera, true); }

std::string openCvXml(const json& camera) {
  std::string out = "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
  for (const char* key : kOrder) {
    if (!camera.contains(key)) continue;
    const json& value = camera[key];
    if (isMatrix(value)) {
      out += element(key,
                     "\n" + element("rows", number(value["rows"])) + element("cols", number(value["cols"])) +
                         element("dt", "d") + element("data", numbers(value["data"], " ")),
                     " type_id=\"opencv-matrix\"");
    } else if (value.is_object()) {
      out += element(key, "\n" + element("parent", "\"" + escapedXml(value["parent"]) + "\"") +
                              element("xyz", numbers(value["xyz"], " ")) +
                              element("quaternion_xyzw", numbers(value["quaternion_xyzw"], " ")));
    } else {
      out += element(key, value.is_string() ? "\"" + escapedXml(value) + "\"" : number(value));
    }
  }
  return out + "</opencv_storage>\n";
}

}  // namespace longarm::vision::internal
