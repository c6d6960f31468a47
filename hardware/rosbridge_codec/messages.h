#pragma once

/// @file
/// The ROS messages that cross the link, as plain structs, and their reading and writing.
///
/// Times are seconds on the sender's clock.  Both ways of writing a ROS time are read ({secs, nsecs} of ROS 1
/// and {sec, nanosec} of ROS 2), and both spellings of CameraInfo's matrices (K and k).
/// Every function is pure and throws nothing; what cannot be read gives kInvalidInput with a sentence naming
/// the field.  Limits: 1024 joints, 10 000 trajectory points, 4096 characters per name.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/attitude.h"
#include "core/base_motion.h"
#include "core/motion.h"
#include "core/result.h"

namespace longarm::rosbridge {

/// Which generation of ROS a message is written for; reading takes either.
enum class Dialect { kRos1, kRos2 };

/// The content of one message or the arguments of one service call: an immutable JSON value in which binary
/// data stays binary until it is written as text.  Copies are cheap.  Thread-safe after construction.
class Body {
 public:
  Body();                                ///< {}
  explicit Body(nlohmann::json value);
  const nlohmann::json& json() const { return *m_value; }
  /// For logs and services: JSON text, binary data as base64.
  std::string text() const;
  /// @returns kInvalidInput with the place of the mistake.
  static Result<Body> parse(std::string_view json_text);

 private:
  std::shared_ptr<const nlohmann::json> m_value;
};

struct Header {
  std::uint32_t seq = 0;                 ///< ROS 1 only.
  double stamp_s = 0;                    ///< Sender's clock [s].
  std::string frame_id;
};

struct JointStateMessage {
  static constexpr const char* kType = "sensor_msgs/JointState";
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;          ///< Empty, or one per name [rad or m].
  std::vector<double> velocity;          ///< Empty, or one per name [rad/s or m/s].
  std::vector<double> effort;            ///< Empty, or one per name [N m or N].
};

struct JointTrajectoryPointMessage {
  std::vector<double> positions, velocities, accelerations;
  double time_from_start_s = 0;
};

struct JointTrajectoryMessage {
  static constexpr const char* kType = "trajectory_msgs/JointTrajectory";
  Header header;                         ///< stamp 0: starts when it arrives.
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPointMessage> points;
};

struct CompressedImageMessage {
  static constexpr const char* kType = "sensor_msgs/CompressedImage";
  Header header;
  std::string format;                    ///< "jpeg", "png"
  std::string data;                      ///< Encoded bytes.
};

struct CameraInfoMessage {
  static constexpr const char* kType = "sensor_msgs/CameraInfo";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string distortion_model = "plumb_bob";
  std::vector<double> d;                 ///< k1 k2 p1 p2 k3
  std::array<double, 9> k{}, r{1, 0, 0, 0, 1, 0, 0, 0, 1};   ///< Row-major.
  std::array<double, 12> p{};
};

struct Float64Message {
  static constexpr const char* kType = "std_msgs/Float64";
  double data = 0;
};

struct TwistMessage {
  static constexpr const char* kType = "geometry_msgs/Twist";
  std::array<double, 3> linear{}, angular{};  ///< [m/s], [rad/s]
};

struct OdometryMessage {
  static constexpr const char* kType = "nav_msgs/Odometry";
  Header header;
  std::string child_frame_id;
  std::array<double, 3> position{};               ///< [m]
  std::array<double, 4> orientation{0, 0, 0, 1};  ///< x, y, z, w
  TwistMessage twist;                             ///< In the child frame.
};

struct ImuMessage {
  static constexpr const char* kType = "sensor_msgs/Imu";
  Header header;
  std::array<double, 4> orientation{0, 0, 0, 1};             ///< Of the sensor in a frame with z up; x, y, z, w.
  std::array<double, 9> orientation_covariance{};            ///< Row-major [rad^2]; first -1: no orientation is told.
  std::array<double, 3> angular_velocity{}, linear_acceleration{};   ///< [rad/s], [m/s^2]
};

struct BoolMessage {
  static constexpr const char* kType = "std_msgs/Bool";
  bool data = false;
};

struct StringMessage {
  static constexpr const char* kType = "std_msgs/String";
  std::string data;
};

struct EmptyMessage {
  static constexpr const char* kType = "std_msgs/Empty";
};

Body write(const JointStateMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const JointTrajectoryMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const CompressedImageMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const CameraInfoMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const Float64Message& message, Dialect dialect = Dialect::kRos1);
Body write(const TwistMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const OdometryMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const ImuMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const BoolMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const StringMessage& message, Dialect dialect = Dialect::kRos1);
Body write(const EmptyMessage& message, Dialect dialect = Dialect::kRos1);

Status read(const Body& body, JointStateMessage& message);
Status read(const Body& body, JointTrajectoryMessage& message);
Status read(const Body& body, CompressedImageMessage& message);
Status read(const Body& body, CameraInfoMessage& message);
Status read(const Body& body, Float64Message& message);
Status read(const Body& body, TwistMessage& message);
Status read(const Body& body, OdometryMessage& message);
Status read(const Body& body, ImuMessage& message);
Status read(const Body& body, BoolMessage& message);
Status read(const Body& body, StringMessage& message);
Status read(const Body& body, EmptyMessage& message);

/// `auto state = readAs<JointStateMessage>(publish.message);`
template <typename Message>
Result<Message> readAs(const Body& body) {
  Message message;
  if (auto status = read(body, message); !status) return status.error();
  return message;
}

/// The horizon as a message; `start_s` is its start on the robot's clock [s], 0: on arrival.
JointTrajectoryMessage toMessage(const Horizon& horizon, double start_s);
/// What the robot's side does with it: start_s is the header's stamp; velocities and accelerations that are
/// left out are zero.
Result<Horizon> toHorizon(const JointTrajectoryMessage& message);
TwistMessage toMessage(const BaseTwist& twist);
/// kInvalidInput for numbers that are not finite.  What a base on the ground cannot do is left out.
Result<BaseTwist> toTwist(const TwistMessage& message);
OdometryMessage toMessage(const BaseState& state, double stamp_s);
/// kInvalidInput as toTwist(), or for a quaternion that is none.  stamp_s is the header's.
Result<BaseState> toBaseState(const OdometryMessage& message);
/// Turned about z by nothing: only what is up counts.
ImuMessage toMessage(const Attitude& attitude, double stamp_s, const std::string& frame);
/// kInvalidInput when it tells no orientation, or its quaternion is none.  stamp_s is the header's.
Result<Attitude> toAttitude(const ImuMessage& message);
JointStateMessage toMessage(const JointState& state, double stamp_s);
/// kInvalidInput when a position is missing or not finite, or a joint is named twice.  stamp_s is the header's.
Result<JointState> toJointState(const JointStateMessage& message);

/// RFC 4648 base64 with padding.
std::string encodeBase64(std::string_view bytes);
/// @returns kInvalidInput naming the place of the first character that does not belong.
Result<std::string> decodeBase64(std::string_view text);

}  // namespace longarm::rosbridge
