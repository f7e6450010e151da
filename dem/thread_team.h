#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace grainlaw::dem {

/// Threads that wait for work between the phases of a step. A phase takes microseconds, so they
/// watch for the next one for a while before they sleep.
class ThreadTeam {
 public:
  /// `threads` includes the one that calls run().
  explicit ThreadTeam(int threads);
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;
  ~ThreadTeam();

  /// Calls task(k) for k = 0 to count - 1, each once, in stretches of neighbouring k, one stretch a
  /// thread; returns when all are done. The first exception of a task is thrown again here.
  template <class Task>
  void run(std::size_t count, const Task& task) {
    run(count, &task, [](const void* of, std::size_t k) { (*static_cast<const Task*>(of))(k); });
  }

 private:
  using Call = void (*)(const void* task, std::size_t k);
  void run(std::size_t count, const void* task, Call call);
  void serve(std::size_t member);
  void work(std::size_t member);

  std::vector<std::jthread> threads_;
  const void* task_ = nullptr;
  Call call_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<long> phase_{0};
  std::atomic<std::size_t> busy_{0};
  std::atomic<bool> stop_{false};
  std::vector<std::exception_ptr> errors_;
};

}  // namespace grainlaw::dem
