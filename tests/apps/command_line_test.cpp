#include "apps/command_line.h"

#include <gtest/gtest.h>

namespace grainlaw {
namespace {

TEST(CommandLine, DurationsAreSecondsMinutesOrHours) {
  EXPECT_EQ(duration_seconds("90s"), 90.0);
  EXPECT_EQ(duration_seconds("10min"), 600.0);
  EXPECT_EQ(duration_seconds("2h"), 7200.0);
  EXPECT_EQ(duration_seconds("45"), 45.0);
  EXPECT_EQ(duration_seconds("0.5h"), 1800.0);
}

TEST(CommandLine, WhatIsNoDurationAboveZeroIsRefused) {
  for (const char* text : {"", "s", "0", "-3s", "2 h", "2m", "1h30", "inf", "nan", "soon"}) {
    EXPECT_FALSE(duration_seconds(text)) << text;
  }
}

}  // namespace
}  // namespace grainlaw
