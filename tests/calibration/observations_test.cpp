#include "calibration/observations.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/calibration_checks.h"
#include "support/synthetic_chute.h"

namespace grainlaw::calibration {
namespace {

using testing::failure;
using testing::local_data;
using testing::mentions;

TEST(Observations, BaseAndSaltatingLayerAreLeftOutAndNamed) {
  dem::LocalData data = local_data({.height = 20});
  data.rows.back().volume_fraction.value = 0.2;
  const Observations observations = select_rows(data, {.above_base = 3.0});
  EXPECT_EQ(data.rows[observations.rows.front()].z, 3.5);
  EXPECT_EQ(data.rows[observations.rows.back()].z, 18.5);
  EXPECT_DOUBLE_EQ(observations.bulk_volume_fraction, 0.58);
  EXPECT_TRUE(mentions(observations.left_out, "4 rows at z = -0.5 to 2.5, too close"));
  EXPECT_TRUE(mentions(observations.left_out, "1 row at z = 19.5, too dilute"));
}

TEST(Observations, MassColumnFindsHeightAndMassOfEachOther) {
  const dem::LocalData data = local_data({.height = 20});
  const MassColumn column(data.rows, testing::grain_density);
  const double bulk = testing::grain_density * 0.58;
  EXPECT_NEAR(column.mass_above(0.0), 20.0 * bulk, 1e-12);  // the density jumps here
  EXPECT_NEAR(column.mass_above(1.3), 18.7 * bulk, 1e-12);
  for (const double z : {-1.0, -0.2, 0.0, 1.3, 7.0, 19.9}) {
    EXPECT_NEAR(column.height(column.mass_above(z)), z, 1e-12);
  }
  EXPECT_NEAR(column.mass_above(-1.0), data.conditions.mass_per_area, 1e-12);
}

TEST(Observations, JackknifeOfAMeanIsItsStandardErrorTimesStudentForFewBlocks) {
  const std::vector<double> values{1.0, 4.0, 2.0, 7.0};  // mean 3.5, sum of squares 21
  std::vector<double> without;
  for (const double value : values) without.push_back((14.0 - value) / 3.0);
  // Student's t with 3 degrees of freedom holds 68.27 % within 1.1969.
  EXPECT_NEAR(jackknife_error(without), 1.1969 * std::sqrt(21.0 / (4.0 * 3.0)), 1e-4);
}

TEST(Observations, MeansWithoutEachBlockAverageToTheWholeRun) {
  const dem::LocalData data = local_data({.velocity_noise = 0.1});
  const auto blocks = block_rows(data);
  ASSERT_EQ(60 % blocks.size(), 0u);  // blocks of equal length: else their weights differ
  double sum = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    sum += mean_without(blocks, b)[20].velocity.value;
  }
  EXPECT_NEAR(sum / static_cast<double>(blocks.size()), data.rows[20].velocity.value, 1e-12);
}

TEST(Observations, NoSingleLuckyRowRulesTheWeights) {
  const std::vector<double> errors =
      weight_errors({{10.0, 0.2}, {20.0, 1e-9}, {30.0, 0.4}, {40.0, std::nan("")}, {50.0, 0.3}});
  EXPECT_EQ(errors, (std::vector<double>{0.2, 0.03, 0.4, 0.03, 0.3}));
  for (const double error : weight_errors({{10.0, 0.0}, {20.0, 0.0}})) {
    EXPECT_DOUBLE_EQ(error, 2e-5);
  }
}

TEST(Observations, WindowTooShortForErrorsIsRefusedInAFit) {
  const dem::LocalData data = local_data({.velocity_noise = 0.1, .frames = 3});
  EXPECT_NE(failure([&] { blocks_for_fit(data); }).find("3 independent blocks"), std::string::npos);
  EXPECT_NO_THROW(block_rows(data));
}

TEST(Observations, RunWithoutFramesHasNoBlocks) {
  dem::LocalData data = local_data({});
  data.frames.frames.clear();
  EXPECT_TRUE(blocks_for_fit(data).empty());
}

}  // namespace
}  // namespace grainlaw::calibration
