#include "session/calibration/camera_library.h"

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "core/text.h"

namespace longarm::session {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kRecordFile = "record.json";
constexpr const char* kInUseFile = "in_use.json";

std::string keyOf(const std::string& workcell, const std::string& name, Subject subject) {
  return workcell + "/" + (subject == Subject::kCamera ? name : std::string(toString(subject)) + ":" + name);
}

// Names come from files: nothing of them may lead out of the folder.
std::string safe(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    out += plain ? c : '_';
  }
  return out.substr(0, 60);
}

json jsonOf(const CalibrationRecord& record) {
  return {{"workcell", record.workcell}, {"subject", toString(record.subject)}, {"name", record.name}, {"kind", record.kind}, {"wall_time", record.wall_time_s},
          {"observations", record.observations}, {"rms_px", record.rms_px}, {"uncertainty_px", record.uncertainty_px},
          {"note", record.note}, {"file", fs::path(record.file).filename().string()}, {"raw", fs::path(record.raw).filename().string()}};
}

std::optional<CalibrationRecord> recordFrom(const fs::path& folder) {
  const auto text = readTextFile((folder / kRecordFile).string(), 1u << 20);
  if (!text) return std::nullopt;
  const json value = json::parse(*text, nullptr, false);
  try {
    CalibrationRecord out;
    out.id = folder.filename().string();
    out.workcell = value.at("workcell");
    const std::string subject = value.value("subject", toString(Subject::kCamera));   // the first records were cameras' alone
    for (const Subject each : {Subject::kPanTilt, Subject::kObject}) {
      if (subject == toString(each)) out.subject = each;
    }
    out.name = value.contains("name") ? value.at("name") : value.at("camera");
    out.kind = value.at("kind");
    out.wall_time_s = value.at("wall_time");
    out.observations = value.at("observations");
    out.rms_px = value.at("rms_px");
    out.uncertainty_px = value.at("uncertainty_px");
    out.note = value.at("note");
    out.file = (folder / fs::path(value.at("file").get<std::string>()).filename()).string();
    const std::string raw = value.at("raw");
    if (!raw.empty()) out.raw = (folder / fs::path(raw).filename()).string();
    return fs::is_regular_file(out.file) ? std::optional<CalibrationRecord>(out) : std::nullopt;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

bool older(const CalibrationRecord& a, const CalibrationRecord& b) {
  return a.wall_time_s != b.wall_time_s ? a.wall_time_s < b.wall_time_s : a.id < b.id;
}

}  // namespace

const char* toString(Subject subject) {
  switch (subject) {
    case Subject::kCamera: return "camera";
    case Subject::kPanTilt: return "pan_tilt";
    case Subject::kObject: return "object";
  }
  return "";
}

CameraLibrary::CameraLibrary(std::string folder) : m_folder(std::move(folder)) { read(); }

void CameraLibrary::read() {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(m_folder, error)) {
    if (!entry.is_directory(error)) continue;
    if (auto record = recordFrom(entry.path())) m_records.push_back(std::move(*record));
    else m_warnings.push_back("The calibration in " + entry.path().string() + " cannot be read and is left out.");
  }
  std::sort(m_records.begin(), m_records.end(), older);
  const auto text = readTextFile((fs::path(m_folder) / kInUseFile).string(), 1u << 20);
  if (!text) return;
  const json value = json::parse(*text, nullptr, false);
  if (!value.is_object()) {
    m_warnings.push_back(m_folder + "/" + kInUseFile + " is damaged: the cameras' own files are used.");
    return;
  }
  for (const auto& [key, id] : value.items()) {
    if (id.is_string() && find(id.get<std::string>())) m_in_use.emplace_back(key, id.get<std::string>());
    else m_warnings.push_back("The calibration in use for " + key + " is gone: its own file is used.");
  }
}

std::vector<CalibrationRecord> CameraLibrary::records(const std::string& workcell, const std::string& name, Subject subject) const {
  std::vector<CalibrationRecord> out;
  for (auto it = m_records.rbegin(); it != m_records.rend(); ++it) {
    if (it->workcell == workcell && it->subject == subject && it->name == name) out.push_back(*it);
  }
  return out;
}

