// Main of every test program without widgets: broken requirements become exceptions.
// With LONGARM_TEST_LOCALE=de_DE.UTF-8 the whole program runs under a decimal comma.
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "core/require.h"

int main(int argc, char** argv) {
  longarm::setRequireHandler([](const std::string& what) { throw std::logic_error(what); });
  testing::InitGoogleTest(&argc, argv);
  const char* locale = std::getenv("LONGARM_TEST_LOCALE");
  if (locale != nullptr && std::setlocale(LC_ALL, locale) == nullptr) {
    std::fprintf(stderr, "locale %s is not installed; set LOCPATH or LONGARM_TEST_LOCALE=\n", locale);
    return 1;
  }
  return RUN_ALL_TESTS();
}
