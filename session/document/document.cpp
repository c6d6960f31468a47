#include "session/document/document.h"

#include <algorithm>
#include <utility>

#include "core/require.h"
#include "core/text.h"
#include "vision/stereo/measure.h"
#include "vision/stereo/line.h"
#include "vision/stereo/pipe.h"

namespace longarm::session {

namespace {

std::string vertexWord(const SketchItem& item, int vertex) {
  const vision::FeatureKind kind = item.kind;
  if (item.pipe) return std::string(vertex < 2 ? "the first" : "the second") + " outline";
  if (kind == vision::FeatureKind::kPoint) return "it";
  if (kind == vision::FeatureKind::kLine) return "end " + std::to_string(vertex + 1);
  return "corner " + std::to_string(vertex + 1);
}

const char* kindTitle(vision::FeatureKind kind) {
  switch (kind) {
    case vision::FeatureKind::kPoint: return "Point";
    case vision::FeatureKind::kLine: return "Line";
    case vision::FeatureKind::kPlane: return "Plane";
    case vision::FeatureKind::kTriad: return "Triad";
  }
  return "Feature";
}

std::string offPicture(const SketchItem& item, int vertex, const vision::View& view, const Eigen::Vector2d& pixel) {
  return "'" + item.name + "' is not measured: " + vertexWord(item, vertex) + " is marked at (" +
         formatFixed(pixel.x(), 1) + ", " + formatFixed(pixel.y(), 1) + "), outside picture " + view.name + " (" +
         std::to_string(view.camera.width) + " x " + std::to_string(view.camera.height) +
         " px). Drag it onto the picture.";
}

std::string tooFewPictures(const SketchItem& item, int vertex, std::size_t count) {
  const std::string where = count == 0 ? "in no picture yet" : "in one picture only";
  return "'" + item.name + "' is not measured: " + vertexWord(item, vertex) + " is marked " + where +
         ". Mark it in two pictures.";
}

// Pictures without odometry are from one place.
bool sameBasePlace(const std::optional<BaseState>& a, const std::optional<BaseState>& b) {
  return a && b ? samePlace(*a, *b) : a.has_value() == b.has_value();
}

}  // namespace

bool operator==(const DocumentState& a, const DocumentState& b) {
  return a.snapshots == b.snapshots && a.panes == b.panes && a.items == b.items && a.world == b.world && a.pinned == b.pinned;
}

std::uint64_t hashOf(const DocumentState& state) {
  std::uint64_t hash = 1469598103934665603ULL;
  const auto mix = [&hash](std::uint64_t value) {
    hash ^= value;
    hash *= 1099511628211ULL;
    hash ^= hash >> 29;
  };
  for (const auto& snapshot : state.snapshots) mix(snapshot->id.value);
  for (const SnapshotId id : state.panes) mix(id.value + 0x51ULL);
  for (const auto& item : state.items) mix(hashOf(item));
  for (const auto& item : state.world) mix(hashOf(item));
  for (const SnapshotId id : state.pinned) mix(id.value + 0x77ULL);
  return hash;
}

Document::Document() = default;
Document::~Document() = default;

SnapshotPtr Document::snapshot(SnapshotId id) const {
  for (const auto& snapshot : m_state.snapshots) {
    if (snapshot->id == id) return snapshot;
  }
  return nullptr;
}

const SketchItem* Document::item(FeatureId id) const {
  const int index = indexOf(id);
  return index < 0 ? nullptr : &m_state.items[static_cast<std::size_t>(index)];
}

int Document::indexOf(FeatureId id) const {
  for (std::size_t i = 0; i < m_state.items.size(); ++i) {
    if (m_state.items[i].id == id) return static_cast<int>(i);
  }
  return -1;
}

const Measurement& Document::measurement(FeatureId id) const {
  const auto found = m_measurements.find(id);
  LONGARM_REQUIRE(found != m_measurements.end(), "no measurement of feature " + std::to_string(id.value));
  return found->second;
}

// Ends of an outline in different pictures are different places: only whole outlines go together.
Measurement Document::measurePipe(const SketchItem& item) const {
  std::vector<vision::PipeSighting> sightings;
  for (const auto& [id, list] : item.picks) {
    const SnapshotPtr picture = snapshot(id);
    if (!picture || !item.placedIn(id)) continue;
    for (int vertex = 0; vertex < 4; ++vertex) {
      const Eigen::Vector2d& pixel = item.pick(id, vertex)->pixel;
      if (!picture->view.camera.containsPixel(pixel, 0.5)) return {{}, offPicture(item, vertex, picture->view, pixel)};
    }
    sightings.push_back({&picture->view, item.pick(id, 0)->pixel, item.pick(id, 1)->pixel, item.pick(id, 2)->pixel,
                         item.pick(id, 3)->pixel});
  }
  if (sightings.size() < 2) {
    return {{}, "'" + item.name + "' is not measured: both outlines are marked in " +
                    (sightings.empty() ? "no picture yet" : "one picture only") + ". Mark both in two pictures."};
  }
  auto feature = vision::estimatePipe(item.name, sightings);
  if (!feature) return {{}, feature.error().message};
  return {std::move(*feature), {}};
}

Measurement Document::measureEdge(const SketchItem& item) const {
  vision::LinePicks picks;
  for (const auto& [id, list] : item.picks) {
    const SnapshotPtr picture = snapshot(id);
    if (!picture || !item.placedIn(id)) continue;
    for (int vertex = 0; vertex < 2; ++vertex) {
      const Eigen::Vector2d& pixel = item.pick(id, vertex)->pixel;
      if (!picture->view.camera.containsPixel(pixel, 0.5)) return {{}, offPicture(item, vertex, picture->view, pixel)};
    }
    picks.along.push_back({&picture->view, item.pick(id, 0)->pixel, item.pick(id, 1)->pixel});
  }
  if (picks.along.size() < 2) {
    return {{}, "'" + item.name + "' is not measured: it is marked in " + (picks.along.empty() ? "no picture yet" : "one picture only") +
                    ". Mark two places of the edge in two pictures; they need not be the same."};
  }
  auto feature = vision::estimateLine(item.name, picks);
  if (!feature) return {{}, feature.error().message};
  return {std::move(*feature), {}};
}

bool Document::elsewhere(const std::optional<BaseState>& place) const {
  return m_base && place && !samePlace(*m_base, *place);
}

bool Document::stale(SnapshotId id) const {
  const SnapshotPtr picture = snapshot(id);
  return picture && elsewhere(picture->base);
}

bool Document::stale(const WorldItem& item) const { return elsewhere(item.base); }

// Places of the base that the item's pictures were taken from: the present one first, then the latest.
std::vector<std::optional<BaseState>> Document::placesOf(const SketchItem& item) const {
  std::vector<std::optional<BaseState>> places;
  for (auto entry = item.picks.rbegin(); entry != item.picks.rend(); ++entry) {
    const SnapshotPtr picture = snapshot(entry->first);
    if (!picture) continue;
    const bool known = std::any_of(places.begin(), places.end(),
                                   [&](const auto& place) { return sameBasePlace(place, picture->base); });
    if (!known) places.push_back(picture->base);
  }
  std::stable_partition(places.begin(), places.end(),
                        [this](const auto& place) { return !elsewhere(place); });
  return places;
}

Measurement Document::measureFrom(const SketchItem& item, const std::optional<BaseState>& place) const {
  SketchItem part = item;
  for (auto entry = part.picks.begin(); entry != part.picks.end();) {
    const SnapshotPtr picture = snapshot(entry->first);
    entry = picture && sameBasePlace(place, picture->base) ? std::next(entry) : part.picks.erase(entry);
  }
  Measurement measured = measureAll(part);
  measured.stale = elsewhere(place);
  return measured;
}

std::optional<BaseState> Document::baseOf(FeatureId id) const {
  const SketchItem* found = item(id);
  LONGARM_REQUIRE(found != nullptr, "no item " + std::to_string(id.value));
  const auto places = placesOf(*found);
  for (const auto& place : places) {
    if (measureFrom(*found, place).feature) return place;
  }
  return places.empty() ? std::nullopt : places.front();
}

// Pictures from different places of the base do not go together: the base does not know how far it went well
// enough.
Measurement Document::measure(const SketchItem& item) const {
  const auto places = placesOf(item);
  if (places.size() < 2) {
    Measurement measured = measureAll(item);
    measured.stale = !places.empty() && elsewhere(places.front());
    return measured;
  }
  std::optional<Measurement> first;
  for (const auto& place : places) {
    Measurement measured = measureFrom(item, place);
    if (measured.feature) return measured;
    if (!first) first = std::move(measured);
  }
  return *std::move(first);
}

Measurement Document::measureAll(const SketchItem& item) const {
  if (item.pipe) return measurePipe(item);
  if (item.edge) return measureEdge(item);
  std::vector<std::vector<vision::Sighting>> vertices(static_cast<std::size_t>(vision::vertexCount(item.kind)));
  for (const auto& [id, list] : item.picks) {
    const SnapshotPtr picture = snapshot(id);
    if (!picture) continue;
    for (std::size_t vertex = 0; vertex < list.size() && vertex < vertices.size(); ++vertex) {
      if (!list[vertex] || !list[vertex]->placed()) continue;
      const Eigen::Vector2d& pixel = list[vertex]->pixel;
      // Half a pixel beyond the outer centres is still the picture.
      if (!picture->view.camera.containsPixel(pixel, 0.5)) {
        return {{}, offPicture(item, static_cast<int>(vertex), picture->view, pixel)};
      }
      vertices[vertex].push_back({&picture->view, pixel, list[vertex]->sigma_px});
    }
  }
  for (std::size_t vertex = 0; vertex < vertices.size(); ++vertex) {
    if (vertices[vertex].size() < 2) {
      return {{}, tooFewPictures(item, static_cast<int>(vertex), vertices[vertex].size())};
    }
  }
  auto feature = vision::measureFeature(item.name, item.kind, vertices);
  if (!feature) return {{}, feature.error().message};
  return {std::move(*feature), {}};
}

const vision::Feature* Document::selectedFeature() const {
  const auto found = m_measurements.find(m_selection.primary);
  return found != m_measurements.end() && found->second.feature ? &*found->second.feature : nullptr;
}

const WorldItem* Document::worldItem(WorldItemId id) const {
  const auto found = std::find_if(m_state.world.begin(), m_state.world.end(), [id](const WorldItem& item) { return item.id == id; });
  return found == m_state.world.end() ? nullptr : &*found;
}

std::uint64_t Document::nextGroup() const {
  std::uint64_t highest = 0;
  for (const auto& item : m_state.items) highest = std::max(highest, item.group);
  return highest + 1;
}

std::string Document::freeName(vision::FeatureKind kind, bool pipe) const {
  for (std::size_t number = 1;; ++number) {
    const std::string name = std::string(pipe ? "Pipe" : kindTitle(kind)) + " " + std::to_string(number);
    const bool taken = std::any_of(m_state.items.begin(), m_state.items.end(),
                                   [&](const SketchItem& item) { return item.name == name; });
    if (!taken) return name;
  }
}

int Document::observe(std::function<void(const Change&)> observer) {
  m_observers[m_next_observer] = std::move(observer);
  return m_next_observer++;
}

void Document::unobserve(int handle) { m_observers.erase(handle); }

void Document::notify(ChangeKind kind, std::uint64_t id) {
  const auto observers = m_observers;  // A copy: an observer may take itself off the list.
  for (const auto& [handle, observer] : observers) {
    if (m_observers.count(handle) != 0) observer({kind, id});
  }
}

void Document::remeasure(const SketchItem& item) { m_measurements[item.id] = measure(item); }

void Document::insertSnapshot(std::size_t index, SnapshotPtr snapshot) {
  LONGARM_REQUIRE(snapshot && snapshot->id.valid() && !this->snapshot(snapshot->id), "snapshot without a new id");
  const SnapshotId id = snapshot->id;
  index = std::min(index, m_state.snapshots.size());
  m_state.snapshots.insert(m_state.snapshots.begin() + static_cast<std::ptrdiff_t>(index), std::move(snapshot));
  m_next_snapshot = std::max(m_next_snapshot, id.value + 1);
  for (const auto& item : m_state.items) {
    if (item.picks.count(id) != 0) remeasure(item);
  }
  notify(ChangeKind::kSnapshotAdded, id.value);
}

void Document::removeSnapshot(SnapshotId id) {
  const auto found = std::find_if(m_state.snapshots.begin(), m_state.snapshots.end(),
                                  [id](const SnapshotPtr& s) { return s->id == id; });
  LONGARM_REQUIRE(found != m_state.snapshots.end(), "no snapshot " + std::to_string(id.value));
  m_state.snapshots.erase(found);
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    if (paneSnapshotId(side) == id) setPane(side, {});
  }
  for (const auto& item : m_state.items) {
    if (item.picks.count(id) != 0) remeasure(item);
  }
  notify(ChangeKind::kSnapshotRemoved, id.value);
}

