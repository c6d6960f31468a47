#pragma once

/// @file
/// RenderThread: takes pictures beside everything else.

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "app/virtual_robot/picture_maker.h"
#include "app/virtual_robot/world_snapshot.h"

namespace longarm::virtual_robot {

/// Pictures exposed at one instant.
struct PictureRequest {
  WorldSnapshot world;
  std::vector<PictureOrder> orders;
};

/// Owns the PictureMaker on a thread of its own, started with the first request.  A request that waits is replaced
/// by a newer one.  Thread-safe.
class RenderThread {
 public:
  /// @param behind   whether the thread gives way to others, joint states first
  /// @param deliver  called on the render thread with each picture
  /// @param failed   called on the render thread with a sentence; at most once per cause
  RenderThread(planning::Workcell workcell, planning::Scenario scenario, bool behind,
               std::function<void(Picture)> deliver, std::function<void(std::string)> failed);
  ~RenderThread();

  void request(PictureRequest request);
  /// Whether nothing is being rendered or waits.
  bool idle() const;
  /// Waits until everything requested has been delivered.
  void finish();
  /// Wall time the last request took [s].
  double lastDuration_s() const;

 private:
  void run();
  void work(PictureMaker* maker, const PictureRequest& request);
  void complain(const std::string& what);

  const planning::Workcell m_workcell;
  const planning::Scenario m_scenario;
  const bool m_behind;
  const std::function<void(Picture)> m_deliver;
  const std::function<void(std::string)> m_failed;
  mutable std::mutex m_mutex;
  std::condition_variable m_changed;
  std::optional<PictureRequest> m_next;
  bool m_busy = false, m_end = false;
  double m_duration_s = 0;
  std::string m_complaint;
  std::thread m_thread;
};

}  // namespace longarm::virtual_robot
