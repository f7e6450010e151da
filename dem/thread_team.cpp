#include "dem/thread_team.h"

#include <exception>
#include <utility>

namespace grainlaw::dem {
namespace {

constexpr int looks_before_sleep = 20'000;  // about 100 microseconds

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

ThreadTeam::ThreadTeam(int threads) : errors_(static_cast<std::size_t>(threads)) {
  for (std::size_t member = 1; member < errors_.size(); ++member) {
    threads_.emplace_back([this, member] { serve(member); });
  }
}

ThreadTeam::~ThreadTeam() {
  stop_ = true;
  ++phase_;
  phase_.notify_all();
}

void ThreadTeam::run(std::size_t count, const void* task, Call call) {
  if (threads_.empty()) {
    for (std::size_t k = 0; k < count; ++k) call(task, k);
    return;
  }
  task_ = task;
  call_ = call;
  count_ = count;
  busy_ = threads_.size();
  ++phase_;
  phase_.notify_all();
  work(0);
  for (int k = 0; busy_ > 0; ++k) {
    // Where another program holds the core of a member, let it have this one's.
    if (k < looks_before_sleep)
      pause();
    else
      std::this_thread::yield();
  }
  for (std::exception_ptr& error : errors_) {
    if (error) std::rethrow_exception(std::exchange(error, nullptr));
  }
}

void ThreadTeam::serve(std::size_t member) {
  long seen = 0;
  while (true) {
    for (int k = 0; k < looks_before_sleep && phase_ == seen; ++k) pause();
    phase_.wait(seen);
    ++seen;
    if (stop_) return;
    work(member);
    --busy_;
  }
}

void ThreadTeam::work(std::size_t member) {
  try {
    const std::size_t begin = count_ * member / errors_.size();
    const std::size_t end = count_ * (member + 1) / errors_.size();
    for (std::size_t k = begin; k < end; ++k) call_(task_, k);
  } catch (...) {
    errors_[member] = std::current_exception();
  }
}

}  // namespace grainlaw::dem
