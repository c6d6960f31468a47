#pragma once

/// @file
/// Poses and numbers in JSON values, with errors that name the key and the value.

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/pose.h"
#include "core/result.h"

namespace longarm::vision {

/// {"parent", "xyz", "quaternion_xyzw"}.
nlohmann::json toJson(const PoseInParent& pose);
/// @param where What holds the pose, for messages ("views[0].pose").  A missing parent is `default_parent`.
/// @returns kInvalidInput: keys missing, not finite, or a quaternion whose length is off 1 by more than 1 %.
Result<PoseInParent> poseFromJson(const nlohmann::json& json, const std::string& where,
                                  const std::string& default_parent = "base_link");

/// A finite number, or kInvalidInput naming `where` and what stands there.
Result<double> numberFromJson(const nlohmann::json& json, const std::string& where);
/// A flat list of `count` finite numbers (any count if negative; at most 4096).
Result<std::vector<double>> numbersFromJson(const nlohmann::json& json, const std::string& where, int count = -1);
/// What stands in a value, cut to a length that fits a message.
std::string shortText(const nlohmann::json& json);

}  // namespace longarm::vision
