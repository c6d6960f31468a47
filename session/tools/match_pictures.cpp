#include "session/tools/match_pictures.h"

#include <utility>

namespace longarm::session {

std::shared_ptr<const vision::MatchPicture> MatchPictures::of(const vision::SnapshotPtr& snapshot) {
  if (!snapshot) return nullptr;
  const std::lock_guard<std::mutex> lock(m_mutex);
  for (auto entry = m_entries.begin(); entry != m_entries.end(); ++entry) {
    if (entry->snapshot.lock() != snapshot) continue;
    m_entries.splice(m_entries.begin(), m_entries, entry);
    return m_entries.front().picture;
  }
  auto made = vision::MatchPicture::from(snapshot->image);
  if (!made) return nullptr;
  m_entries.push_front({snapshot, std::make_shared<const vision::MatchPicture>(std::move(*made))});
  if (m_entries.size() > m_kept) m_entries.pop_back();
  return m_entries.front().picture;
}

}  // namespace longarm::session
