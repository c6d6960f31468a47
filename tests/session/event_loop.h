#pragma once

/// @file
/// An event loop for tests of controllers whose jobs answer through it.

#include <chrono>
#include <functional>

#include <QCoreApplication>
#include <gtest/gtest.h>

namespace longarm::testing {

/// The application that an event loop needs.
class TestApplication {
 private:
  int m_argc = 1;
  char m_name[5] = "test";
  char* m_argv[2] = {m_name, nullptr};
  QCoreApplication m_application{m_argc, m_argv};
};

class EventLoopTest : public ::testing::Test {
 protected:
  /// Runs events until `condition` holds.  @returns whether it did within a generous time.
  static bool waitFor(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(90);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
    }
    return true;
  }

 private:
  TestApplication m_application;
};

}  // namespace longarm::testing
