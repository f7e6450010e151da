// The time-dependent side of random_cases_test.cpp in full: a quarter of a minute; each start ends
// within some 50 000 steps.
#include <gtest/gtest.h>

#include "tests/verification/random_chutes.h"

namespace grainlaw::continuum {
namespace {

TEST(RandomStarts, AThousandLegalStartsEndWithAnAnswerOrATypedReason) {
  expect_typed_in_time(1000, 1000);
}

}  // namespace
}  // namespace grainlaw::continuum