std::optional<CalibrationRecord> CameraLibrary::find(const std::string& id) const {
  for (const auto& record : m_records) {
    if (record.id == id) return record;
  }
  return std::nullopt;
}

Result<std::string> CameraLibrary::newFolder(CalibrationRecord* record) const {
  const std::string stem = std::to_string(static_cast<long long>(record->wall_time_s)) + "-" + safe(record->name) + "-" + safe(record->kind);
  record->id = stem;
  for (int n = 2; find(record->id) || fs::exists(fs::path(m_folder) / record->id); ++n) record->id = stem + "-" + std::to_string(n);
  const fs::path folder = fs::path(m_folder) / record->id;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{ErrorCode::kInvalidInput, folder.string() + ": the folder cannot be made: " + error.message()};
  return folder.string();
}

Result<CalibrationRecord> CameraLibrary::add(CalibrationRecord record, const vision::CameraFile& file, const std::string& raw,
                                             const std::string& raw_ending) {
  const auto folder = newFolder(&record);
  if (!folder) return folder.error();
  record.file = *folder + "/camera.yaml";
  if (const Status written = vision::writeCameraFile(record.file, file); !written) return written.error();
  return keep(std::move(record), raw, raw_ending);
}

Result<CalibrationRecord> CameraLibrary::add(CalibrationRecord record, const vision::ZoomFile& file, const std::string& raw,
                                             const std::string& raw_ending) {
  const auto folder = newFolder(&record);
  if (!folder) return folder.error();
  record.file = *folder + "/camera.xml";
  if (const Status written = vision::writeZoomFile(record.file, file); !written) return written.error();
  return keep(std::move(record), raw, raw_ending);
}

Result<CalibrationRecord> CameraLibrary::add(CalibrationRecord record, const Placement& placement, const std::string& raw,
                                             const std::string& raw_ending) {
  const auto folder = newFolder(&record);
  if (!folder) return folder.error();
  record.file = *folder + "/placement.json";
  if (const Status written = writePlacement(record.file, placement); !written) return written.error();
  return keep(std::move(record), raw, raw_ending);
}

Result<CalibrationRecord> CameraLibrary::keep(CalibrationRecord record, const std::string& raw, const std::string& raw_ending) {
  const fs::path folder = fs::path(record.file).parent_path();
  if (!raw.empty()) {
    record.raw = (folder / ("raw." + safe(raw_ending))).string();
    if (const Status written = writeFileAtomically(record.raw, raw); !written) return written.error();
  }
  // Last: a folder without it counts for nothing.
  if (const Status written = writeFileAtomically((folder / kRecordFile).string(), jsonOf(record).dump(2) + "\n"); !written) return written.error();
  m_records.push_back(record);
  std::sort(m_records.begin(), m_records.end(), older);
  return record;
}

std::string CameraLibrary::inUse(const std::string& workcell, const std::string& name, Subject subject) const {
  for (const auto& [key, id] : m_in_use) {
    if (key == keyOf(workcell, name, subject)) return id;
  }
  return {};
}

Status CameraLibrary::setInUse(const std::string& workcell, const std::string& name, const std::string& id, Subject subject) {
  if (!id.empty() && !find(id)) return {ErrorCode::kNotFound, "There is no calibration \"" + id + "\" in " + m_folder + "."};
  auto in_use = m_in_use;
  const std::string key = keyOf(workcell, name, subject);
  in_use.erase(std::remove_if(in_use.begin(), in_use.end(), [&](const auto& entry) { return entry.first == key; }), in_use.end());
  if (!id.empty()) in_use.emplace_back(key, id);
  json value = json::object();
  for (const auto& [label, chosen] : in_use) value[label] = chosen;
  std::error_code error;
  fs::create_directories(m_folder, error);
  if (const Status written = writeFileAtomically((fs::path(m_folder) / kInUseFile).string(), value.dump(2) + "\n"); !written) return written;
  m_in_use = std::move(in_use);
  return {};
}

}  // namespace longarm::session
