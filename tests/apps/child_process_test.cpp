// Processes that end in every way there is.
#include "apps/child_process.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <ctime>

namespace grainlaw {
namespace {

/// All messages until the child ends.
std::vector<std::string> all_messages(ChildProcess& child) {
  std::vector<std::string> all;
  while (!child.ended()) {
    for (std::string& message : child.receive()) all.push_back(std::move(message));
  }
  return all;
}

TEST(ChildProcess, MessagesComeWholeAndInOrderBeforeTheExitCode) {
  const std::string large(100000, 'x');  // more than a pipe holds
  ChildProcess child([&](const ChildProcess::Send& send) {
    send("");
    send("two words\nand a line");
    send(large);
    return 7;
  });
  EXPECT_EQ(all_messages(child), (std::vector<std::string>{"", "two words\nand a line", large}));
  const auto ending = child.wait();
  EXPECT_EQ(ending.code, 7);
  EXPECT_EQ(ending.signal, 0);
}

TEST(ChildProcess, ACrashTakesOnlyTheChildDown) {
  ChildProcess crashing([](const ChildProcess::Send& send) -> int {
    send("before");
    ::raise(SIGKILL);
    return 0;
  });
  ChildProcess sibling([](const ChildProcess::Send&) { return 0; });
  EXPECT_EQ(all_messages(crashing), std::vector<std::string>{"before"});
  EXPECT_EQ(crashing.wait().signal, SIGKILL);
  EXPECT_TRUE(all_messages(sibling).empty());
  EXPECT_EQ(sibling.wait().code, 0);
}

TEST(ChildProcess, AChildThatIsNotWaitedForIsAskedToStop) {
  const auto begin = ::time(nullptr);
  {
    ChildProcess child([](const ChildProcess::Send&) {
      ::sleep(600);  // ends at SIGTERM, which it does not catch
      return 0;
    });
  }
  EXPECT_LT(::time(nullptr) - begin, 300);
}

TEST(ChildProcess, AKilledParentLeavesNoChildBehind) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t parent = ::fork();
  if (parent == 0) {
    ::close(ends[0]);
    ChildProcess child([](const ChildProcess::Send&) {
      ::sleep(600);
      return 0;
    });
    if (::write(ends[1], "+", 1) != 1) ::_exit(1);
    ::sleep(600);
    ::_exit(0);
  }
  ::close(ends[1]);
  char byte = 0;
  ASSERT_EQ(::read(ends[0], &byte, 1), 1);
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  // The child holds the other end of the pipe: it reads as ended once the child has.
  pollfd pipe{ends[0], POLLIN, 0};
  EXPECT_EQ(::poll(&pipe, 1, 300000), 1);
  EXPECT_EQ(::read(ends[0], &byte, 1), 0);
  ::close(ends[0]);
}

}  // namespace
}  // namespace grainlaw