void Document::replaceSnapshot(SnapshotPtr snapshot) {
  const auto found = std::find_if(m_state.snapshots.begin(), m_state.snapshots.end(),
                                  [&](const SnapshotPtr& s) { return s->id == snapshot->id; });
  LONGARM_REQUIRE(found != m_state.snapshots.end(), "no snapshot " + std::to_string(snapshot->id.value));
  *found = snapshot;
  tellItemsOf({snapshot->id});
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    if (paneSnapshotId(side) == snapshot->id)
      notify(ChangeKind::kPaneChanged, static_cast<std::uint64_t>(side));
  }
}

// Measures the items of these pictures anew.
void Document::tellItemsOf(const std::set<SnapshotId>& pictures) {
  std::vector<FeatureId> changed;
  for (const auto& item : m_state.items) {
    const bool shows = std::any_of(item.picks.begin(), item.picks.end(),
                                   [&](const auto& entry) { return pictures.count(entry.first) != 0; });
    if (!shows) continue;
    remeasure(item);
    changed.push_back(item.id);
  }
  for (const FeatureId id : changed) notify(ChangeKind::kItemChanged, id.value);
}

void Document::setBase(const std::optional<BaseState>& base) {
  std::set<SnapshotId> pictures;
  std::vector<WorldItemId> bodies;
  const auto before = std::exchange(m_base, base);
  const auto changed = [&](const std::optional<BaseState>& place) {
    const bool was = before && place && !samePlace(*before, *place);
    return was != elsewhere(place);
  };
  for (const auto& snapshot : m_state.snapshots) {
    if (changed(snapshot->base)) pictures.insert(snapshot->id);
  }
  for (const auto& item : m_state.world) {
    if (changed(item.base)) bodies.push_back(item.id);
  }
  if (!pictures.empty()) tellItemsOf(pictures);
  for (const WorldItemId id : bodies) notify(ChangeKind::kWorldChanged, id.value);
}

