#include "session/calibration/intrinsics_controller.h"

#include <utility>

#include "vision/camera/camera_file.h"

namespace longarm::session {

using calibration::BoardSpec;

namespace {

// @param hint Look for boards of another size when this one is not there.
Result<BoardPicture> search(const std::string& name, const cv::Mat& image, const BoardSpec& spec, bool hint) {
  auto out = searchedPicture(name, image, spec, false);
  if (!out || out->view) return out;
  if (const std::string other = hint ? calibration::otherBoardHint(out->image, spec) : std::string(); !other.empty()) {
    out->why += "; " + other;
  }
  return out;
}

}  // namespace

IntrinsicsController::IntrinsicsController(JobRunner& jobs, QObject* parent) : QObject(parent), m_jobs(jobs) {
  m_why = QString::fromStdString(m_boards.whyNotReady());
}

void IntrinsicsController::setBoard(const BoardSpec& board) {
  if (calibration::sameBoard(board, m_board)) return;
  m_board = board;
  m_capture.reset();
  m_live.reset();
  std::deque<Waiting> again;
  for (const auto& picture : m_boards.pictures()) again.push_back({picture.name, picture.image, picture.included, picture.zoom});
  for (auto& waiting : m_waiting) again.push_back(std::move(waiting));
  m_boards.clear();
  m_waiting = std::move(again);
  ++m_generation;
  m_searching = false;
  collectionChanged();
  searchNext();
}

void IntrinsicsController::setLens(const calibration::LensChoice& lens) {
  m_lens = lens;
  collectionChanged();
}

void IntrinsicsController::addFiles(const QStringList& paths) {
  for (const QString& path : paths) m_waiting.push_back({path.toStdString(), {}, true, {}});
  searchNext();
  Q_EMIT changed();
}

void IntrinsicsController::searchNext() {
  if (m_searching || m_waiting.empty()) return;
  m_searching = true;
  const Waiting next = std::move(m_waiting.front());
  m_waiting.pop_front();
  const bool hint = m_boards.pictures().empty();   // it takes seconds, so only once
  m_jobs.run<BoardPicture>(
      this, [next, spec = m_board, hint] { return search(next.name, next.image, spec, hint); },
      [this, included = next.included, zoom = next.zoom, generation = m_generation](Result<BoardPicture> picture) {
        if (generation != m_generation) return;
        m_searching = false;
        if (picture) {
          picture->included = included;
          picture->zoom = zoom;
        }
        take(std::move(picture));
        searchNext();
        Q_EMIT changed();
      });
}

void IntrinsicsController::take(Result<BoardPicture> picture) {
  if (!picture) {
    Q_EMIT failed(QString::fromStdString(picture.error().message));
    return;
  }
  const bool has_board = picture->view.has_value();
  if (has_board) m_capture.kept(*picture->view);
  if (const Status added = m_boards.add(std::move(*picture)); !added) {
    Q_EMIT failed(QString::fromStdString(added.error().message));
  } else if (has_board) {
    collectionChanged();
  }
}

void IntrinsicsController::offerLive(const cv::Mat& picture, double stamp_s, std::optional<double> zoom) {
  if (m_looking || picture.empty()) return;
  m_looking = true;
  m_jobs.run<Seen>(
      this,
      [picture, spec = m_board]() -> Result<Seen> {
        Seen out;
        auto board = calibration::detectBoardLive(picture, spec, "live");
        if (!board) return out;
        out.sharpness = boardSharpness(picture, *board);
        out.board = std::move(*board);
        return out;
      },
      [this, picture, stamp_s, zoom, generation = m_generation](Result<Seen> result) {
        m_looking = false;
        if (generation == m_generation) seen(picture, stamp_s, zoom, std::move(result));
      });
}

// Through another lens a place of the board is new again.
void IntrinsicsController::watchZoom(std::optional<double> zoom) {
  if (BoardCollection::sameZoom(m_capture_zoom, zoom)) return;
  m_capture_zoom = zoom;
  m_capture.reset();
  for (const auto& picture : m_boards.pictures()) {
    if (picture.view && BoardCollection::sameZoom(picture.zoom, zoom)) m_capture.kept(*picture.view);
  }
}

void IntrinsicsController::seen(const cv::Mat& picture, double stamp_s, std::optional<double> zoom, Result<Seen> result) {
  watchZoom(zoom);
  LiveBoard live;
  live.image = picture;
  live.zoom = zoom;
  if (result && result->board) {
    live.verdict = m_capture.offer(*result->board, result->sharpness, picture.cols, stamp_s);
    live.board = std::move(result->board);
  } else {
    live.verdict = m_capture.offerNothing();
  }
  m_live = std::move(live);
  if (m_auto && m_live->verdict == AutoCapture::Verdict::kKeep) capture();
  Q_EMIT liveChanged();
}

void IntrinsicsController::leaveLive() {
  ++m_generation;
  m_searching = false;
  m_live.reset();
  Q_EMIT liveChanged();
  searchNext();
}

QString IntrinsicsController::whyNotCapture() const {
  if (!m_live) return tr("There is no live picture.");
  if (!m_live->board) return tr("There is no board in the live picture.");
  return {};
}

void IntrinsicsController::capture() {
  if (const QString why = whyNotCapture(); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  BoardPicture picture;
  picture.name = "live " + std::to_string(++m_captured);
  picture.image = m_live->image;
  picture.view = m_live->board;
  picture.zoom = m_live->zoom;
  picture.view->name = picture.name;
  const QString name = QString::fromStdString(picture.name);
  const std::size_t before = m_boards.pictures().size();
  take(std::move(picture));
  if (m_boards.pictures().size() > before) Q_EMIT captured(name);
  Q_EMIT changed();
}

void IntrinsicsController::setIncluded(std::size_t picture, bool included) {
  if (picture >= m_boards.pictures().size() || m_boards.pictures()[picture].included == included) return;
  m_boards.setIncluded(picture, included);
  collectionChanged();
}

void IntrinsicsController::remove(std::size_t picture) {
  if (picture >= m_boards.pictures().size()) return;
  m_boards.remove(picture);
  m_outcome.reset();                               // its indices no longer hold
  collectionChanged();
}

void IntrinsicsController::clear() {
  m_boards.clear();
  m_waiting.clear();
  m_capture.reset();
  ++m_generation;
  m_searching = false;
  collectionChanged();
}

void IntrinsicsController::collectionChanged() {
  const std::string why = m_boards.whyNotReady();
  if (!why.empty()) {
    m_outcome.reset();
    m_why = QString::fromStdString(why);
  }
  m_stale = why.empty();
  solve();
  Q_EMIT changed();
}

void IntrinsicsController::solve() {
  if (m_solving || !m_stale) return;
  m_solving = true;
  m_stale = false;
  m_jobs.run<IntrinsicsOutcome>(
      this, [boards = m_boards, lens = m_lens] { return solveBoards(boards, lens); },
      [this](Result<IntrinsicsOutcome> outcome) { finishSolve(outcome); });
}

void IntrinsicsController::finishSolve(Result<IntrinsicsOutcome>& outcome) {
  m_solving = false;
  if (m_stale) return solve();
  if (!m_boards.whyNotReady().empty()) return;     // emptied meanwhile
  if (outcome) {
    m_outcome = std::move(*outcome);
    m_why.clear();
  } else {
    m_outcome.reset();
    m_why = QString::fromStdString(outcome.error().message);
  }
  Q_EMIT changed();
}

QString IntrinsicsController::whyNotSave() const {
  if (m_solving || m_stale) return tr("The camera is being calculated.");
  return m_outcome ? QString() : m_why;
}

void IntrinsicsController::save(const QString& camera_name, const QString& path) {
  if (const QString why = whyNotSave(); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  vision::CameraFile file{m_outcome->result.camera, {}, Eigen::MatrixXd(m_outcome->result.covariance)};
  file.camera.name = camera_name.toStdString();
  const Status written = vision::writeCameraFile(path.toStdString(), file);
  if (written) Q_EMIT saved(path);
  else Q_EMIT failed(QString::fromStdString(written.error().message));
}

}  // namespace longarm::session
