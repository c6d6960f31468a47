#include "session/calibration/fixture_controller.h"

#include <algorithm>
#include <iterator>

#include "core/text.h"
#include "vision/camera/camera_file.h"
#include "vision/snapshot/image_file.h"

namespace longarm::session {

using calibration::Dot;
using calibration::DotMatch;
using calibration::Fixture;
using calibration::FixtureResult;

namespace {

constexpr std::size_t kLeast = 6;

struct SearchedPicture {
  cv::Mat image;
  std::vector<Dot> dots;
};

Result<SearchedPicture> searched(const cv::Mat& image) {
  auto dots = calibration::findDots(image);
  if (!dots) return dots.error();
  return SearchedPicture{image, std::move(*dots)};
}

}  // namespace

FixtureController::FixtureController(JobRunner& jobs, QObject* parent) : QObject(parent), m_jobs(jobs) {
  m_lens.open_skew = true;
  matchesChanged();
}

void FixtureController::openFixture(const QString& path) {
  m_jobs.run<Fixture>(
      this, [file = path.toStdString()] { return calibration::readFixture(file); },
      [this](Result<Fixture> fixture) {
        if (!fixture) {
          Q_EMIT failed(QString::fromStdString(fixture.error().message));
          return;
        }
        m_fixture = std::move(*fixture);
        m_matches.clear();
        m_point = 0;
        Q_EMIT fixtureChanged();
        matchesChanged();
      });
}

void FixtureController::openPicture(const QString& path) {
  m_jobs.run<SearchedPicture>(
      this,
      [file = path.toStdString()]() -> Result<SearchedPicture> {
        const auto image = vision::loadImage(file);
        return image ? searched(*image) : Result<SearchedPicture>(image.error());
      },
      [this, path](Result<SearchedPicture> picture) {
        if (!picture) {
          Q_EMIT failed(QString::fromStdString(picture.error().message));
          return;
        }
        m_picture = picture->image;
        m_picture_name = path;
        m_dots = std::move(picture->dots);
        m_matches.clear();
        matchesChanged();
      });
}

void FixtureController::setPicture(const cv::Mat& picture, const QString& name) {
  m_jobs.run<SearchedPicture>(
      this, [picture] { return searched(picture); },
      [this, name](Result<SearchedPicture> result) {
        if (!result) {
          Q_EMIT failed(QString::fromStdString(result.error().message));
          return;
        }
        m_picture = result->image;
        m_picture_name = name;
        m_dots = std::move(result->dots);
        m_matches.clear();
        matchesChanged();
      });
}

void FixtureController::setPoint(int index) {
  m_point = m_fixture && index >= 0 && index < static_cast<int>(m_fixture->points.size()) ? index : -1;
  Q_EMIT changed();
}

void FixtureController::nextPoint() {
  const auto placed = [this](int i) {
    return std::any_of(m_matches.begin(), m_matches.end(), [i](const DotMatch& m) { return static_cast<int>(m.point) == i; });
  };
  const int count = static_cast<int>(m_fixture->points.size());
  for (int step = 1; step <= count; ++step) {
    const int candidate = (m_point + step) % count;
    if (placed(candidate)) continue;
    m_point = candidate;
    return;
  }
  m_point = -1;
}

void FixtureController::click(const Eigen::Vector2d& pixel, double radius_px) {
  if (!m_fixture || m_picture.empty() || m_point < 0) return;
  const auto dot = calibration::dotAt(m_dots, pixel, radius_px);
  const Eigen::Vector2d at = dot ? m_dots[*dot].pixel : pixel;
  const auto index = static_cast<std::size_t>(m_point);
  m_matches.erase(std::remove_if(m_matches.begin(), m_matches.end(),
                                 [&](const DotMatch& m) { return m.point == index || (!m.by_hand && (m.pixel - at).norm() < 1e-9); }),
                  m_matches.end());
  m_matches.push_back({index, at, true});
  nextPoint();
  matchesChanged();
}

void FixtureController::removeMatch(std::size_t match) {
  if (match >= m_matches.size()) return;
  m_point = static_cast<int>(m_matches[match].point);
  m_matches.erase(m_matches.begin() + static_cast<std::ptrdiff_t>(match));
  matchesChanged();
}

void FixtureController::clearMatches() {
  m_matches.clear();
  if (m_fixture) m_point = 0;
  matchesChanged();
}

QString FixtureController::whyNotMatch() const {
  if (!m_fixture) return tr("open a fixture file first.");
  if (m_picture.empty()) return tr("open a picture, or take one.");
  if (m_dots.empty()) return tr("no dots were found in the picture: click every point by hand.");
  const auto by_hand = std::count_if(m_matches.begin(), m_matches.end(), [](const DotMatch& m) { return m.by_hand; });
  if (by_hand < static_cast<long>(kLeast)) return tr("click %1 points, not all in one plane, of which there are %2.").arg(kLeast).arg(by_hand);
  return {};
}

void FixtureController::matchRest() {
  if (const QString why = whyNotMatch(); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  std::vector<DotMatch> by_hand;
  std::copy_if(m_matches.begin(), m_matches.end(), std::back_inserter(by_hand), [](const DotMatch& m) { return m.by_hand; });
  m_jobs.run<std::vector<DotMatch>>(
      this,
      [fixture = *m_fixture, dots = m_dots, by_hand, size = m_picture.size()] {
        return calibration::matchFixture(fixture, dots, by_hand, size.width, size.height);
      },
      [this, generation = m_generation](Result<std::vector<DotMatch>> matches) {
        if (generation != m_generation) return;
        if (!matches) {
          Q_EMIT failed(QString::fromStdString(matches.error().message));
          return;
        }
        m_matches = std::move(*matches);
        matchesChanged();
      });
}

void FixtureController::setDistortion(std::optional<int> coefficients) {
  m_lens.distortion = coefficients;
  matchesChanged();
}

calibration::BoardView FixtureController::view() const {
  calibration::BoardView out{m_fixture->name, {}};
  for (const auto& match : m_matches) out.corners.push_back({m_fixture->points[match.point].xyz, match.pixel, 0});
  return out;
}

void FixtureController::matchesChanged() {
  ++m_generation;
  m_result.reset();
  m_stale = m_fixture.has_value() && m_matches.size() >= kLeast;
  if (!m_fixture) m_why = tr("Open a fixture file: where its points are (x,y,z in metres).");
  else if (m_picture.empty()) m_why = tr("Open a picture of the fixture, or take one.");
  else m_why = tr("%1 of at least 6 points are placed: choose a point, then click it in the picture.").arg(m_matches.size());
  solve();
  Q_EMIT changed();
}

void FixtureController::solve() {
  if (m_busy || !m_stale) return;
  m_stale = false;
  m_busy = true;
  m_jobs.run<FixtureResult>(
      this, [points = view(), lens = m_lens, size = m_picture.size()] { return calibration::calibrateFixture(points, size.width, size.height, lens); },
      [this, generation = m_generation](Result<FixtureResult> result) {
        m_busy = false;
        if (m_stale) return solve();
        if (generation == m_generation) {
          if (result) m_result = std::move(*result);
          m_why = result ? QString() : QString::fromStdString(result.error().message);
        }
        Q_EMIT changed();
      });
}

Eigen::Vector2d FixtureController::residual(std::size_t match) const {
  Eigen::Vector2d pixel = m_matches[match].pixel;
  (void)calibration::projectPoint(m_result->camera, m_result->X_WC.inverse() * m_fixture->points[m_matches[match].point].xyz, &pixel);
  return m_matches[match].pixel - pixel;
}

void FixtureController::save(const QString& camera_name, const QString& path) {
  if (!m_result) {
    Q_EMIT failed(m_why);
    return;
  }
  vision::CameraFile file{m_result->camera, PoseInParent{m_fixture->name, m_result->X_WC}, Eigen::MatrixXd(m_result->covariance)};
  file.camera.name = camera_name.toStdString();
  const Status written = vision::writeCameraFile(path.toStdString(), file);
  if (written) Q_EMIT saved(path);
  else Q_EMIT failed(QString::fromStdString(written.error().message));
}

CameraChange FixtureController::change(const std::string& camera) const {
  CameraChange change;
  change.camera = camera;
  change.kind = "fixture";
  if (!m_result) return change;
  change.lens = m_result->camera;
  change.lens_covariance = m_result->covariance.topLeftCorner<10, 10>();
  change.observations = static_cast<int>(m_matches.size());
  change.rms_px = m_result->rms_px;
  change.note = m_picture_name.toStdString();
  change.raw = "x,y,z,u,v\n";
  for (const auto& corner : view().corners) {
    change.raw += formatNumber(corner.xyz.x());
    for (const double number : {corner.xyz.y(), corner.xyz.z(), corner.pixel.x(), corner.pixel.y()}) change.raw += "," + formatNumber(number);
    change.raw += "\n";
  }
  change.raw_ending = "csv";
  return change;
}

}  // namespace longarm::session
