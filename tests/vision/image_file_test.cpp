// Picture headers are checked before anything is decoded.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/test_data.h"
#include "tests/vision/temporary_file.h"
#include "vision/snapshot/image_file.h"

namespace longarm::tests {
namespace {

using vision::decodeImage;
using vision::imageSizeFromHeader;

std::string encoded(const std::string& ending, int width = 37, int height = 21, int type = CV_8UC3) {
  cv::Mat image(height, width, type);
  cv::randu(image, 0, 255);
  std::vector<unsigned char> bytes;
  cv::imencode(ending, image, bytes);
  return {bytes.begin(), bytes.end()};
}

std::string bigEndian(std::uint32_t value) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xFF);
  return out;
}

TEST(ImageFile, HeadersOfEveryKindStateTheSize) {
  const std::pair<const char*, const char*> kinds[] = {{".png", "png"}, {".jpg", "jpeg"}, {".bmp", "bmp"},
                                                       {".ppm", "pnm"}, {".tiff", "tiff"}};
  for (const auto& [ending, name] : kinds) {
    const std::string bytes = encoded(ending);
    const auto size = imageSizeFromHeader(bytes);
    ASSERT_TRUE(size.ok()) << name << ": " << size.error().message;
    EXPECT_EQ(size->width, 37) << name;
    EXPECT_EQ(size->height, 21) << name;
    EXPECT_STREQ(size->format, name);
    const auto image = decodeImage(bytes);
    ASSERT_TRUE(image.ok()) << name << ": " << image.error().message;
    EXPECT_EQ(image->size(), cv::Size(37, 21));
  }
  EXPECT_EQ(decodeImage(encoded(".png", 5, 4, CV_8UC1))->type(), CV_8UC1);
}

TEST(ImageFile, ABombIsRefusedByItsHeaderAlone) {
  std::string bomb = encoded(".png");
  bomb.replace(16, 8, bigEndian(30000) + bigEndian(30000));
  const auto size = imageSizeFromHeader(bomb);
  ASSERT_FALSE(size.ok());
  EXPECT_EQ(size.error().code, ErrorCode::kOutOfLimits);
  EXPECT_NE(size.error().message.find("30000 x 30000"), std::string::npos) << size.error().message;
  EXPECT_FALSE(decodeImage(bomb).ok());
  bomb.replace(16, 8, bigEndian(16000) + bigEndian(16000));
  EXPECT_EQ(imageSizeFromHeader(bomb).error().code, ErrorCode::kOutOfLimits) << "256 megapixels";
  bomb.replace(16, 8, bigEndian(0) + bigEndian(5));
  EXPECT_EQ(imageSizeFromHeader(bomb).error().code, ErrorCode::kInvalidInput);
}

TEST(ImageFile, APngWithOneWrongBitIsRefusedNotShownInPart) {
  const std::string whole = encoded(".png");
  for (std::size_t at = 8; at < whole.size() - 12; at += 7) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    EXPECT_FALSE(decodeImage(damaged).ok()) << "byte " << at;
  }
  const auto cut = decodeImage(std::string_view(whole).substr(0, whole.size() - 20));
  ASSERT_FALSE(cut.ok());
  EXPECT_NE(cut.error().message.find("byte"), std::string::npos) << cut.error().message;
}

TEST(ImageFile, LimitsCanBeSet) {
  vision::ImageLimits limits;
  limits.max_side_px = 36;
  EXPECT_EQ(imageSizeFromHeader(encoded(".jpg"), limits).error().code, ErrorCode::kOutOfLimits);
  limits.max_side_px = 37;
  limits.max_pixels = 37 * 21;
  EXPECT_TRUE(imageSizeFromHeader(encoded(".jpg"), limits).ok());
}

TEST(ImageFile, ShortenedPicturesAreRefusedOrWhole) {
  for (const char* ending : {".png", ".jpg", ".bmp", ".ppm", ".tiff"}) {
    const std::string whole = encoded(ending);
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 40) {
      const auto image = decodeImage(std::string_view(whole).substr(0, length));
      if (image.ok()) {
        EXPECT_EQ(image->size(), cv::Size(37, 21)) << ending;
      } else {
        EXPECT_GT(image.error().message.size(), 10u);
      }
    }
  }
}

TEST(ImageFile, OtherFilesAreRefusedBySentence) {
  EXPECT_NE(imageSizeFromHeader("").error().message.find("empty"), std::string::npos);
  EXPECT_NE(imageSizeFromHeader("hello, world").error().message.find("PNG"), std::string::npos);
  const TemporaryFile text("text.png", "this is no picture");
  const auto image = vision::loadImage(text.path());
  ASSERT_FALSE(image.ok());
  EXPECT_NE(image.error().message.find(text.path()), std::string::npos) << image.error().message;
  EXPECT_EQ(vision::loadImage("/no/such.png").error().code, ErrorCode::kNotFound);
}

TEST(ImageFile, PngReadsBackEqualAndOtherEndingsAreRefused) {
  cv::Mat image(20, 30, CV_8UC3);
  cv::randu(image, 0, 255);
  const TemporaryFile png("out.png"), jpeg("out.JPG"), gif("out.gif");
  ASSERT_TRUE(vision::saveImage(png.path(), image).ok());
  const auto back = vision::loadImage(png.path());
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(cv::norm(*back, image, cv::NORM_INF), 0);
  EXPECT_TRUE(vision::saveImage(jpeg.path(), image).ok());
  EXPECT_FALSE(vision::saveImage(gif.path(), image).ok());
  EXPECT_FALSE(vision::saveImage(png.path(), cv::Mat()).ok());
  EXPECT_FALSE(vision::saveImage("/no/such/folder/out.png", image).ok());
}

TEST(ImageFile, TheDataSetsBombIsRefused) {
  LONGARM_SKIP_WITHOUT_DATA();
  const auto bomb = vision::loadImage(dataFolder() + "/hostile/bomb30k.png");
  ASSERT_FALSE(bomb.ok());
  EXPECT_EQ(bomb.error().code, ErrorCode::kOutOfLimits) << bomb.error().message;
}

}  // namespace
}  // namespace longarm::tests
