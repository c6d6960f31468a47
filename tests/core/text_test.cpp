#include <clocale>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/text.h"

namespace longarm {
namespace {

TEST(Numbers, ReadAndWriteWithAPointInAnyLocale) {
  // Where the locale is not installed setlocale returns null and the test still checks the C locale.
  std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
  EXPECT_DOUBLE_EQ(*parseNumber(" 1.5\n"), 1.5);
  EXPECT_DOUBLE_EQ(*parseNumber("+2e-3"), 2e-3);
  EXPECT_EQ(formatNumber(0.1), "0.1");
  EXPECT_EQ(formatFixed(1.25, 1), "1.2");
  std::setlocale(LC_NUMERIC, "C");
}

TEST(Numbers, RefuseWhatIsNotWhollyANumber) {
  for (const char* bad : {"", " ", "1,5", "1.5m", "--1", "0x10", "e5"}) EXPECT_FALSE(parseNumber(bad)) << bad;
  EXPECT_NE(parseNumbers("1 2,x3 4").error().message.find("\"x3\""), std::string::npos);
  EXPECT_EQ(parseNumbers(" 1, 2  3\n").value().size(), 3u);
}

TEST(Files, AreReplacedWholeOrNotAtAll) {
  const auto path = (std::filesystem::temp_directory_path() / "longarm_text_test.txt").string();
  ASSERT_TRUE(writeFileAtomically(path, "one").ok());
  ASSERT_TRUE(writeFileAtomically(path, "two").ok());
  EXPECT_EQ(readTextFile(path).value(), "two");
  EXPECT_EQ(readTextFile(path, 2).error().code, ErrorCode::kInvalidInput);
  std::filesystem::remove(path);
  EXPECT_EQ(readTextFile(path).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(writeFileAtomically("/nowhere/at/all.txt", "x").ok());
  EXPECT_EQ(readTextFile("/dev/zero").error().code, ErrorCode::kInvalidInput);
}

}  // namespace
}  // namespace longarm
