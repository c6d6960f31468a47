#pragma once

/// @file
/// Strong ids: a SnapshotId cannot be passed where a FeatureId is wanted.

#include <cstdint>
#include <functional>

namespace longarm {

/// A number that names one thing of kind Tag.  0 names nothing.
template <typename Tag>
struct Id {
  std::uint64_t value = 0;
  bool valid() const { return value != 0; }
  friend bool operator==(Id a, Id b) { return a.value == b.value; }
  friend bool operator!=(Id a, Id b) { return a.value != b.value; }
  friend bool operator<(Id a, Id b) { return a.value < b.value; }
};

using SnapshotId = Id<struct SnapshotTag>;
using FeatureId = Id<struct FeatureTag>;
using PlanId = Id<struct PlanTag>;

}  // namespace longarm

namespace std {
template <typename Tag>
struct hash<longarm::Id<Tag>> {
  size_t operator()(longarm::Id<Tag> id) const { return hash<uint64_t>()(id.value); }
};
}  // namespace std
