// Are the lifetimes of contacts recovered from a window that cuts many of them?
#include "dem/lifetime_statistics.h"

#include <gtest/gtest.h>

#include <random>

namespace grainlaw::dem {
namespace {

/// Contacts that begin at random times and whose lifetimes are exponential with mean 1, followed
/// from 0 on, as blocks up to the end.
struct Window {
  LifetimeAxis axis{.contact_time = 0.01};
  std::vector<LifetimeBlock> blocks;
  double seen = 0.0;  ///< sum of the lifetimes that began and ended inside
  double count = 0.0;

  Window(double end, std::size_t count_of_blocks)
      : width_(end / static_cast<double>(count_of_blocks)) {
    for (std::size_t k = 0; k < count_of_blocks; ++k) {
      const double begin = width_ * static_cast<double>(k);
      blocks.push_back({begin, begin + width_, 1.0, 1.0, std::vector<LifetimeTally>(1)});
    }
  }

  void add(double begin, double lifetime) {
    if (begin < 0.0) return;  // of unknown age
    auto b = static_cast<std::size_t>(begin / width_);
    tally(b).begun += 1.0;
    for (; blocks[b].end < begin + lifetime; ++b) {
      const std::size_t age = axis.bin(blocks[b].end - begin);
      tally(b).bins[age].entered -= 1.0;
      tally(b).unfinished += 1.0;
      if (b + 1 == blocks.size()) return;
      tally(b + 1).bins[age].entered += 1.0;
    }
    LifetimeCounts& bin = tally(b).bins[axis.bin(lifetime)];
    bin.ended += 1.0;
    bin.lifetime += lifetime;
    seen += lifetime;
    count += 1.0;
  }

  LifetimeDistribution distribution(std::size_t from_block = 0) const {
    return lifetime_distribution(axis, std::span(blocks).subspan(from_block), 0, 1.0);
  }

 private:
  LifetimeTally& tally(std::size_t block) { return blocks[block].distances[0]; }
  double width_;
};

Window exponential_contacts(double end, std::size_t blocks, double per_time, unsigned seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<double> lifetime(1.0);
  std::exponential_distribution<double> pause(per_time);
  constexpr double long_before = -10.0;
  Window window(end, blocks);
  for (double t = long_before + pause(random); t < end; t += pause(random)) {
    window.add(t, lifetime(random));
  }
  return window;
}

TEST(LifetimeStatistics, ContactsCutByTheWindowDoNotBiasTheMean) {
  const Window window = exponential_contacts(8.0, 40, 5000.0, 1);
  const LifetimeDistribution d = window.distribution();
  // A window of 8 mean lifetimes cannot see the exp(-8) of contacts that outlive it: 3e-4.
  EXPECT_NEAR(d.mean.value, 1.0, 4.0 * d.mean.error + 3e-4);
  EXPECT_LT(d.mean.error, 0.01);
  // Those that began and ended inside are too short-lived: mean (T - 2 + ...)/(T - 1 + ...).
  const double end = 8.0;
  const double cut = std::exp(-end);
  const double naive = (end - 2.0 + (end + 2.0) * cut) / (end - 1.0 + cut);
  EXPECT_NEAR(window.seen / window.count, naive, 0.02);
  EXPECT_LT(naive, d.mean.value - 10.0 * d.mean.error);
}

TEST(LifetimeStatistics, ContactsKnownBeforeTheWindowEnterItAtTheirAge) {
  const Window window = exponential_contacts(10.0, 50, 5000.0, 2);
  const LifetimeDistribution d = window.distribution(25);  // from 5 on
  EXPECT_NEAR(d.mean.value, 1.0, 4.0 * d.mean.error);
  EXPECT_NEAR(d.collision_rate.value, 2.0 * 5000.0, 4.0 * d.collision_rate.error);
  EXPECT_NEAR(d.unfinished, 5000.0, 5.0 * std::sqrt(5000.0));  // rate times mean lifetime
}

TEST(LifetimeStatistics, LongLifetimesLieWhereTheExponentialHasItsDensity) {
  constexpr double end = 12.0, per_time = 4000.0;
  const LifetimeDistribution d = exponential_contacts(end, 40, per_time, 3).distribution();
  for (std::size_t k = 0; k < d.levels.size(); ++k) {
    const Estimate x = d.long_lifetime[k];
    EXPECT_NEAR(x.value, -std::log(d.levels[k]), 4.0 * x.error) << "P = " << d.levels[k];
    EXPECT_LT(x.error, 0.1);
    EXPECT_TRUE(d.tail_sampled(k));
    // Counted are those in whole bins beyond; the window cuts a share t / T of lifetimes t.
    const LifetimeAxis axis = Window(end, 40).axis;
    const double from = axis.end(axis.bin(x.value));
    const double beyond = per_time * (std::exp(-from) * (end - from - 1.0) + std::exp(-end));
    EXPECT_NEAR(d.beyond[k], beyond, 5.0 * std::sqrt(beyond));
  }
}

TEST(LifetimeStatistics, DensityErrorsAreAsLargeAsItsScatter) {
  const LifetimeDistribution d = exponential_contacts(10.0, 40, 5000.0, 4).distribution();
  double squares = 0.0, rows = 0.0, integral = 0.0;
  for (const LifetimeRow& row : d.rows) {
    integral += row.density.value * (row.end - row.begin);
    if (row.contacts < 100.0) continue;
    const double mean =
        (std::exp(-row.begin) - std::exp(-row.end)) / (row.end - row.begin);  // over the bin
    squares += std::pow((row.density.value - mean) / row.density.error, 2);
    rows += 1.0;
  }
  ASSERT_GT(rows, 40.0);
  // Student's t with 19 degrees: mean square 19/17, its standard error over 50 bins 0.26.
  EXPECT_NEAR(squares / rows, 19.0 / 17.0, 4.0 * 0.26);
  EXPECT_NEAR(integral + d.survivors, 1.0, 1e-12);
}

TEST(LifetimeStatistics, TailThatWasNotSampledIsSaid) {
  const LifetimeDistribution few = exponential_contacts(8.0, 40, 60.0, 5).distribution();
  EXPECT_FALSE(few.tail_sampled(1));
  const LifetimeDistribution none = Window(8.0, 40).distribution();
  EXPECT_EQ(none.contacts, 0.0);
  EXPECT_FALSE(none.tail_sampled(1));
  EXPECT_TRUE(std::isnan(none.mean.value));
}

TEST(LifetimeStatistics, IntervalsCoverTheTruthAsOftenAsTheySay) {
  constexpr int windows = 100;
  int mean_inside = 0, long_inside = 0;
  for (unsigned seed = 0; seed < windows; ++seed) {
    const LifetimeDistribution d = exponential_contacts(10.0, 40, 400.0, 100 + seed).distribution();
    mean_inside += std::abs(d.mean.value - 1.0) < 2.0 * d.mean.error;
    const Estimate x = d.long_lifetime[1];
    long_inside += std::abs(x.value - std::log(10.0)) < 2.0 * x.error;
  }
  // Two standard errors hold 94 % (Student's t, 19 degrees); binomial scatter of 100 windows 2.4 %.
  EXPECT_GE(mean_inside, 94 - 4 * 2.4);
  EXPECT_GE(long_inside, 94 - 4 * 2.4);
}

}  // namespace
}  // namespace grainlaw::dem
