#pragma once

/// @file
/// Pictures from and to files and memory.  The header is checked before anything is decoded, so that a small
/// file cannot ask for gigabytes.

#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "core/result.h"

namespace longarm::vision {

struct ImageLimits {
  int max_side_px = 16384;
  long long max_pixels = 64LL << 20;
};

struct ImageSize {
  int width = 0, height = 0;
  const char* format = "";        ///< "png", "jpeg", "bmp", "pnm" or "tiff".
};

/// Size as the file's header states it, for PNG, JPEG, BMP, PPM/PGM/PBM and TIFF.
/// @returns kInvalidInput: another kind of file, a damaged header, or kOutOfLimits.  Pure function.
Result<ImageSize> imageSizeFromHeader(std::string_view bytes, const ImageLimits& limits = {});

/// Decodes to 8-bit grey or BGR, whichever the file holds; EXIF orientation is ignored because a camera
/// model belongs to the pixels as stored.  @returns as imageSizeFromHeader, or kInvalidInput when the content
/// does not decode.  Never throws; thread-safe.
Result<cv::Mat> decodeImage(std::string_view bytes, const ImageLimits& limits = {});
/// The same from a file; the message names it.
Result<cv::Mat> loadImage(const std::string& path, const ImageLimits& limits = {});

/// Writes PNG or JPEG (quality 95), by the ending of `path`; beside, then renamed.
/// @returns kInvalidInput for another ending or an empty picture.
Status saveImage(const std::string& path, const cv::Mat& image);

}  // namespace longarm::vision
