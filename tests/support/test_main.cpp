// Main of every test program: C numbers whatever the locale, broken requirements become exceptions.
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "core/require.h"

int main(int argc, char** argv) {
  longarm::setRequireHandler([](const std::string& what) { throw std::logic_error(what); });
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
