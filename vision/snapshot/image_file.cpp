#include "vision/snapshot/image_file.h"

#include <array>
#include <cctype>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "core/text.h"

namespace longarm::vision {
namespace {

constexpr std::size_t kMaxFileBytes = 256u << 20;

// Numbers of a header by their offset; outside the text they read as nothing.
class Bytes {
 public:
  explicit Bytes(std::string_view text) : m_text(text) {}

  std::optional<std::uint64_t> read(std::size_t at, int count, bool big_endian) const {
    if (at > m_text.size() || m_text.size() - at < static_cast<std::size_t>(count)) return std::nullopt;
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i) {
      const auto byte = static_cast<unsigned char>(m_text[at + static_cast<std::size_t>(big_endian ? i : count - 1 - i)]);
      value = value << 8 | byte;
    }
    return value;
  }
  bool startsWith(std::string_view prefix) const { return m_text.substr(0, prefix.size()) == prefix; }
  std::string_view text() const { return m_text; }

 private:
  std::string_view m_text;
};

struct Sides {
  std::uint64_t width = 0, height = 0;
};

std::optional<Sides> pngSides(const Bytes& bytes) {
  if (bytes.text().size() < 24 || bytes.text().substr(12, 4) != "IHDR") return std::nullopt;
  const auto width = bytes.read(16, 4, true), height = bytes.read(20, 4, true);
  return width && height ? std::optional<Sides>({*width, *height}) : std::nullopt;
}

// The frame header (SOFn) is behind any number of other segments.
std::optional<Sides> jpegSides(const Bytes& bytes) {
  std::size_t at = 2;
  while (true) {
    const auto marker = bytes.read(at, 2, true);
    if (!marker || (*marker >> 8) != 0xFF) return std::nullopt;
    const unsigned code = *marker & 0xFF;
    if (code == 0xFF) {   // fill byte
      ++at;
      continue;
    }
    if (code == 0x01 || (code >= 0xD0 && code <= 0xD8)) {   // no length
      at += 2;
      continue;
    }
    if (code == 0xD9 || code == 0xDA) return std::nullopt;   // picture data before any frame header
    const auto length = bytes.read(at + 2, 2, true);
    if (!length || *length < 2) return std::nullopt;
    if (code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC) {
      const auto height = bytes.read(at + 5, 2, true), width = bytes.read(at + 7, 2, true);
      return width && height ? std::optional<Sides>({*width, *height}) : std::nullopt;
    }
    at += 2 + static_cast<std::size_t>(*length);
  }
}

std::optional<Sides> bmpSides(const Bytes& bytes) {
  const auto header = bytes.read(14, 4, false);
  if (!header) return std::nullopt;
  if (*header == 12) {
    const auto width = bytes.read(18, 2, false), height = bytes.read(20, 2, false);
    return width && height ? std::optional<Sides>({*width, *height}) : std::nullopt;
  }
  const auto width = bytes.read(18, 4, false), height = bytes.read(22, 4, false);
  if (!width || !height) return std::nullopt;
  const auto rows = static_cast<std::int32_t>(*height);   // negative: stored from the top
  return Sides{*width, static_cast<std::uint64_t>(rows < 0 ? -static_cast<std::int64_t>(rows) : rows)};
}

std::optional<Sides> pnmSides(const Bytes& bytes) {
  const std::string_view text = bytes.text();
  std::size_t at = 2;
  const auto next = [&]() -> std::optional<std::uint64_t> {
    while (at < text.size() && (std::isspace(static_cast<unsigned char>(text[at])) != 0 || text[at] == '#')) {
      if (text[at] == '#') {
        while (at < text.size() && text[at] != '\n') ++at;
      } else {
        ++at;
      }
    }
    std::size_t end = at;
    while (end < text.size() && text[end] >= '0' && text[end] <= '9' && end - at < 12) ++end;
    const auto number = parseInteger(text.substr(at, end - at));
    at = end;
    return number ? std::optional<std::uint64_t>(static_cast<std::uint64_t>(*number)) : std::nullopt;
  };
  const auto width = next();
  const auto height = next();
  return width && height ? std::optional<Sides>({*width, *height}) : std::nullopt;
}

std::optional<Sides> tiffSides(const Bytes& bytes) {
  const bool big = bytes.startsWith("MM");
  const auto directory = bytes.read(4, 4, big);
  const auto entries = directory ? bytes.read(*directory, 2, big) : std::nullopt;
  if (!entries) return std::nullopt;
  Sides sides;
  for (std::size_t i = 0; i < *entries; ++i) {
    const std::size_t at = static_cast<std::size_t>(*directory) + 2 + 12 * i;
    const auto tag = bytes.read(at, 2, big), type = bytes.read(at + 2, 2, big);
    if (!tag || !type) return std::nullopt;
    if (*tag != 256 && *tag != 257) continue;
    const auto value = bytes.read(at + 8, *type == 3 ? 2 : 4, big);
    if (!value) return std::nullopt;
    (*tag == 256 ? sides.width : sides.height) = *value;
  }
  return sides;
}

struct Kind {
  const char* name;
  std::optional<Sides> (*sides)(const Bytes&);
};

std::optional<Kind> kindOf(const Bytes& bytes) {
  if (bytes.startsWith("\x89PNG\r\n\x1a\n")) return Kind{"png", &pngSides};
  if (bytes.startsWith("\xFF\xD8\xFF")) return Kind{"jpeg", &jpegSides};
  if (bytes.startsWith("BM")) return Kind{"bmp", &bmpSides};
  if (bytes.startsWith(std::string_view("II*\0", 4)) || bytes.startsWith(std::string_view("MM\0*", 4))) {
    return Kind{"tiff", &tiffSides};
  }
  const auto text = bytes.text();
  if (text.size() > 2 && text[0] == 'P' && text[1] >= '1' && text[1] <= '6') return Kind{"pnm", &pnmSides};
  return std::nullopt;
}

// CRC-32 of ISO 3309, as PNG's chunks carry it.
std::uint32_t crc32(std::string_view data) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> out{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
      out[n] = c;
    }
    return out;
  }();
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char c : data) crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xFF] ^ (crc >> 8);
  return ~crc;
}

