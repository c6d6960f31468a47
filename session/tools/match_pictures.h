#pragma once

/// @file
/// MatchPictures: snapshots as pictures in floats, made once, for snapping and matching.

#include <atomic>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>

#include "vision/match/match_picture.h"
#include "vision/snapshot/view.h"

namespace longarm::session {

/// Keeps the few that were asked for last (a picture of 640 x 480 takes 1.2 MB).  Thread-safe.
class MatchPictures {
 public:
  explicit MatchPictures(std::size_t kept = 6) : m_kept(kept) {}

  /// Null for a null snapshot or one whose picture cannot be matched.
  std::shared_ptr<const vision::MatchPicture> of(const vision::SnapshotPtr& snapshot);
  /// Whether handles snap to what is in them by themselves and Shift is held for none; else Shift is held to snap.
  void setSnapping(bool on) { m_snapping = on; }
  bool snapping() const { return m_snapping; }

 private:
  struct Entry {
    std::weak_ptr<const vision::Snapshot> snapshot;
    std::shared_ptr<const vision::MatchPicture> picture;
  };
  std::size_t m_kept;
  std::atomic<bool> m_snapping{false};
  std::mutex m_mutex;
  std::list<Entry> m_entries;              // Asked for last comes first.
};

}  // namespace longarm::session
