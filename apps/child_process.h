#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw {

/// A function that runs in a process of its own: whatever ends it, crash or kill, leaves its parent
/// and its siblings alone. When the parent ends, however it ends, the child gets SIGTERM.
class ChildProcess {
 public:
  /// Sends a message to the parent; a parent that is gone is no error.
  using Send = std::function<void(std::string_view)>;
  using Work = std::function<int(const Send&)>;  ///< returns the exit code of the child

  /// Forks, so the parent has to have one thread only. Throws io::FileError.
  explicit ChildProcess(const Work& work);
  ~ChildProcess();  ///< asks a child that still runs to stop, and waits for it
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  int descriptor() const { return pipe_; }  ///< readable, for poll: a message came or it ended
  /// Whole messages that have come since; waits where there is nothing to read.
  std::vector<std::string> receive();
  bool ended() const { return ended_; }  ///< seen by receive: no more messages will come
  void ask_to_stop() const;              ///< SIGTERM

  struct Ending {
    int code = -1;   ///< exit code
    int signal = 0;  ///< that killed it; 0: none
    double cpu_seconds = 0.0;
  };
  Ending wait();

 private:
  pid_t id_ = -1;  ///< -1: waited for
  int pipe_ = -1;
  bool ended_ = false;
  std::string received_;  ///< bytes of messages that are not whole yet
};

}  // namespace grainlaw
