#include "vision/match/match_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace longarm::vision {
namespace {

constexpr double kLeastNoise = 0.5;   // rounding to whole grey levels alone makes 0.29

// Noise from the median response of a mask that texture hardly excites (after Immerkaer, CVIU 64(2), 1996; median
// instead of mean, so that edges do not count).
double noiseOf(const cv::Mat& grey) {
  if (grey.cols < 8 || grey.rows < 8) return kLeastNoise;
  const cv::Mat mask = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat response;
  cv::filter2D(grey, response, CV_32F, mask);
  std::vector<float> sizes;
  sizes.reserve(static_cast<std::size_t>(grey.total() / 4 + 1));
  for (int row = 1; row < grey.rows - 1; row += 2) {
    const float* line = response.ptr<float>(row);
    for (int column = 1; column < grey.cols - 1; column += 2) sizes.push_back(std::abs(line[column]));
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return std::max(kLeastNoise, static_cast<double>(*middle) / 0.6745 / 6.0);   // the mask's norm is 6
}

struct Cubic {
  std::array<float, 4> weight, slope;
};

Cubic cubicAt(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {{{-0.5f * t3 + t2 - 0.5f * t, 1.5f * t3 - 2.5f * t2 + 1, -1.5f * t3 + 2 * t2 + 0.5f * t, 0.5f * t3 - 0.5f * t2}},
          {{-1.5f * t2 + 2 * t - 0.5f, 4.5f * t2 - 5 * t, -4.5f * t2 + 4 * t + 0.5f, 1.5f * t2 - t}}};
}

// Keeps a coordinate where it cannot overflow an int.
float bounded(float value, int size) { return std::clamp(value, -4.0f, static_cast<float>(size) + 4); }

}  // namespace

Result<MatchPicture> MatchPicture::from(const cv::Mat& image) {
  if (image.empty()) return Error{ErrorCode::kInvalidInput, "the picture is empty"};
  if (image.type() != CV_8UC1 && image.type() != CV_8UC3) {
    return Error{ErrorCode::kInvalidInput, "the picture is neither 8-bit grey nor 8-bit colour"};
  }
  try {
    MatchPicture out;
    cv::Mat grey = image;
    if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    grey.convertTo(out.m_grey, CV_32F);
    out.m_noise = out.m_noise_left = noiseOf(out.m_grey);
    return out;
  } catch (const std::exception& exception) {
    return Error{ErrorCode::kInternal, std::string("preparing a picture for matching failed: ") + exception.what()};
  }
}

MatchPicture MatchPicture::blurred(double sigma_px) const {
  MatchPicture out;
  cv::GaussianBlur(m_grey, out.m_grey, cv::Size(), sigma_px, sigma_px, cv::BORDER_REPLICATE);
  out.m_noise = m_noise;
  out.m_noise_left = m_noise_left * std::min(1.0, 1 / (2 * std::sqrt(M_PI) * sigma_px));   // of a Gaussian's weights
  return out;
}

float MatchPicture::linear(float u, float v) const {
  u = bounded(u, m_grey.cols);
  v = bounded(v, m_grey.rows);
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  const float a = u - static_cast<float>(column), b = v - static_cast<float>(row);
  const int c0 = std::clamp(column, 0, m_grey.cols - 1), c1 = std::clamp(column + 1, 0, m_grey.cols - 1);
  const float* top = m_grey.ptr<float>(std::clamp(row, 0, m_grey.rows - 1));
  const float* bottom = m_grey.ptr<float>(std::clamp(row + 1, 0, m_grey.rows - 1));
  return (1 - b) * ((1 - a) * top[c0] + a * top[c1]) + b * ((1 - a) * bottom[c0] + a * bottom[c1]);
}

GreySample MatchPicture::cubic(float u, float v) const {
  u = bounded(u, m_grey.cols);
  v = bounded(v, m_grey.rows);
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  const Cubic across = cubicAt(u - static_cast<float>(column)), down = cubicAt(v - static_cast<float>(row));
  GreySample out;
  for (int i = 0; i < 4; ++i) {
    const float* line = m_grey.ptr<float>(std::clamp(row - 1 + i, 0, m_grey.rows - 1));
    float value = 0, slope = 0;
    for (int j = 0; j < 4; ++j) {
      const float pixel = line[std::clamp(column - 1 + j, 0, m_grey.cols - 1)];
      value += across.weight[static_cast<std::size_t>(j)] * pixel;
      slope += across.slope[static_cast<std::size_t>(j)] * pixel;
    }
    out.value += down.weight[static_cast<std::size_t>(i)] * value;
    out.du += down.weight[static_cast<std::size_t>(i)] * slope;
    out.dv += down.slope[static_cast<std::size_t>(i)] * value;
  }
  return out;
}

}  // namespace longarm::vision
