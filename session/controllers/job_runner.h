#pragma once

/// @file
/// JobRunner: long work off the GUI thread, its result delivered on the thread of a context object.

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <QObject>
#include <QPointer>

#include "core/result.h"

namespace longarm::session {

/// A small pool.  Owned by the GUI thread; the destructor waits for the work that has begun and drops the rest, so
/// cancel long jobs first.
class JobRunner final {
 public:
  explicit JobRunner(int threads = 2);
  ~JobRunner();
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Runs `work` in the pool and then `done` on the thread of `context`, through its event loop.  If `context` is
  /// gone by then, `done` is not called.  An exception in `work` becomes kInternal.  Call on the GUI thread.
  template <typename T>
  void run(QObject* context, std::function<Result<T>()> work, std::function<void(Result<T>)> done) {
    auto result = std::make_shared<std::optional<Result<T>>>();
    start(context, [result, work = std::move(work)] { result->emplace(guarded<T>(work)); },
          [result, done = std::move(done)] { done(std::move(**result)); });
  }

  /// Waits until nothing is under way.  Results still need an event loop to arrive.
  void wait();

 private:
  template <typename T>
  static Result<T> guarded(const std::function<Result<T>()>& work) {
    try {
      return work();
    } catch (const std::exception& problem) {
      return {ErrorCode::kInternal, std::string("A job failed: ") + problem.what()};
    } catch (...) {
      return {ErrorCode::kInternal, "A job failed for an unknown reason."};
    }
  }
  void start(QObject* context, std::function<void()> work, std::function<void()> deliver);

  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::session
