#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "hardware/rosbridge_codec/protocol.h"

namespace longarm::rosbridge {
namespace {

std::vector<Operation> goodOperations() {
  JointTrajectoryMessage trajectory{{1, 5, "f"}, {"a", "b"}, {{{1, 2}, {0, 0}, {0, 0}, 0}, {{1, 2}, {}, {}, 0.02}}};
  CameraInfoMessage info;
  info.k = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return {publish("/joint_states", JointStateMessage{{1, 2.5, "x"}, {"a", "b"}, {1, 2}, {3, 4}, {}}),
          publish("/arm_controller/joint_trajectory", trajectory),
          publish("/camera/wrist/image/compressed", CompressedImageMessage{{}, "jpeg", "\xff\xd8 not much"}),
          publish("/camera/wrist/camera_info", info),
          publish("/robot_status", StringMessage{"{\"mode\": \"virtual\"}"}),
          Subscribe{"/a", "t", 100, 1, "cbor", "4"},
          CallService{"/virtual_robot/step", *Body::parse("{\"seconds\": 0.1}"), "4"},
          ServiceResponse{"/virtual_robot/step", {}, true, "4"}};
}

std::string mutated(std::string text, std::mt19937& rng) {
  const auto pick = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n)(rng); };
  for (std::size_t k = 0, n = 1 + pick(3); k < n && !text.empty(); ++k) {
    const std::size_t at = pick(text.size() - 1);
    switch (pick(4)) {
      case 0: text[at] = static_cast<char>(pick(255)); break;
      case 1: text.erase(at, 1 + pick(8)); break;
      case 2: text.insert(at, text.substr(pick(text.size() - 1), pick(12))); break;
      case 3: text.resize(at); break;
      default: text.insert(at, 1 + pick(3), "[]{}\",:-.e9\x9f\xff\x5f"[pick(13)]);
    }
  }
  return text;
}

// Reads a decoded message as every type: no reader may do more than complain.
void readAsEverything(const Operation& operation) {
  const auto* message = std::get_if<Publish>(&operation);
  if (message == nullptr) return;
  (void)readAs<JointStateMessage>(message->message);
  if (auto trajectory = readAs<JointTrajectoryMessage>(message->message)) (void)toHorizon(*trajectory);
  if (auto state = readAs<JointStateMessage>(message->message)) (void)toJointState(*state);
  (void)readAs<CompressedImageMessage>(message->message);
  (void)readAs<CameraInfoMessage>(message->message);
  (void)readAs<Float64Message>(message->message);
  (void)readAs<BoolMessage>(message->message);
  (void)readAs<StringMessage>(message->message);
  (void)readAs<EmptyMessage>(message->message);
}

void runMutations(int rounds, unsigned seed) {
  std::mt19937 rng(seed);
  const auto good = goodOperations();
  for (int i = 0; i < rounds; ++i) {
    const auto& operation = good[static_cast<std::size_t>(i) % good.size()];
    const bool binary = i % 3 == 0;
    const std::string frame = mutated(binary ? encodeBinary(operation) : encodeText(operation), rng);
    const auto result = binary ? decodeBinary(frame) : decodeText(frame);
    if (!result) {
      EXPECT_FALSE(result.error().message.empty());
      continue;
    }
    readAsEverything(*result);
    // What was accepted can be written and read again.
    EXPECT_TRUE(decodeText(encodeText(*result)).ok()) << encodeText(*result);
    EXPECT_TRUE(decodeBinary(encodeBinary(*result)).ok());
  }
}

TEST(RosbridgeFuzz, FourThousandDamagedFramesAreReadOrRefused) { runMutations(4000, 1); }

TEST(RosbridgeFuzzCampaign, AMillionDamagedFramesAreReadOrRefused) { runMutations(1000000, 2); }

}  // namespace
}  // namespace longarm::rosbridge
