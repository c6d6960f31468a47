#include "core/printable.h"

#include <gtest/gtest.h>

namespace longarm {
namespace {

TEST(Printable, LeavesGoodTextAlone) {
  for (const char* text : {"", "plain", "gr\xC3\xBC\xC3\x9F", "5 \xE2\x82\xAC", "\xF0\x9F\x98\x80", "\xEF\xBF\xBD"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, MakesOneLineOfMany) { EXPECT_EQ(printable("a\nb\r\nc\td"), "a b  c d"); }

TEST(Printable, ReplacesControlCharactersAndBrokenUtf8) {
  EXPECT_EQ(printable(std::string("\x1b[31m\0x", 7)), "?[31m?x");
  EXPECT_EQ(printable("\x7f"), "?");
  EXPECT_EQ(printable("\xC2\x9B" "A"), "?A") << "a terminal's 8-bit escape";
  EXPECT_EQ(printable("\xFF\xFE"), "??");
  EXPECT_EQ(printable("\xC3"), "?") << "cut in the middle";
  EXPECT_EQ(printable("\xC0\xAF"), "??") << "not the shortest form";
  EXPECT_EQ(printable("\xED\xA0\x80"), "???") << "a surrogate";
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "????") << "beyond U+10FFFF";
}

TEST(Printable, CutsWhatIsTooLong) {
  EXPECT_EQ(printable(std::string(30, 'a'), 10), std::string(10, 'a') + "...");
  EXPECT_EQ(printable(std::string(10, 'a'), 10), std::string(10, 'a'));
}

TEST(Printable, TouchesOnlyTheMessageOfAResult) {
  EXPECT_EQ(printable(Result<std::string>(std::string("a\n"))).value(), "a\n");
  const auto error = printable(Result<int>(ErrorCode::kNotFound, "x\x01"));
  EXPECT_EQ(error.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(error.error().message, "x?");
}

}  // namespace
}  // namespace longarm
