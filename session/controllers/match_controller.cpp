#include "session/controllers/match_controller.h"

#include <algorithm>
#include <utility>

namespace longarm::session {

namespace {

constexpr std::size_t kRemembered = 32;

using Matches = std::vector<vision::Match>;

Result<Matches> suggestion(const SnapshotPtr& from, const Eigen::Vector2d& pixel, const SnapshotPtr& to, MatchPictures& pictures) {
  const auto from_picture = pictures.of(from), to_picture = pictures.of(to);
  if (!from_picture || !to_picture) return Error{ErrorCode::kInvalidInput, "A picture of this kind cannot be matched."};
  return vision::suggestMatches(from->view, *from_picture, pixel, to->view, *to_picture);
}

}  // namespace

MatchController::MatchController(TargetingController& targeting, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_targeting(targeting), m_jobs(jobs) {
  connect(&m_targeting, &TargetingController::overlayChanged, this, &MatchController::refresh);
  // Another sketch may use the same numbers for other pictures.
  connect(&m_targeting, &TargetingController::snapshotsChanged, this, [this] { m_known.clear(); });
}

bool MatchController::known(const MatchWish& wish) const {
  return std::any_of(m_known.begin(), m_known.end(), [&](const MatchHelp& help) { return help.wish == wish; });
}

void MatchController::refresh() {
  if (m_searching || m_refreshing) return;
  for (const auto& wish : m_targeting.matchWishes()) {
    if (known(wish)) continue;
    search(wish);
    return;
  }
}

void MatchController::search(const MatchWish& wish) {
  const SnapshotPtr from = m_targeting.document().snapshot(wish.from), to = m_targeting.document().snapshot(wish.to);
  if (!from || !to) return;
  m_searching = true;
  const auto pictures = m_targeting.pictures();
  m_jobs.run<Matches>(
      this, [from, to, pixel = wish.pixel, pictures] { return suggestion(from, pixel, to, *pictures); },
      [this, wish](Result<Matches> matches) { arrived(wish, std::move(matches)); });
}

void MatchController::arrived(const MatchWish& wish, Result<Matches> matches) {
  m_searching = false;
  if (m_known.size() >= kRemembered) m_known.erase(m_known.begin());
  // A pick that cannot be matched at all is known to have none: it is not asked again.
  m_known.push_back({wish, matches ? std::move(*matches) : Matches{}});
  m_refreshing = true;                     // Announcing asks for a refresh.
  m_targeting.setMatchHelp(m_known);
  m_refreshing = false;
  Q_EMIT found();
  refresh();
}

}  // namespace longarm::session