void Document::setPane(PaneSide side, SnapshotId id) {
  auto& pane = m_state.panes[static_cast<std::size_t>(side)];
  if (pane == id) return;
  pane = id;
  notify(ChangeKind::kPaneChanged, static_cast<std::uint64_t>(side));
}

void Document::insertItem(std::size_t index, SketchItem item) {
  LONGARM_REQUIRE(item.id.valid() && indexOf(item.id) < 0, "item without a new id");
  index = std::min(index, m_state.items.size());
  m_next_feature = std::max(m_next_feature, item.id.value + 1);
  const FeatureId id = item.id;
  remeasure(item);
  m_state.items.insert(m_state.items.begin() + static_cast<std::ptrdiff_t>(index), std::move(item));
  notify(ChangeKind::kItemAdded, id.value);
}

void Document::removeItem(FeatureId id) {
  const int index = indexOf(id);
  LONGARM_REQUIRE(index >= 0, "no item " + std::to_string(id.value));
  m_state.items.erase(m_state.items.begin() + index);
  m_measurements.erase(id);
  notify(ChangeKind::kItemRemoved, id.value);
  select(m_selection);
}

void Document::replaceItem(const SketchItem& item) {
  const int index = indexOf(item.id);
  LONGARM_REQUIRE(index >= 0, "no item " + std::to_string(item.id.value));
  const SketchItem copy = item;  // The argument may live in the list itself.
  m_state.items[static_cast<std::size_t>(index)] = copy;
  remeasure(copy);
  notify(ChangeKind::kItemChanged, copy.id.value);
}

