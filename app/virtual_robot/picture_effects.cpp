#include "app/virtual_robot/picture_effects.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "app/virtual_robot/seeded_random.h"

namespace longarm::virtual_robot {
namespace {

constexpr int kBankSlack = 251;          // the bank is this much larger than the picture, both ways [px]
constexpr double kScale = 1024;          // of the bank's numbers
constexpr unsigned kBankSeed = 20040601;

}  // namespace

void NoiseBank::addTo(cv::Mat& picture, double sigma, unsigned seed) {
  if (!(sigma > 0) || picture.empty()) return;
  const int rows = picture.rows + kBankSlack, columns = picture.cols + kBankSlack;
  if (m_bank.rows < rows || m_bank.cols < columns) {
    m_bank.create(rows, columns, CV_16SC3);
    cv::RNG random(kBankSeed);
    random.fill(m_bank, cv::RNG::NORMAL, 0, kScale);
  }
  SeededRandom random(seed);
  const int x = static_cast<int>(random.word() % kBankSlack), y = static_cast<int>(random.word() % kBankSlack);
  const cv::Mat part = m_bank(cv::Rect(x, y, picture.cols, picture.rows));
  cv::Mat wide;
  picture.convertTo(wide, CV_16S);
  cv::addWeighted(part, sigma / kScale, wide, 1, 0, wide);
  wide.convertTo(picture, CV_8U);
}

void addGlare(cv::Mat& picture) {
  const double radius = 0.22 * picture.cols;
  const double cx = 0.62 * picture.cols, cy = 0.28 * picture.rows;
  for (int v = 0; v < picture.rows; ++v) {
    auto* row = picture.ptr<cv::Vec3b>(v);
    for (int u = 0; u < picture.cols; ++u) {
      const double r2 = ((u - cx) * (u - cx) + (v - cy) * (v - cy)) / (radius * radius);
      const double light = 60 + 600 * std::exp(-r2);
      for (int k = 0; k < 3; ++k) row[u][k] = cv::saturate_cast<uchar>(row[u][k] + light);
    }
  }
}

void darken(cv::Mat& picture) { picture.convertTo(picture, -1, 0.02, 0); }

}  // namespace longarm::virtual_robot