// What is wrong with a PNG's chunks, or nothing.  OpenCV returns the part it could decode of a shortened file.
std::string pngFault(std::string_view text) {
  const Bytes bytes(text);
  for (std::size_t at = 8; at < text.size();) {
    const auto length = bytes.read(at, 4, true);
    const auto crc = length ? bytes.read(at + 8 + static_cast<std::size_t>(*length), 4, true) : std::nullopt;
    if (!crc) return "it ends in the middle of a chunk, at byte " + std::to_string(text.size());
    const auto chunk = text.substr(at + 4, 4 + static_cast<std::size_t>(*length));
    if (crc32(chunk) != *crc) return "the checksum of the chunk at byte " + std::to_string(at) + " does not match";
    if (chunk.substr(0, 4) == "IEND") return {};
    at += 12 + static_cast<std::size_t>(*length);
  }
  return "its end is missing";
}

std::string sizeText(const Sides& sides) {
  return std::to_string(sides.width) + " x " + std::to_string(sides.height) + " pixels";
}

}  // namespace

Result<ImageSize> imageSizeFromHeader(std::string_view text, const ImageLimits& limits) {
  const Bytes bytes(text);
  const auto kind = kindOf(bytes);
  if (!kind) {
    return Error{ErrorCode::kInvalidInput, text.empty() ? std::string("the file is empty; expected a picture")
                                                        : "is no picture of a known kind (PNG, JPEG, BMP, PPM, TIFF)"};
  }
  const auto sides = kind->sides(bytes);
  if (!sides || sides->width == 0 || sides->height == 0) {
    return Error{ErrorCode::kInvalidInput, std::string("the ") + kind->name + " header is damaged: it states no size"};
  }
  const auto side = static_cast<std::uint64_t>(limits.max_side_px);
  if (sides->width > side || sides->height > side ||
      sides->width * sides->height > static_cast<std::uint64_t>(limits.max_pixels)) {
    return Error{ErrorCode::kOutOfLimits, "the picture is " + sizeText(*sides) + "; at most " +
                                              std::to_string(limits.max_side_px) + " a side and " +
                                              std::to_string(limits.max_pixels >> 20) + " megapixels are read"};
  }
  return ImageSize{static_cast<int>(sides->width), static_cast<int>(sides->height), kind->name};
}

Result<cv::Mat> decodeImage(std::string_view bytes, const ImageLimits& limits) {
  const auto size = imageSizeFromHeader(bytes, limits);
  if (!size) return size.error();
  const auto damaged = [&](const std::string& why) {
    return Error{ErrorCode::kInvalidInput, std::string("the ") + size->format + " picture is damaged: " + why};
  };
  if (std::string_view(size->format) == "png") {
    if (const std::string fault = pngFault(bytes); !fault.empty()) return damaged(fault);
  }
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    cv::Mat image = cv::imdecode(encoded, cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
    if (image.empty()) return damaged("it does not decode");
    if (image.cols != size->width || image.rows != size->height) return damaged("its size is not what its header says");
    if (image.type() != CV_8UC1 && image.type() != CV_8UC3) return damaged("it is neither grey nor colour");
    return image;
  } catch (const cv::Exception& exception) {
    return damaged(exception.err);
  } catch (const std::exception& exception) {
    return damaged(exception.what());
  }
}

Result<cv::Mat> loadImage(const std::string& path, const ImageLimits& limits) {
  const auto bytes = readTextFile(path, kMaxFileBytes);
  if (!bytes) return bytes.error();
  auto image = decodeImage(*bytes, limits);
  if (!image) return Error{image.error().code, "picture " + path + ": " + image.error().message};
  return image;
}

Status saveImage(const std::string& path, const cv::Mat& image) {
  std::string ending = path.substr(path.find_last_of('.') == std::string::npos ? path.size() : path.find_last_of('.'));
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending != ".png" && ending != ".jpg" && ending != ".jpeg") {
    return {ErrorCode::kInvalidInput, "picture " + path + ": pictures are written as .png, .jpg or .jpeg"};
  }
  if (image.empty()) return {ErrorCode::kInvalidInput, "picture " + path + ": there is nothing to write"};
  try {
    std::vector<unsigned char> bytes;
    const std::vector<int> options = ending == ".png" ? std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, 3}
                                                      : std::vector<int>{cv::IMWRITE_JPEG_QUALITY, 95};
    if (!cv::imencode(ending, image, bytes, options)) return {ErrorCode::kInternal, "picture " + path + ": encoding failed"};
    return writeFileAtomically(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  } catch (const std::exception& exception) {
    return {ErrorCode::kInternal, "picture " + path + ": " + exception.what()};
  }
}

}  // namespace longarm::vision