void Document::insertWorldItem(std::size_t index, WorldItem item) {
  LONGARM_REQUIRE(item.id.valid() && worldItem(item.id) == nullptr, "world item without a new id");
  const WorldItemId id = item.id;
  index = std::min(index, m_state.world.size());
  m_next_world = std::max(m_next_world, id.value + 1);
  m_state.world.insert(m_state.world.begin() + static_cast<std::ptrdiff_t>(index), std::move(item));
  notify(ChangeKind::kWorldChanged, id.value);
}

void Document::removeWorldItem(WorldItemId id) {
  const WorldItem* item = worldItem(id);
  LONGARM_REQUIRE(item != nullptr, "no world item " + std::to_string(id.value));
  m_state.world.erase(m_state.world.begin() + (item - m_state.world.data()));
  notify(ChangeKind::kWorldChanged, id.value);
}

void Document::replaceWorldItem(const WorldItem& item) {
  const WorldItem* before = worldItem(item.id);
  LONGARM_REQUIRE(before != nullptr, "no world item " + std::to_string(item.id.value));
  const WorldItem copy = item;  // The argument may live in the list itself.
  m_state.world[static_cast<std::size_t>(before - m_state.world.data())] = copy;
  notify(ChangeKind::kWorldChanged, copy.id.value);
}

