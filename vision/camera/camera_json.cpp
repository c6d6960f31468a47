// The camera as JSON values: the common ground of every camera file.
#include <cmath>
#include <initializer_list>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "vision/camera/camera_file.h"
#include "vision/camera/json_fields.h"

namespace longarm::vision {
namespace {

using nlohmann::json;
using Keys = std::initializer_list<const char*>;

// First spelling is ours; the others are ROS messages' and those of OpenCV's samples.
const Keys kMatrixKeys = {"camera_matrix", "Camera_Matrix", "cameraMatrix", "CameraMatrix", "Camera_matrix",
                          "intrinsic_matrix", "K", "k", "M1", "K1", "M"};
const Keys kDistortionKeys = {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs", "DistCoeffs",
                              "distortionCoefficients", "Distortion_coefficients", "dist_coeffs", "dist_coeff", "D",
                              "d", "D1"};
const Keys kWidthKeys = {"image_width", "image_Width", "imageWidth", "width"};
const Keys kHeightKeys = {"image_height", "image_Height", "imageHeight", "height"};
const Keys kSizeKeys = {"image_size", "imageSize", "Image_Size", "image_Size", "size"};

Error bad(const std::string& where, const std::string& what) { return {ErrorCode::kInvalidInput, where + ": " + what}; }

const char* firstOf(const json& object, Keys keys) {
  for (const char* key : keys) {
    if (object.contains(key)) return key;
  }
  return nullptr;
}

json matrixJson(int rows, int cols, std::vector<double> data) {
  return {{"rows", rows}, {"cols", cols}, {"data", std::move(data)}};
}

struct Matrix {
  int rows = 0, cols = 0;           // 0 x 0 for a plain list
  std::vector<double> data;
};

Result<int> sideFromJson(const json& value, const std::string& where) {
  if (!value.is_number_integer() || value < 0 || value > 64) {
    return bad(where, shortText(value) + " is not a number of rows or columns from 0 to 64");
  }
  return value.get<int>();
}

// {rows, cols, data}, a flat list, or a list of rows.
Result<Matrix> matrixFromJson(const json& value, const std::string& where) {
  Matrix out;
  if (value.is_object()) {
    if (!value.contains("data")) return bad(where, "key \"data\" is missing");
    // OpenCV's XML holds a single number where its YAML holds a list of one.
    const json data = value["data"].is_array() ? value["data"]
                      : value["data"].is_null() ? json::array()
                                                : json::array({value["data"]});
    const auto numbers = numbersFromJson(data, where + ".data");
    if (!numbers) return numbers.error();
    out.data = *numbers;
    if (!value.contains("rows") && !value.contains("cols")) return out;
    for (auto [key, side] : {std::pair<const char*, int*>{"rows", &out.rows}, {"cols", &out.cols}}) {
      if (!value.contains(key)) return bad(where, std::string("key \"") + key + "\" is missing");
      const auto number = sideFromJson(value[key], where + "." + key);
      if (!number) return number.error();
      *side = *number;
    }
    if (static_cast<std::size_t>(out.rows * out.cols) != out.data.size()) {
      return bad(where, "is " + std::to_string(out.rows) + " x " + std::to_string(out.cols) + " but data holds " +
                            std::to_string(out.data.size()) + " numbers");
    }
    return out;
  }
  if (value.is_array() && !value.empty() && value[0].is_array()) {
    for (std::size_t r = 0; r < value.size() && r < 64; ++r) {
      const auto row = numbersFromJson(value[r], where + "[" + std::to_string(r) + "]");
      if (!row) return row.error();
      out.data.insert(out.data.end(), row->begin(), row->end());
    }
    return out;
  }
  const auto numbers = numbersFromJson(value, where);
  if (!numbers) return numbers.error();
  out.data = *numbers;
  return out;
}

Status readMatrix(const json& object, CameraModel* camera) {
  const char* key = firstOf(object, kMatrixKeys);
  if (key == nullptr) return bad("camera_matrix", "is missing; a camera file needs this key");
  const auto matrix = matrixFromJson(object[key], key);
  if (!matrix) return matrix.error();
  const auto& m = matrix->data;
  if (m.size() != 9 || (matrix->rows != 0 && matrix->rows != 3)) {
    return bad(key, "holds " + std::to_string(m.size()) + " numbers; expected 9, row by row");
  }
  const auto expect = [&](std::size_t i, double wanted) -> Status {
    if (m[i] == wanted) return {};
    return bad(key, "entry " + std::to_string(i) + " is " + formatNumber(m[i]) + "; expected " +
                        formatNumber(wanted) + " ([fx skew cx; 0 fy cy; 0 0 1])");
  };
  for (const std::size_t i : {3u, 6u, 7u}) {
    if (auto status = expect(i, 0); !status) return status;
  }
  if (auto status = expect(8, 1); !status) return status;
  camera->fx = m[0];
  camera->skew = m[1];
  camera->cx = m[2];
  camera->fy = m[4];
  camera->cy = m[5];
  return {};
}

std::string lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

// Whether the named lens model is the polynomial one; `needs_zero` when only without any coefficients.
Status readModelName(const json& object, bool* needs_zero) {
  for (const char* key : {"fisheye_model", "fisheye"}) {
    if (object.contains(key) && object[key] != json(0) && object[key] != json(false)) {
      return bad(key, "fisheye lenses are not supported; calibrate with the plumb_bob model");
    }
  }
  const char* key = firstOf(object, {"distortion_model", "distortionModel"});
  if (key == nullptr) return {};
  if (!object[key].is_string()) return bad(key, shortText(object[key]) + " is not the name of a lens model");
  const std::string model = lower(object[key].get<std::string>());
  if (model == "plumb_bob" || model == "radtan" || model == "radial-tangential" || model == "brown_conrady") return {};
  if (model == "rational_polynomial") return {};  // its further coefficients are checked by the reader
  if (model.empty() || model == "none" || model == "pinhole") {
    *needs_zero = true;
    return {};
  }
  return bad(key, shortText(object[key]) +
                      " lenses are not supported; expected plumb_bob (k1 k2 p1 p2 k3). Calibrate the camera with "
                      "that model");
}

Status readDistortion(const json& object, CameraModel* camera) {
  bool needs_zero = false;
  if (auto status = readModelName(object, &needs_zero); !status) return status;
  const char* key = firstOf(object, kDistortionKeys);
  if (key == nullptr || object[key].is_null()) return {};
  const auto matrix = matrixFromJson(object[key], key);
  if (!matrix) return matrix.error();
  const auto& d = matrix->data;
  const std::size_t n = d.size();
  if (n != 0 && n != 1 && n != 2 && n != 4 && n != 5 && n != 8 && n != 12 && n != 14) {
    return bad(key, "holds " + std::to_string(n) + " numbers; expected 4 or 5 (k1 k2 p1 p2 k3)");
  }
  for (std::size_t i = 5; i < n; ++i) {
    if (d[i] != 0) {
      return bad(key, "number " + std::to_string(i) + " is " + formatNumber(d[i]) +
                          ": rational, thin prism and tilted lenses are not supported; expected plumb_bob "
                          "(k1 k2 p1 p2 k3). Calibrate the camera with that model");
    }
  }
  for (std::size_t i = 0; i < n && i < 5; ++i) {
    if (needs_zero && d[i] != 0) {
      return bad(key, "number " + std::to_string(i) + " is " + formatNumber(d[i]) + " but the file names no lens model");
    }
    camera->distortion[i] = d[i];
  }
  return {};
}

Result<int> pixelsFromJson(const json& value, const std::string& where) {
  const auto number = numberFromJson(value, where);
  if (!number) return number.error();
  if (*number != std::floor(*number) || *number < 1 || *number > 65536) {
    return bad(where, formatNumber(*number) + " is not a number of pixels from 1 to 65536");
  }
  return static_cast<int>(*number);
}

Status readSize(const json& object, CameraModel* camera) {
  if (const char* key = firstOf(object, kSizeKeys); key != nullptr && object[key].is_array()) {
    const json& size = object[key];
    if (size.size() != 2) return bad(key, "expected [width, height]");
    const auto width = pixelsFromJson(size[0], key);
    const auto height = pixelsFromJson(size[1], key);
    if (!width) return width.error();
    if (!height) return height.error();
    camera->width = *width;
    camera->height = *height;
  }
  for (const auto& [keys, side] : {std::pair<Keys, int*>{kWidthKeys, &camera->width}, {kHeightKeys, &camera->height}}) {
    const char* key = firstOf(object, keys);
    if (key == nullptr) continue;
    const auto pixels = pixelsFromJson(object[key], key);
    if (!pixels) return pixels.error();
    *side = *pixels;
  }
  if ((camera->width == 0) != (camera->height == 0)) {
    return bad(camera->width == 0 ? "image_width" : "image_height", "is missing beside its counterpart");
  }
  return {};
}

Status readName(const json& object, CameraModel* camera) {
  const char* key = firstOf(object, {"camera_name", "cameraName", "Camera_Name"});
  if (key == nullptr || object[key].is_null()) return {};
  if (object[key].is_structured()) return bad(key, shortText(object[key]) + " is not a name");
  camera->name = object[key].is_string() ? object[key].get<std::string>() : object[key].dump();
  if (camera->name.size() > 256) return bad(key, "is longer than 256 characters");
  return {};
}

Result<Eigen::MatrixXd> covarianceFromJson(const json& value, bool has_pose) {
  const auto matrix = matrixFromJson(value, "covariance");
  if (!matrix) return matrix.error();
  const std::size_t n = matrix->data.size();
  const Eigen::Index side = n == 100 ? 10 : n == 256 ? 16 : 0;
  if (side == 0 || (matrix->rows != 0 && matrix->rows != side)) {
    return bad("covariance", "holds " + std::to_string(n) +
                                 " numbers; expected 10 x 10 (fx fy skew cx cy k1 k2 p1 p2 k3) or 16 x 16 (and the "
                                 "pose: rotation vector, xyz)");
  }
  if (side == 16 && !has_pose) return bad("covariance", "is 16 x 16 but the file has no pose");
  Eigen::MatrixXd out = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      matrix->data.data(), side, side);
  for (Eigen::Index i = 0; i < side; ++i) {
    if (out(i, i) < 0) return bad("covariance", "variance " + std::to_string(i) + " is " + formatNumber(out(i, i)));
    for (Eigen::Index j = 0; j < i; ++j) {
      if (std::abs(out(i, j) - out(j, i)) > 1e-6 * std::sqrt(out(i, i) * out(j, j)) + 1e-30) {
        return bad("covariance", "is not symmetric at row " + std::to_string(i) + ", column " + std::to_string(j));
      }
    }
  }
  return out;
}

}  // namespace

