#include "tests/hardware/device_contract.h"

#include <atomic>
#include <optional>
#include <thread>

#include "tests/hardware/device_rigs.h"

namespace longarm::hardware::tests {
namespace {

TEST_P(DeviceContract, IsClosedAtFirstAndRefusesEverythingButOpen) {
  EXPECT_EQ(device().state(), DeviceState::kClosed);
  EXPECT_FALSE(device().name().empty());
  EXPECT_EQ(device().activate().error().code, ErrorCode::kRefused);
  EXPECT_FALSE(rig().command().ok());
  device().stop();
  device().deactivate();
  device().close();
  EXPECT_TRUE(device().clearFault().ok());
  EXPECT_EQ(device().state(), DeviceState::kClosed);
}

TEST_P(DeviceContract, OpensOnceHoweverOftenItIsAsked) {
  ASSERT_TRUE(device().open().ok());
  ASSERT_TRUE(device().open().ok());
  ASSERT_TRUE(rig().becomes(DeviceState::kIdle)) << device().message();
  ASSERT_TRUE(device().open().ok());
  EXPECT_EQ(device().state(), DeviceState::kIdle);
  EXPECT_TRUE(device().message().empty()) << device().message();
}

TEST_P(DeviceContract, ClosesOnceHoweverOftenItIsAsked) {
  rig().openAndActivate();
  device().close();
  EXPECT_EQ(device().state(), DeviceState::kClosed);
  device().close();
  EXPECT_EQ(device().state(), DeviceState::kClosed);
}

TEST_P(DeviceContract, WorksAgainAfterItWasClosed) {
  for (int i = 0; i < 3; ++i) {
    rig().openAndActivate();
    const auto status = rig().command();
    ASSERT_TRUE(status.ok()) << status.error().message;
    device().close();
  }
}

TEST_P(DeviceContract, MayBeClosedWhileItOpens) {
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(device().open().ok());
    device().close();
    EXPECT_EQ(device().state(), DeviceState::kClosed);
  }
}

TEST_P(DeviceContract, IsActivatedOnlyWhenIdle) {
  rig().openAndActivate();
  const auto again = device().activate();
  ASSERT_FALSE(again.ok());
  EXPECT_EQ(again.error().code, ErrorCode::kRefused);
  EXPECT_NE(again.error().message.find(device().name()), std::string::npos) << again.error().message;
  device().deactivate();
  EXPECT_EQ(device().state(), DeviceState::kIdle);
  EXPECT_TRUE(device().activate().ok());
}

TEST_P(DeviceContract, RefusesCommandsWhileIdle) {
  ASSERT_TRUE(device().open().ok());
  ASSERT_TRUE(rig().becomes(DeviceState::kIdle));
  const auto refused = rig().command();
  if (rig().commandIsConfiguration()) {
    EXPECT_TRUE(refused.ok()) << refused.error().message;
    return;
  }
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kRefused);
  EXPECT_NE(refused.error().message.find("idle"), std::string::npos) << refused.error().message;
  EXPECT_EQ(device().state(), DeviceState::kIdle);
}

TEST_P(DeviceContract, StopFromAnotherThreadEndsTheMotion) {
  rig().openAndActivate();
  ASSERT_TRUE(rig().command().ok());
  if (rig().moves()) {
    ASSERT_TRUE(rig().until([&] { return *rig().moves(); })) << "it did not move at all";
  }
  std::thread([&] { device().stop(); }).join();
  EXPECT_EQ(device().state(), DeviceState::kIdle);
  if (rig().moves()) {
    EXPECT_TRUE(rig().until([&] { return !*rig().moves(); })) << "it still moves";
  }
  if (!rig().commandIsConfiguration()) {
    EXPECT_EQ(rig().command().error().code, ErrorCode::kRefused);
  }
  EXPECT_TRUE(device().activate().ok());
}

TEST_P(DeviceContract, AFaultBlocksEverythingUntilItIsCleared) {
  rig().openAndActivate();
  if (!rig().breakIt()) GTEST_SKIP() << "nothing can go wrong with this one";
  ASSERT_TRUE(rig().becomes(DeviceState::kFault));
  const std::string why = device().message();
  EXPECT_FALSE(why.empty());
  const auto refused = rig().command();
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kRefused);
  EXPECT_NE(refused.error().message.find(why), std::string::npos) << refused.error().message;
  EXPECT_FALSE(device().activate().ok());
  device().stop();
  device().deactivate();
  EXPECT_TRUE(device().open().ok());
  EXPECT_EQ(device().state(), DeviceState::kFault) << "only clearFault() or close() may end a fault";
  rig().mend();
  ASSERT_TRUE(rig().until([&] { return device().clearFault().ok(); })) << device().message();
  EXPECT_EQ(device().state(), DeviceState::kIdle);
  EXPECT_TRUE(device().activate().ok());
  EXPECT_TRUE(rig().command().ok());
}

TEST_P(DeviceContract, CanBeReopenedAfterAFault) {
  rig().openAndActivate();
  if (!rig().breakIt()) GTEST_SKIP() << "nothing can go wrong with this one";
  ASSERT_TRUE(rig().becomes(DeviceState::kFault));
  rig().mend();
  device().close();
  EXPECT_EQ(device().state(), DeviceState::kClosed);
  rig().openAndActivate();
  EXPECT_TRUE(rig().command().ok());
}

TEST_P(DeviceContract, IsDestroyedWhileItMoves) {
  rig().openAndActivate();
  ASSERT_TRUE(rig().command().ok());
  rig().destroyDevice();
}

TEST_P(DeviceContract, StandsCallsFromManyThreadsAtOnce) {
  std::atomic<bool> quit{false};
  std::vector<std::thread> threads;
  const auto repeat = [&](const std::function<void()>& call) {
    threads.emplace_back([&quit, call] {
      while (!quit) {
        call();
        std::this_thread::yield();
      }
    });
  };
  repeat([&] { device().stop(); });
  repeat([&] { (void)rig().command(); });
  repeat([&] { (void)device().message(); });
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(device().open().ok());
    rig().pass(0.005);
    (void)device().activate();
    (void)device().clearFault();
    device().close();
  }
  quit = true;
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(device().state(), DeviceState::kClosed);
}

INSTANTIATE_TEST_SUITE_P(Devices, DeviceContract, ::testing::ValuesIn(allDeviceCases()),
                         [](const auto& device) { return device.param.name; });

}  // namespace
}  // namespace longarm::hardware::tests