void Document::setPinned(SnapshotId id, bool pinned) {
  const bool changed = pinned ? m_state.pinned.insert(id).second : m_state.pinned.erase(id) > 0;
  if (changed) notify(ChangeKind::kPinsChanged, id.value);
}

void Document::reset(DocumentState state) {
  m_state = std::move(state);
  m_measurements.clear();
  m_selection = {};
  m_plan.reset();
  for (const auto& item : m_state.items) {
    remeasure(item);
    m_next_feature = std::max(m_next_feature, item.id.value + 1);
  }
  for (const auto& snapshot : m_state.snapshots) m_next_snapshot = std::max(m_next_snapshot, snapshot->id.value + 1);
  for (const auto& item : m_state.world) m_next_world = std::max(m_next_world, item.id.value + 1);
  notify(ChangeKind::kReset);
}

void Document::select(Selection selection) {
  for (auto it = selection.items.begin(); it != selection.items.end();) {
    it = indexOf(*it) < 0 ? selection.items.erase(it) : std::next(it);
  }
  if (!selection.contains(selection.primary)) {
    selection.primary = selection.items.empty() ? FeatureId{} : *selection.items.rbegin();
  }
  if (selection == m_selection) return;
  m_selection = std::move(selection);
  notify(ChangeKind::kSelectionChanged);
}

PlanId Document::setPlan(PlanRecord record) {
  record.id = {m_next_plan++};
  m_plan = std::move(record);
  notify(ChangeKind::kPlanChanged, m_plan->id.value);
  return m_plan->id;
}

void Document::clearPlan() {
  if (!m_plan) return;
  m_plan.reset();
  notify(ChangeKind::kPlanChanged);
}

void Document::setWorkcell(std::shared_ptr<const planning::Workcell> workcell) {
  m_workcell = std::move(workcell);
  notify(ChangeKind::kWorkcellChanged);
}

}  // namespace longarm::session