json toJson(const CameraFile& file) {
  const CameraModel& c = file.camera;
  json out = json::object();
  if (c.width > 0 && c.height > 0) {
    out["image_width"] = c.width;
    out["image_height"] = c.height;
  }
  out["camera_name"] = c.name;
  out["camera_matrix"] = matrixJson(3, 3, {c.fx, c.skew, c.cx, 0, c.fy, c.cy, 0, 0, 1});
  out["distortion_model"] = "plumb_bob";
  out["distortion_coefficients"] = matrixJson(1, 5, {c.distortion.begin(), c.distortion.end()});
  if (file.pose) out["pose"] = toJson(*file.pose);
  if (file.covariance) {
    const Eigen::MatrixXd rows_first = file.covariance->transpose();
    const int side = static_cast<int>(rows_first.rows());
    out["covariance"] = matrixJson(side, side, {rows_first.data(), rows_first.data() + rows_first.size()});
  }
  return out;
}

Result<CameraFile> cameraFromJson(const json& object) {
  if (!object.is_object()) return bad("camera", "expected a map with the key camera_matrix, found " + shortText(object));
  CameraFile out;
  for (const auto reader : {&readName, &readMatrix, &readDistortion, &readSize}) {
    if (auto status = reader(object, &out.camera); !status) return status.error();
  }
  if (auto status = validate(out.camera); !status) return status.error();
  if (object.contains("pose") && !object["pose"].is_null()) {
    const auto pose = poseFromJson(object["pose"], "pose");
    if (!pose) return pose.error();
    out.pose = *pose;
  }
  if (object.contains("covariance") && !object["covariance"].is_null()) {
    const auto covariance = covarianceFromJson(object["covariance"], out.pose.has_value());
    if (!covariance) return covariance.error();
    out.covariance = *covariance;
  }
  return out;
}

}  // namespace longarm::vision
