#include "session/calibration/lens_controller.h"

#include <cmath>

#include "core/text.h"
#include "vision/snapshot/image_file.h"

namespace longarm::session {

using calibration::PlumbLine;
using calibration::PlumbLineResult;

LensController::LensController(CalibrationController& calibration, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_calibration(calibration), m_jobs(jobs) {}

void LensController::setCamera(const QString& camera) {
  m_name = camera.toStdString();
  const auto file = m_calibration.fileInUse(m_name);
  m_in_use = file ? file->camera : vision::CameraModel{};
  m_picture = cv::Mat();
  m_guides.clear();
  reset();
}

void LensController::setPicture(const cv::Mat& picture) {
  const bool other = picture.size() != m_picture.size();
  m_picture = picture;
  if (m_in_use.width > 0 && (picture.cols != m_in_use.width || picture.rows != m_in_use.height)) {
    Q_EMIT failed(tr("The picture is %1 x %2 pixels, camera %3 gives %4 x %5: choose the camera that took it.")
                      .arg(picture.cols).arg(picture.rows).arg(QString::fromStdString(m_name)).arg(m_in_use.width).arg(m_in_use.height));
    m_picture = cv::Mat();
  }
  if (other) m_guides.clear();
  touched();
}

void LensController::openFile(const QString& path) {
  m_jobs.run<cv::Mat>(
      this, [file = path.toStdString()] { return vision::loadImage(file); },
      [this](Result<cv::Mat> picture) {
        if (picture) setPicture(*picture);
        else Q_EMIT failed(QString::fromStdString(picture.error().message));
      });
}

void LensController::touched() {
  ++m_generation;
  m_result.reset();
  Q_EMIT changed();
}

void LensController::setCoefficient(int index, double value) {
  if (index < 0 || index >= 5) return;
  m_lens.distortion[static_cast<std::size_t>(index)] = value;
  touched();
}

void LensController::reset() {
  m_lens = m_in_use;
  touched();
}

void LensController::straightenNothing() {
  m_lens.distortion = {};
  touched();
}

void LensController::addPoint(const Eigen::Vector2d& pixel) {
  if (m_picture.empty()) return;
  if (!m_laying) m_guides.emplace_back();
  m_laying = true;
  m_guides.back().push_back(pixel);
  touched();
}

void LensController::endGuide() {
  m_laying = false;
  if (!m_guides.empty() && m_guides.back().size() < 2) m_guides.pop_back();
  touched();
}

void LensController::removeGuide() {
  m_laying = false;
  if (!m_guides.empty()) m_guides.pop_back();
  touched();
}

std::vector<PlumbLine> LensController::usable() const {
  std::vector<PlumbLine> out;
  for (const auto& guide : m_guides) {
    if (guide.size() >= 3) out.push_back(guide);
  }
  return out;
}

std::optional<double> LensController::straightness() const {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& guide : usable()) {
    const auto distances = calibration::straightness(m_lens, guide);
    if (distances.empty()) return std::nullopt;
    for (const double d : distances) sum += d * d;
    count += distances.size();
  }
  return count > 0 ? std::optional<double>(std::sqrt(sum / static_cast<double>(count))) : std::nullopt;
}

QString LensController::whyNotSolve() const {
  if (m_solving) return tr("It is being calculated.");
  if (m_picture.empty()) return tr("there is no picture.");
  if (usable().empty()) return tr("lay a guide of three points or more along an edge that is straight in the world.");
  return {};
}

void LensController::solve(int coefficients) {
  if (const QString why = whyNotSolve(); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  m_solving = true;
  vision::CameraModel start = m_lens;
  for (std::size_t i = static_cast<std::size_t>(coefficients); i < 5; ++i) start.distortion[i] = 0;
  m_jobs.run<PlumbLineResult>(
      this, [start, lines = usable(), coefficients] { return calibration::straightenLines(start, lines, coefficients); },
      [this, generation = m_generation](Result<PlumbLineResult> result) {
        m_solving = false;
        if (!result) Q_EMIT failed(QString::fromStdString(result.error().message));
        else if (generation == m_generation) {
          m_lens = result->camera;
          m_result = std::move(*result);
        }
        Q_EMIT changed();
      });
  Q_EMIT changed();
}

QString LensController::whyNotApply() const {
  if (m_solving) return tr("it is being calculated.");
  if (m_name.empty()) return tr("no camera is chosen.");
  const Status sound = vision::validate(m_lens);
  if (!sound) return QString::fromStdString(sound.error().message);
  return m_lens.distortion == m_in_use.distortion ? tr("it is the lens in use.") : QString();
}

CameraChange LensController::change() const {
  CameraChange change;
  change.camera = m_name;
  change.kind = "lens";
  change.lens = m_lens;
  // Focal lengths and principal point stay as sure as they were; coefficients set by hand have no figure.
  const auto file = m_calibration.fileInUse(m_name);
  if (file && file->covariance) change.lens_covariance.topLeftCorner<5, 5>() = file->covariance->topLeftCorner<5, 5>();
  if (m_result) {
    change.lens_covariance += m_result->covariance;
    change.rms_px = m_result->rms_px;
  } else {
    change.rms_px = straightness().value_or(0);
    change.note = "by hand";
  }
  change.raw = "line,u,v\n";
  for (std::size_t i = 0; i < m_guides.size(); ++i) {
    for (const auto& p : m_guides[i]) change.raw += std::to_string(i + 1) + "," + formatNumber(p.x()) + "," + formatNumber(p.y()) + "\n";
    change.observations += static_cast<int>(m_guides[i].size());
  }
  change.raw_ending = "csv";
  return change;
}

}  // namespace longarm::session
