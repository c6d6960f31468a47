#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include <nlohmann/json.hpp>

#include "hardware/rosbridge_codec/protocol.h"

namespace longarm::rosbridge {
namespace {

// The operation after a trip over the wire in both forms must hold the same.
template <typename Op>
void expectRoundTrip(const Op& operation, void (*compare)(const Op&, const Op&)) {
  for (const bool binary : {false, true}) {
    const auto back = binary ? decodeBinary(encodeBinary(operation)) : decodeText(encodeText(operation));
    ASSERT_TRUE(back.ok()) << back.error().message;
    ASSERT_TRUE(std::holds_alternative<Op>(*back));
    compare(operation, std::get<Op>(*back));
  }
}

template <typename Message>
Message throughTheWire(const Message& message, Dialect dialect, bool binary) {
  const Operation operation = publish("/t", message, dialect);
  auto back = binary ? decodeBinary(encodeBinary(operation)) : decodeText(encodeText(operation));
  EXPECT_TRUE(back.ok()) << (back.ok() ? "" : back.error().message);
  auto read_back = readAs<Message>(std::get<Publish>(*back).message);
  EXPECT_TRUE(read_back.ok()) << (read_back.ok() ? "" : read_back.error().message);
  return read_back.ok() ? *read_back : Message{};
}

template <typename Message>
std::string complaint(const std::string& json) {
  auto body = Body::parse(json);
  if (!body) return body.error().message;
  auto message = readAs<Message>(*body);
  return message.ok() ? "" : message.error().message;
}

TEST(RosbridgeProtocol, EveryOperationSurvivesTheTripOverTheWire) {
  expectRoundTrip<Advertise>({"/a", "std_msgs/Empty", "7"}, [](const Advertise& a, const Advertise& b) {
    EXPECT_EQ(a.topic + a.type + a.id, b.topic + b.type + b.id);
  });
  expectRoundTrip<Subscribe>({"/c", "t", 100, 3, "cbor", "x"}, [](const Subscribe& a, const Subscribe& b) {
    EXPECT_EQ(a.topic + a.type + a.compression + a.id, b.topic + b.type + b.compression + b.id);
    EXPECT_EQ(a.throttle_rate_ms, b.throttle_rate_ms);
    EXPECT_EQ(a.queue_length, b.queue_length);
  });
  expectRoundTrip<Unsubscribe>({"/c", "x"}, [](const Unsubscribe& a, const Unsubscribe& b) {
    EXPECT_EQ(a.topic + a.id, b.topic + b.id);
  });
  expectRoundTrip<Unadvertise>({"/c", ""}, [](const Unadvertise& a, const Unadvertise& b) {
    EXPECT_EQ(a.topic + a.id, b.topic + b.id);
  });
  expectRoundTrip<CallService>({"/s", *Body::parse(R"({"seed": 4})"), "1"},
                               [](const CallService& a, const CallService& b) {
                                 EXPECT_EQ(a.service + a.id, b.service + b.id);
                                 EXPECT_EQ(a.args.json(), b.args.json());
                               });
  expectRoundTrip<ServiceResponse>({"/s", *Body::parse(R"({"ok": [1, 2.5, null]})"), false, "1"},
                                   [](const ServiceResponse& a, const ServiceResponse& b) {
                                     EXPECT_EQ(a.values.json(), b.values.json());
                                     EXPECT_EQ(a.result, b.result);
                                     EXPECT_EQ(a.id, b.id);
                                   });
  expectRoundTrip<StatusReport>({"warning", "mind \"this\"", ""}, [](const StatusReport& a, const StatusReport& b) {
    EXPECT_EQ(a.level + a.text, b.level + b.text);
  });
}

TEST(RosbridgeProtocol, ANumericIdIsReadAsText) {
  const auto operation = decodeText(R"({"op":"call_service","service":"/s","id":12})");
  ASSERT_TRUE(operation.ok());
  EXPECT_EQ(std::get<CallService>(*operation).id, "12");
}

TEST(RosbridgeProtocol, BrokenFramesGiveASentenceNamingTheFault) {
  const auto why = [](const std::string& frame) {
    const auto result = decodeText(frame);
    return result.ok() ? std::string("accepted") : result.error().message;
  };
  EXPECT_NE(why("{\"op\":").find("not JSON at byte 7"), std::string::npos) << why("{\"op\":");
  EXPECT_NE(why("").find("not JSON"), std::string::npos);
  EXPECT_NE(why("[]").find("not an object"), std::string::npos);
  EXPECT_NE(why("{}").find("no \"op\""), std::string::npos);
  EXPECT_NE(why(R"({"op":"dance"})").find("\"dance\" is unknown"), std::string::npos);
  EXPECT_NE(why(R"({"op":"publish","topic":"/a"})").find("no \"msg\""), std::string::npos);
  EXPECT_NE(why(R"({"op":"publish","topic":4,"msg":{}})").find("\"topic\" is not text"), std::string::npos);
  EXPECT_NE(why(R"({"op":"subscribe","topic":"/a","throttle_rate":-3})").find("expected 0"), std::string::npos);
  EXPECT_NE(why(R"({"op":"service_response","result":1})").find("neither true nor false"), std::string::npos);
}

TEST(RosbridgeProtocol, DepthIsBoundedInTextAndInBinary) {
  const std::string deep(100000, '[');
  EXPECT_NE(decodeText(deep).error().message.find("nested deeper than 32"), std::string::npos);
  for (const char byte : {'\x81', '\xc6', '\x9f'}) {   // array of one, tag, array without end
    const auto result = decodeBinary(std::string(1000000, byte));
    ASSERT_FALSE(result.ok());
    EXPECT_NE(result.error().message.find("nested deeper than 32"), std::string::npos) << result.error().message;
  }
  EXPECT_FALSE(decodeBinary(std::string(1000000, '\x5f')).ok());   // chunked bytes in chunked bytes
}

TEST(RosbridgeProtocol, SizeAndNumberOfValuesAreBounded) {
  EXPECT_NE(decodeText(std::string(kMaxFrameBytes + 1, ' ')).error().message.find("at most"), std::string::npos);
  EXPECT_NE(decodeBinary(std::string(kMaxFrameBytes + 1, ' ')).error().message.find("at most"), std::string::npos);
  std::string many = "[0";
  for (std::size_t i = 0; i < kMaxValues; ++i) many += ",0";
  EXPECT_NE(decodeText(many + "]").error().message.find("values"), std::string::npos);
  const std::string huge_claim("\x9b\x7f\xff\xff\xff\xff\xff\xff\xff", 9);   // array of 2^63 items, none there
  EXPECT_NE(decodeBinary(huge_claim).error().message.find("cut short"), std::string::npos);
  const std::string huge_text("\x7b\xff\xff\xff\xff\xff\xff\xff\xff", 9);
  EXPECT_NE(decodeBinary(huge_text).error().message.find("longer than the frame"), std::string::npos);
}

TEST(RosbridgeMessages, AllTypesSurviveBothDialectsAndBothForms) {
  for (const Dialect dialect : {Dialect::kRos1, Dialect::kRos2}) {
    for (const bool binary : {false, true}) {
      JointStateMessage state{{5, 1700000000.25, "base"}, {"a", "b"}, {0.1, -2}, {0, 1e-3}, {}};
      const auto s = throughTheWire(state, dialect, binary);
      EXPECT_EQ(s.name, state.name);
      EXPECT_EQ(s.position, state.position);
      EXPECT_EQ(s.velocity, state.velocity);
      EXPECT_EQ(s.header.frame_id, "base");
      EXPECT_NEAR(s.header.stamp_s, state.header.stamp_s, 1e-6);   // double holds 1.7e9 s to 0.24 us

      JointTrajectoryMessage trajectory{{0, 12.5, ""}, {"a"}, {{{1}, {2}, {3}, 0}, {{4}, {5}, {6}, 0.0199999999}}};
      const auto t = throughTheWire(trajectory, dialect, binary);
      ASSERT_EQ(t.points.size(), 2u);
      EXPECT_EQ(t.points[1].positions, trajectory.points[1].positions);
      EXPECT_EQ(t.points[1].accelerations, trajectory.points[1].accelerations);
      EXPECT_NEAR(t.points[1].time_from_start_s, 0.0199999999, 1e-9);

      std::string bytes;
      for (int i = 0; i < 1000; ++i) bytes += static_cast<char>(i * 7);
      const auto image = throughTheWire(CompressedImageMessage{{0, 3.5, "cam"}, "jpeg", bytes}, dialect, binary);
      EXPECT_EQ(image.data, bytes);
      EXPECT_EQ(image.format, "jpeg");

      CameraInfoMessage info;
      info.width = 640;
      info.height = 480;
      info.d = {0.1, 0.2, 0, 0, 0};
      info.k = {740, 0, 320, 0, 740, 240, 0, 0, 1};
      const auto i = throughTheWire(info, dialect, binary);
      EXPECT_EQ(i.k, info.k);
      EXPECT_EQ(i.d, info.d);
      EXPECT_EQ(i.r, info.r);
      EXPECT_EQ(i.width, 640u);

      const auto twist = throughTheWire(TwistMessage{{0.1, -0.2, 0}, {0, 0, 0.3}}, dialect, binary);
      EXPECT_EQ(twist.linear, (std::array<double, 3>{0.1, -0.2, 0}));
      EXPECT_EQ(twist.angular[2], 0.3);
      BaseState base;
      base.x = 1.5;
      base.y = -0.25;
      base.yaw = -3;
      base.twist = {0.2, 0, -0.1};
      const auto odometry = throughTheWire(toMessage(base, 12.5), dialect, binary);
      const auto read = toBaseState(odometry);
      ASSERT_TRUE(read.ok()) << read.error().message;
      EXPECT_EQ(read->x, 1.5);
      EXPECT_EQ(read->y, -0.25);
      EXPECT_NEAR(read->yaw, -3, 1e-12);
      EXPECT_EQ(read->twist.turn, -0.1);
      EXPECT_NEAR(read->stamp_s, 12.5, 1e-6);
      OdometryMessage broken = toMessage(base, 1);
      broken.orientation = {0, 0, 0, 0};
      EXPECT_EQ(toBaseState(broken).error().code, ErrorCode::kInvalidInput);

      const Attitude attitude{7.5, Eigen::Vector3d(0.3, -0.2, 0.9).normalized()};
      const auto up = toAttitude(throughTheWire(toMessage(attitude, 7.5, "imu_link"), dialect, binary));
      ASSERT_TRUE(up.ok()) << up.error().message;
      EXPECT_LT((up->up - attitude.up).norm(), 1e-12);
      EXPECT_NEAR(up->stamp_s, 7.5, 1e-6);
      ImuMessage silent = toMessage(attitude, 1, "imu_link");
      silent.orientation_covariance[0] = -1;
      EXPECT_EQ(toAttitude(silent).error().code, ErrorCode::kInvalidInput) << "REP 145: no orientation";
      silent = toMessage(attitude, 1, "imu_link");
      silent.orientation = {0, 0, 0, 0};
      EXPECT_EQ(toAttitude(silent).error().code, ErrorCode::kInvalidInput);

      EXPECT_EQ(throughTheWire(Float64Message{-1.0 / 3}, dialect, binary).data, -1.0 / 3);
      EXPECT_TRUE(throughTheWire(BoolMessage{true}, dialect, binary).data);
      EXPECT_EQ(throughTheWire(StringMessage{"{\"a\": \"ü\"}"}, dialect, binary).data, "{\"a\": \"ü\"}");
      throughTheWire(EmptyMessage{}, dialect, binary);
    }
  }
}

TEST(RosbridgeMessages, TypedNumberArraysOfBinaryRosbridgeAreRead) {
  nlohmann::json message = {{"name", {"a", "b"}}};
  const double values[2] = {0.5, -1.25};
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(values);
  message["position"] = nlohmann::json::binary(std::vector<std::uint8_t>(bytes, bytes + sizeof values), 86);
  const auto back = decodeBinary(encodeBinary(Publish{"/joint_states", Body(message), {}}));
  ASSERT_TRUE(back.ok()) << back.error().message;
  const auto state = readAs<JointStateMessage>(std::get<Publish>(*back).message);
  ASSERT_TRUE(state.ok()) << state.error().message;
  EXPECT_EQ(state->position, (std::vector<double>{0.5, -1.25}));
}

TEST(RosbridgeMessages, WrongFieldsAreNamed) {
  EXPECT_NE(complaint<JointStateMessage>("{}").find("no \"name\""), std::string::npos);
  EXPECT_NE(complaint<JointStateMessage>(R"({"name":["a"],"position":[1,2]})").find("1 names but 2"),
            std::string::npos);
  EXPECT_NE(complaint<JointStateMessage>(R"({"name":["a"],"position":[null]})").find("\"position\" is not a number"),
            std::string::npos);
  EXPECT_NE(complaint<JointStateMessage>("[]").find("not an object"), std::string::npos);
  EXPECT_NE(complaint<JointTrajectoryMessage>(R"({"joint_names":[],"points":[{}]})").find("time_from_start"),
            std::string::npos);
  EXPECT_NE(complaint<CompressedImageMessage>(R"({"format":"jpeg","data":"A*=="})").find("character 1"),
            std::string::npos);
  EXPECT_NE(complaint<CameraInfoMessage>(R"({"height":1,"width":1,"distortion_model":"","K":[1]})").find("expected 9"),
            std::string::npos);
  EXPECT_NE(complaint<CameraInfoMessage>(R"({"height":1,"width":-4,"distortion_model":"","K":[1]})").find("65536"),
            std::string::npos);
  EXPECT_NE(complaint<BoolMessage>(R"({"data":1})").find("neither true nor false"), std::string::npos);
  EXPECT_NE(complaint<Float64Message>(R"({"data":"1"})").find("not a number"), std::string::npos);
}

TEST(RosbridgeMessages, AHorizonBecomesATrajectoryAndComesBack) {
  Horizon horizon;
  horizon.sequence = 9;
  horizon.joint_names = {"a", "b"};
  for (int i = 0; i < 3; ++i) {
    horizon.points.push_back({0.02 * i, Eigen::Vector2d(i, -i), Eigen::Vector2d(1, 2), Eigen::Vector2d(0, 0)});
  }
  const auto back = toHorizon(toMessage(horizon, 44.5));
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->start_s, 44.5);
  EXPECT_EQ(back->sequence, 9u);
  EXPECT_EQ(back->points[2].positions, horizon.points[2].positions);
  EXPECT_EQ(back->points[2].t, 0.04);
}

TEST(RosbridgeMessages, HorizonsThatMakeNoSenseAreRefused) {
  JointTrajectoryMessage message{{}, {"a", "a"}, {}};
  EXPECT_NE(toHorizon(message).error().message.find("given twice"), std::string::npos);
  message = {{}, {"a"}, {{{1}, {}, {}, 0.1}, {{1}, {}, {}, 0.1}}};
  EXPECT_NE(toHorizon(message).error().message.find("does not increase"), std::string::npos);
  message = {{}, {"a"}, {{{}, {}, {}, 0}}};
  EXPECT_NE(toHorizon(message).error().message.find("no positions"), std::string::npos);
  message = {{}, {"a"}, {{{std::nan("")}, {}, {}, 0}}};
  EXPECT_NE(toHorizon(message).error().message.find("not finite"), std::string::npos);
  message = {{}, {"a"}, {{{1, 2}, {}, {}, 0}}};
  EXPECT_NE(toHorizon(message).error().message.find("2 numbers for 1"), std::string::npos);
}

TEST(RosbridgeMessages, JointStatesWithoutPositionsOrWithDoubledNamesAreRefused) {
  EXPECT_FALSE(toJointState({{}, {"a"}, {}, {}, {}}).ok());
  EXPECT_FALSE(toJointState({{}, {"a", "a"}, {1, 2}, {}, {}}).ok());
  EXPECT_FALSE(toJointState({{}, {"a"}, {std::numeric_limits<double>::infinity()}, {}, {}}).ok());
  const auto state = toJointState({{0, 2.5, ""}, {"a"}, {1}, {}, {}});
  ASSERT_TRUE(state.ok());
  EXPECT_EQ(state->stamp_s, 2.5);
  EXPECT_EQ(state->velocities.size(), 0);
}

TEST(Base64, KnownVectorsOfRfc4648) {
  const std::pair<const char*, const char*> known[] = {{"", ""},         {"f", "Zg=="},     {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},  {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : known) {
    EXPECT_EQ(encodeBase64(plain), coded);
    ASSERT_TRUE(decodeBase64(coded).ok());
    EXPECT_EQ(*decodeBase64(coded), plain);
  }
  EXPECT_FALSE(decodeBase64("Zg=").ok());
  EXPECT_FALSE(decodeBase64("=g==").ok());
}

}  // namespace
}  // namespace longarm::rosbridge
