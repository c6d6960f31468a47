#pragma once

/// @file
/// Camera files: ROS camera_info YAML, OpenCV FileStorage YAML/XML; and the same content as JSON.

#include <optional>
#include <string>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "core/pose.h"
#include "core/result.h"
#include "vision/camera/camera_model.h"

namespace longarm::vision {

struct CameraFile {
  CameraModel camera;
  std::optional<PoseInParent> pose;            ///< Of the optical frame.
  std::optional<Eigen::MatrixXd> covariance;   ///< Of (fx fy skew cx cy k1 k2 p1 p2 k3 | rotvec xyz of the pose), 10x10 or 16x16.
};

/// Reads any supported camera file; the kind is told from its content.  `zoom` chooses the setting of a zoom file.
/// @returns kInvalidInput naming file, key and value; never throws, bounded in time and memory.
Result<CameraFile> readCameraFile(const std::string& path, std::optional<double> zoom = {});
enum class CameraFileFormat { kRosYaml, kOpenCvYaml, kOpenCvXml };
/// By the ending of `path` (.xml: OpenCV XML; .yml: OpenCV YAML; else ROS YAML) unless `format` is given.
Status writeCameraFile(const std::string& path, const CameraFile& file, std::optional<CameraFileFormat> format = {});
/// The content under the file's own keys, as cli.md's "camera".
nlohmann::json toJson(const CameraFile& file);
Result<CameraFile> cameraFromJson(const nlohmann::json& json);

}  // namespace longarm::vision
