#include "apps/checkpointed_run.h"

#include <gtest/gtest.h>

namespace grainlaw {
namespace {

dem::Progress flowing(double time, long steps, double wall_seconds) {
  return {.time = time, .expected_end = 100.0, .steps = steps, .wall_seconds = wall_seconds};
}

TEST(Pace, CountsFromTheStartOfTheFlowNotFromThePacking) {
  Pace pace(1000.0);
  dem::Progress settling;
  settling.steps = 5000;
  settling.wall_seconds = 8.0;
  settling.settling = true;
  pace.add(settling);
  EXPECT_EQ(pace.grain_steps_per_second(), 0.0);
  pace.add(flowing(25.0, 2000, 10.0));
  EXPECT_DOUBLE_EQ(pace.grain_steps_per_second(), 1000.0 * 2000.0 / 2.0);
  EXPECT_DOUBLE_EQ(pace.seconds_left(), 75.0 / 25.0 * 2.0);
}

TEST(Pace, CountsOnlyWhatWasDoneSinceARunWentOn) {
  Pace pace(1000.0);
  pace.add(flowing(50.0, 4000, 1.0));  // nearly all of it before the interruption
  EXPECT_EQ(pace.grain_steps_per_second(), 0.0);
  EXPECT_EQ(pace.seconds_left(), 0.0);
  pace.add(flowing(60.0, 4800, 3.0));
  EXPECT_DOUBLE_EQ(pace.grain_steps_per_second(), 1000.0 * 800.0 / 2.0);
  EXPECT_DOUBLE_EQ(pace.seconds_left(), 40.0 / 10.0 * 2.0);
}

}  // namespace
}  // namespace grainlaw
