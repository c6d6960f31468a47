#include "session/calibration/board_collection.h"

#include <cmath>
#include <utility>

#include "core/text.h"
#include "vision/snapshot/image_file.h"

namespace longarm::session {

namespace {

constexpr double kSameZoom = 0.005;                // Settings nearer than this are one lens.

std::string sizeText(const cv::Mat& image) { return std::to_string(image.cols) + " x " + std::to_string(image.rows); }

}  // namespace

Result<BoardPicture> searchedPicture(const std::string& name, const cv::Mat& image, const calibration::BoardSpec& spec, bool live) {
  BoardPicture out;
  out.name = name;
  out.image = image;
  if (image.empty()) {
    auto read = vision::loadImage(name);
    if (!read) return read.error();
    out.image = std::move(*read);
  }
  auto view = live ? calibration::detectBoardLive(out.image, spec, name) : calibration::detectBoard(out.image, spec, name);
  if (view) out.view = std::move(*view);
  else out.why = view.error().message;
  return out;
}

Status BoardCollection::add(BoardPicture picture) {
  if (m_pictures.size() >= kMost) {
    return {ErrorCode::kOutOfLimits, picture.name + ": there are " + std::to_string(kMost) +
                                         " pictures already, and more teach nothing. Remove some first."};
  }
  if (!m_pictures.empty() && (picture.image.cols != width() || picture.image.rows != height())) {
    return {ErrorCode::kInvalidInput, picture.name + " is " + sizeText(picture.image) + " pixels, the first picture is " +
                                          sizeText(m_pictures.front().image) +
                                          ". A calibration needs pictures of one size from one camera: start anew for another."};
  }
  m_pictures.push_back(std::move(picture));
  return {};
}

std::optional<double> BoardCollection::zoom() const {
  for (auto picture = m_pictures.rbegin(); picture != m_pictures.rend(); ++picture) {
    if (picture->view && picture->included) return picture->zoom;
  }
  return std::nullopt;
}

bool BoardCollection::sameZoom(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || std::abs(*a - *b) < kSameZoom);
}

std::vector<std::size_t> BoardCollection::usable() const {
  const auto newest = zoom();
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < m_pictures.size(); ++i) {
    if (m_pictures[i].view && m_pictures[i].included && sameZoom(m_pictures[i].zoom, newest)) out.push_back(i);
  }
  return out;
}

std::string BoardCollection::whyNotReady() const {
  const std::size_t count = usable().size();
  if (count >= kLeast) return {};
  if (m_pictures.empty()) return "There are no pictures yet: open some, or choose a live camera and show it the board.";
  return std::to_string(count) + " pictures with a board are included; at least " + std::to_string(kLeast) +
         ", with the board tilted differently, are needed.";
}

std::optional<std::size_t> IntrinsicsOutcome::viewOf(std::size_t picture_index) const {
  for (std::size_t k = 0; k < picture.size(); ++k) {
    if (picture[k] == picture_index) return k;
  }
  return std::nullopt;
}

std::vector<Eigen::Vector2d> IntrinsicsOutcome::residuals(std::size_t view) const {
  std::vector<Eigen::Vector2d> out;
  for (const auto& corner : views[view].corners) {
    Eigen::Vector2d pixel = corner.pixel;
    (void)calibration::projectPoint(result.camera, result.views[view].X_CK * corner.xyz, &pixel);
    out.push_back(corner.pixel - pixel);
  }
  return out;
}

Result<IntrinsicsOutcome> solveBoards(const BoardCollection& boards, const calibration::LensChoice& lens) {
  if (const std::string why = boards.whyNotReady(); !why.empty()) return {ErrorCode::kRefused, why};
  IntrinsicsOutcome out;
  out.zoom = boards.zoom();
  out.picture = boards.usable();
  for (const std::size_t i : out.picture) out.views.push_back(*boards.pictures()[i].view);
  calibration::IntrinsicsOptions options;
  options.lens = lens;
  auto result = calibration::calibrateIntrinsics(out.views, boards.width(), boards.height(), options);
  if (!result) return result.error();
  out.result = std::move(*result);
  out.coverage = calibration::coverageOf(out.views, out.result);
  out.next = calibration::nextView(out.views, out.result);
  auto uncertainty = calibration::lensUncertainty(out.result.camera, out.result.covariance);
  if (!uncertainty) return uncertainty.error();
  out.uncertainty = std::move(*uncertainty);
  return out;
}

std::string cornersText(const std::vector<calibration::BoardView>& views) {
  std::string out = "view,x,y,z,u,v\n";
  for (const auto& view : views) {
    for (const auto& c : view.corners) {
      out += view.name;
      for (const double number : {c.xyz.x(), c.xyz.y(), c.xyz.z(), c.pixel.x(), c.pixel.y()}) out += "," + formatNumber(number);
      out += "\n";
    }
  }
  return out;
}

}  // namespace longarm::session
