#include "session/document/sketch_item.h"

#include <cstring>
#include <functional>

#include "core/require.h"

namespace longarm::session {

namespace {

std::uint64_t bitsOf(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

void mix(std::uint64_t& hash, std::uint64_t value) {
  hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 12) + (hash >> 4);
  hash *= 0xff51afd7ed558ccdULL;
  hash ^= hash >> 33;
}

}  // namespace

bool operator==(const SketchPick& a, const SketchPick& b) {
  return a.state == b.state && bitsOf(a.pixel.x()) == bitsOf(b.pixel.x()) &&
         bitsOf(a.pixel.y()) == bitsOf(b.pixel.y()) && bitsOf(a.sigma_px) == bitsOf(b.sigma_px);
}

bool operator==(const SketchItem& a, const SketchItem& b) {
  return a.id == b.id && a.kind == b.kind && a.name == b.name && a.colour == b.colour && a.hidden == b.hidden &&
         a.locked == b.locked && a.pipe == b.pipe && a.edge == b.edge && a.group == b.group && a.note == b.note && a.picks == b.picks;
}

const SketchPick* SketchItem::pick(SnapshotId snapshot, int vertex) const {
  const auto found = picks.find(snapshot);
  if (found == picks.end() || vertex < 0 || vertex >= static_cast<int>(found->second.size())) return nullptr;
  const auto& pick = found->second[static_cast<std::size_t>(vertex)];
  return pick ? &*pick : nullptr;
}

void SketchItem::setPick(SnapshotId snapshot, int vertex, const SketchPick& pick) {
  const int count = vertices();
  LONGARM_REQUIRE(vertex >= 0 && vertex < count, "vertex " + std::to_string(vertex) + " of a " + toString(kind));
  auto& list = picks[snapshot];
  list.resize(static_cast<std::size_t>(count));
  list[static_cast<std::size_t>(vertex)] = pick;
}

bool SketchItem::placedIn(SnapshotId snapshot) const {
  for (int vertex = 0; vertex < vertices(); ++vertex) {
    const SketchPick* found = pick(snapshot, vertex);
    if (found == nullptr || !found->placed()) return false;
  }
  return true;
}

int SketchItem::placedCount(int vertex) const {
  int count = 0;
  for (const auto& [snapshot, list] : picks) {
    const SketchPick* found = pick(snapshot, vertex);
    if (found != nullptr && found->placed()) ++count;
  }
  return count;
}

bool SketchItem::markedTwice() const {
  for (int vertex = 0; vertex < vertices(); ++vertex) {
    if (placedCount(vertex) < 2) return false;
  }
  return true;
}

std::vector<std::pair<int, int>> edgesOf(const SketchItem& item) {
  if (item.pipe) return {{0, 1}, {2, 3}};
  switch (item.kind) {
    case vision::FeatureKind::kPoint: return {};
    case vision::FeatureKind::kLine: return {{0, 1}};
    case vision::FeatureKind::kPlane: return {{0, 1}, {1, 2}};
    case vision::FeatureKind::kTriad: return {{0, 1}, {0, 2}, {0, 3}};
  }
  return {};
}

const char* wordFor(const SketchItem& item) { return item.pipe ? "pipe" : vision::toString(item.kind); }

std::uint64_t hashOf(const SketchItem& item) {
  std::uint64_t hash = item.id.value;
  mix(hash, static_cast<std::uint64_t>(item.kind));
  mix(hash, std::hash<std::string>()(item.name));
  mix(hash, item.colour ? *item.colour + 1ULL : 0);
  mix(hash, (item.hidden ? 1U : 0U) | (item.locked ? 2U : 0U) | (item.pipe ? 4U : 0U) | (item.edge ? 8U : 0U));
  mix(hash, item.group);
  mix(hash, std::hash<std::string>()(item.note));
  for (const auto& [snapshot, list] : item.picks) {
    mix(hash, snapshot.value);
    for (const auto& pick : list) {
      mix(hash, pick ? static_cast<std::uint64_t>(pick->state) + 1 : 0);
      if (!pick) continue;
      mix(hash, bitsOf(pick->pixel.x()));
      mix(hash, bitsOf(pick->pixel.y()));
      mix(hash, bitsOf(pick->sigma_px));
    }
  }
  return hash;
}

}  // namespace longarm::session
