// Legal cases drawn at random, seed fixed: each ends with an answer or a typed reason.
#include <gtest/gtest.h>

#include <map>

#include "continuum/well_posedness.h"
#include "tests/verification/random_chutes.h"

namespace grainlaw::continuum {
namespace {

/// An answer in words, a profile of finite numbers exactly where there is a flow.
void expect_typed(const SteadyChute& steady, int number) {
  EXPECT_FALSE(steady.answer.text.empty()) << "case " << number;
  EXPECT_EQ(flows(steady.answer.outcome), !steady.profile.rows.empty())
      << "case " << number << ": " << steady.answer.text;
  EXPECT_TRUE(in_physics(steady.profile, steady.answer))
      << "case " << number << ": " << steady.answer.text;
}

TEST(RandomCases, AThousandLegalCasesEndWithAnAnswerOrATypedReason) {
  Draw draw(1000);
  std::map<Outcome, int> outcomes;
  for (int number = 0; number < 1000; ++number) {
    const RheologyTable table = random_table(draw);
    const ChuteCase chute = random_chute(draw);
    ASSERT_NO_THROW({
      const SteadyChute steady = steady_chute(table, chute);
      expect_typed(steady, number);
      certify(table, steady.profile, chute.grains);
      ++outcomes[steady.answer.outcome];
    }) << "case "
       << number;
  }
  for (const Outcome outcome : {Outcome::steady,
                                Outcome::plug,
                                Outcome::arrested,
                                Outcome::no_steady,
                                Outcome::no_dense_state})
    EXPECT_GE(outcomes[outcome], 20) << name(outcome);  // the draw reaches every kind of answer
  for (const auto& [outcome, count] : outcomes) RecordProperty(std::string(name(outcome)), count);
}

TEST(RandomCases, LegalStartsEndWithAnAnswerOrATypedReason) {
  expect_typed_in_time(1000, 20);
}

}  // namespace
}  // namespace grainlaw::continuum
