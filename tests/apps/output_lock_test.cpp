#include "apps/output_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "apps/io/input_file.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw {
namespace {

TEST(OutputLock, TheSameOutputIsRefusedUntilTheFirstIsDone) {
  const io::TemporaryDirectory directory;
  std::optional<OutputLock> first(directory / "run.h5");
  EXPECT_THROW(OutputLock(directory / "run.h5"), io::FileError);
  EXPECT_NO_THROW(OutputLock(directory / "other.h5"));
  first.reset();
  EXPECT_NO_THROW(OutputLock(directory / "run.h5"));
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(OutputLock, AKilledProgramDoesNotHoldItsOutput) {
  const io::TemporaryDirectory directory;
  const pid_t child = ::fork();
  if (child == 0) {
    const OutputLock lock(directory / "run.h5");
    directory.write("held", "");
    while (true) ::pause();
  }
  while (!std::filesystem::exists(directory / "held")) ::usleep(1000);
  EXPECT_THROW(OutputLock(directory / "run.h5"), io::FileError);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(std::filesystem::exists(directory / "run.h5.lock"));
  EXPECT_NO_THROW(OutputLock(directory / "run.h5"));
}

}  // namespace
}  // namespace grainlaw
