#include "session/controllers/calibrated_camera.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <tuple>

namespace longarm::session {
namespace {

namespace fs = std::filesystem;
using CalibrationPtr = std::shared_ptr<const vision::CameraCalibration>;

class CalibrationCache {
 public:
  Result<CalibrationPtr> read(const planning::CameraSpec& spec) {
    std::error_code error;
    const auto changed = fs::last_write_time(spec.calibration, error);
    const Key key{spec.calibration, spec.digital_zoom.from, spec.digital_zoom.factor, spec.width, spec.height};
    const std::lock_guard<std::mutex> lock(m_mutex);
    const auto found = m_files.find(key);
    if (!error && found != m_files.end() && found->second.changed == changed) return found->second.calibration;
    auto read = vision::CameraCalibration::read(spec.calibration, spec.digital_zoom, spec.width, spec.height);
    if (!read) return read.error();
    auto kept = std::make_shared<const vision::CameraCalibration>(std::move(*read));
    if (!error) m_files[key] = {changed, kept};
    return kept;
  }

 private:
  using Key = std::tuple<std::string, double, double, int, int>;
  struct Entry {
    fs::file_time_type changed;
    CalibrationPtr calibration;
  };
  std::mutex m_mutex;
  std::map<Key, Entry> m_files;
};

}  // namespace

Result<CalibrationPtr> calibrationOf(const planning::CameraSpec& camera) {
  static CalibrationCache cache;
  return cache.read(camera);
}

}  // namespace longarm::session
