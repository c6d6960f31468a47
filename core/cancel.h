#pragma once

/// @file
/// Cancellation of long jobs: the owner keeps the token, the job polls it.

#include <atomic>
#include <memory>

namespace longarm {

/// Shared flag; copies refer to the same job.  Thread-safe.
class CancelToken {
 public:
  void cancel() const { m_flag->store(true); }
  bool cancelled() const { return m_flag->load(); }

 private:
  std::shared_ptr<std::atomic<bool>> m_flag = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace longarm
