// The time-dependent side of random_cases_test.cpp in full: two minutes.
#include <gtest/gtest.h>

#include "tests/verification/random_chutes.h"

namespace grainlaw::continuum {
namespace {

TEST(RandomStarts, AThousandLegalStartsEndWithAnAnswerOrATypedReason) {
  expect_typed_in_time(1000, 1000);
}

}  // namespace
}  // namespace grainlaw::continuum
