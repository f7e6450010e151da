// Do the lifetimes of contacts come back from a file, bit for bit?
#include "apps/io/lifetimes_hdf5.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>

#include "apps/io/local_data_hdf5.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

static_assert(std::is_trivially_copyable_v<dem::LifetimeRow>);

/// Any bit pattern, also NaN with payload.
class AnyNumber {
 public:
  operator double() { return std::bit_cast<double>(random_()); }
  operator dem::Estimate() { return {double(*this), double(*this)}; }

 private:
  std::mt19937_64 random_{1};
};

dem::LifetimeDistribution any_distribution(AnyNumber& any, std::size_t rows) {
  dem::LifetimeDistribution d;
  for (double* x : {&d.distance, &d.contacts, &d.unknown, &d.unfinished, &d.survivors, &d.split}) {
    *x = any;
  }
  for (dem::Estimate* x : {&d.mean,
                           &d.mode,
                           &d.collision_rate,
                           &d.long_share,
                           &d.long_shear,
                           &d.long_normal,
                           &d.long_sliding,
                           &d.short_sliding}) {
    *x = any;
  }
  for (dem::Estimate& x : d.long_lifetime) x = any;
  for (double& x : d.beyond) x = any;
  for (std::size_t k = 0; k < rows; ++k) d.rows.push_back({any, any, any, any, any, any});
  return d;
}

/// Everything in front of the rows, as bytes.
std::string head(const dem::LifetimeDistribution& d) {
  return {reinterpret_cast<const char*>(&d), offsetof(dem::LifetimeDistribution, rows)};
}

bool same(const dem::LifetimeDistribution& a, const dem::LifetimeDistribution& b) {
  return head(a) == head(b) && a.rows.size() == b.rows.size() &&
         (a.rows.empty() ||
          std::memcmp(a.rows.data(), b.rows.data(), a.rows.size() * sizeof(a.rows[0])) == 0);
}

TEST(LifetimesHdf5, EveryBitComesBackAndCountsInTheDigest) {
  const TemporaryDirectory directory;
  const auto path = directory / "run.h5";
  SceneFile scene;
  scene.units = grain_units();
  dem::LocalData data;
  write_local_data(data, scene, path);
  EXPECT_FALSE(read_local_data(path).lifetimes.has_value());
  const std::string without = digest(path);

  AnyNumber any;
  dem::LifetimeStatistics all{.begin = 1.0,
                              .end = 2.0,
                              .slice_begin = -INFINITY,
                              .slice_end = INFINITY,
                              .shear_rate = 0.3,
                              .grains = 17.5,
                              .distances = {}};
  for (const std::size_t rows : {0u, 1u, 40u}) all.distances.push_back(any_distribution(any, rows));
  data.lifetimes = all;
  write_local_data(data, scene, path);
  EXPECT_NE(digest(path), without);
  const dem::LocalData again = read_local_data(path);
  ASSERT_TRUE(again.lifetimes.has_value());
  EXPECT_EQ(again.lifetimes->slice_begin, -INFINITY);
  EXPECT_EQ(again.lifetimes->shear_rate, 0.3);
  EXPECT_EQ(again.lifetimes->grains, 17.5);
  ASSERT_EQ(again.lifetimes->distances.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(same(all.distances[k], again.lifetimes->distances[k])) << k;
  }
}

}  // namespace
}  // namespace grainlaw::io
