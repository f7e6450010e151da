#include "dem/simd.h"

#include <gtest/gtest.h>

#include "tests/dem/pair_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

double element(std::size_t row, std::size_t column) {
  return 10.0 * static_cast<double>(row) + static_cast<double>(column) + 0.25;
}

/// Tables of pack_width rows, as the records of grains lie in memory.
template <std::size_t width>
struct Table {
  alignas(64) double value[pack_width][width];

  Table() {
    for (std::size_t r = 0; r < pack_width; ++r) {
      for (std::size_t c = 0; c < width; ++c) value[r][c] = element(r, c);
    }
  }
};

TEST(Simd, ColumnsOfCacheLinesAreTheirElementsAndGoBack) {
  const Table<8> table;
  Row8 rows[pack_width];
  for (std::size_t r = 0; r < pack_width; ++r) rows[r] = Row8::load(table.value[r]);
  Pack columns[8];
  columns_of(rows, columns);
  Row8 back[pack_width];
  rows_of(columns, back);
  for (std::size_t r = 0; r < pack_width; ++r) {
    alignas(64) double record[8];
    back[r].store(record);
    for (std::size_t c = 0; c < 8; ++c) {
      EXPECT_EQ(columns[c][r], element(r, c));
      EXPECT_EQ(record[c], element(r, c));
    }
  }
}

TEST(Simd, ColumnsOfHalfCacheLinesAreTheirElementsAndGoBack) {
  const Table<4> table;
  Row4 rows[pack_width];
  for (std::size_t r = 0; r < pack_width; ++r) rows[r] = load_row4(table.value[r]);
  Pack columns[4];
  columns_of(rows, columns);
  Row4 back[pack_width];
  rows_of(columns, back);
  for (std::size_t r = 0; r < pack_width; ++r) {
    alignas(32) double record[4];
    store(back[r], record);
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_EQ(columns[c][r], element(r, c));
      EXPECT_EQ(record[c], element(r, c));
    }
  }
}

TEST(Simd, CacheLinesAddElementByElement) {
  const Table<8> table;
  alignas(64) const double factor[8] = {1, -1, 2, -2, 3, -3, 0.5, 0};
  alignas(64) double sum[8], scaled[8];
  const Row8 a = Row8::load(table.value[0]);
  const Row8 b = Row8::load(table.value[1]);
  (a + b).store(sum);
  add_scaled(a, Row8::load(factor), b).store(scaled);
  for (std::size_t c = 0; c < 8; ++c) {
    EXPECT_EQ(sum[c], element(0, c) + element(1, c));
    EXPECT_EQ(scaled[c], element(0, c) + factor[c] * element(1, c));
  }
}

TEST(Simd, CompressKeepsTheChosenWordsInOrderForEveryChoice) {
  std::array<std::uint32_t, pack_width> words;
  for (std::uint32_t k = 0; k < pack_width; ++k) words[k] = 100 + k;
  for (std::uint32_t chosen = 0; chosen < 1u << pack_width; ++chosen) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t k = 0; k < pack_width; ++k) {
      if (chosen >> k & 1u) expected.push_back(words[k]);
    }
    std::array<std::uint32_t, pack_width> to{};
    ASSERT_EQ(compress(words.data(), chosen, to.data()), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) ASSERT_EQ(to[k], expected[k]);
  }
}

TEST(Simd, MasksAreBitsAndSelectTakesEachLaneFromItsSide) {
  const Pack yes([](auto lane) { return 1.0 + static_cast<double>(lane); });
  const Pack no = -yes;
  for (std::uint32_t chosen = 0; chosen < 1u << pack_width; ++chosen) {
    const PackMask mask = mask_of(chosen);
    ASSERT_EQ(bits(mask), chosen);
    ASSERT_EQ(any(mask), chosen != 0);
    const Pack result = select(mask, yes, no);
    for (std::size_t k = 0; k < pack_width; ++k) {
      ASSERT_EQ(result[k], select((chosen >> k & 1u) != 0, double(yes[k]), double(no[k])));
    }
  }
}

TEST(Simd, SelectDropsWhatIsNotANumberOnTheOtherSide) {
  const Pack nothing = Pack(0.0) / Pack(0.0);
  EXPECT_EQ(largest(select(PackMask(true), Pack(1.0), nothing)), 1.0);
  EXPECT_EQ(sum(select(PackMask(false), nothing, Pack(1.0))), double(pack_width));
}

TEST(Simd, ExtremesAndSumsAreThoseOfTheLanes) {
  Random random(1);
  for (int n = 0; n < 100; ++n) {
    const Pack a([&](auto) { return random.between(-1.0, 1.0); });
    const Pack b([&](auto) { return random.between(-1.0, 1.0); });
    double total = 0.0, most = -1.0;
    for (std::size_t k = 0; k < pack_width; ++k) {
      EXPECT_EQ(max(a, b)[k], max(double(a[k]), double(b[k])));
      EXPECT_EQ(min(a, b)[k], min(double(a[k]), double(b[k])));
      EXPECT_EQ(abs(a)[k], std::abs(double(a[k])));
      total += a[k], most = std::max(most, double(a[k]));
    }
    // Each of the additions rounds a number below pack_width by at most 2^-53 of it.
    EXPECT_NEAR(sum(a), total, 2.0 * pack_width * pack_width * 1.2e-16);
    EXPECT_EQ(largest(a), most);
  }
}

TEST(Simd, InverseSquareRootIsRightToTheLastBits) {
  Random random(2);
  long double worst = 0.0L;
  for (int n = 0; n < 100'000; ++n) {
    const Pack a([&](auto) { return std::exp(random.between(-600.0, 600.0)); });
    const Pack root = inverse_sqrt(a);
    for (std::size_t k = 0; k < pack_width; ++k) {
      const long double exact = 1.0L / std::sqrt(static_cast<long double>(double(a[k])));
      worst = std::max(worst, std::abs(static_cast<long double>(double(root[k])) / exact - 1.0L));
    }
  }
  EXPECT_LT(worst, 4e-16L);  // as its comment promises
  std::cout << "inverse_sqrt: largest relative error " << static_cast<double>(worst) << '\n';
}

TEST(Simd, ReciprocalIsRightToTheLastBits) {
  Random random(4);
  long double worst = 0.0L;
  for (int n = 0; n < 100'000; ++n) {
    const Pack a([&](auto) { return std::exp(random.between(-600.0, 600.0)); });
    const Pack inverse = reciprocal(a);
    for (std::size_t k = 0; k < pack_width; ++k) {
      const long double product = static_cast<long double>(double(a[k])) * double(inverse[k]);
      worst = std::max(worst, std::abs(product - 1.0L));
    }
  }
  EXPECT_LT(worst, 4e-16L);
  std::cout << "reciprocal: largest relative error " << static_cast<double>(worst) << '\n';
}

/// What one contact is evaluated with and what comes out, as plain numbers.
struct Sample {
  Contact contact;
  TangentialMotion<double> motion;
  TangentialSpring<double> spring;
  double grip = 1.0;
  bool bridged = false;
};

/// Touching or apart, in and out of range, sticking or slipping, at rest or moving.
template <class Law>
Sample sample(const Law& law, Random& random) {
  Sample s;
  Contact& c = s.contact;
  const Vec3 along = random.vector(1.0);
  c.normal = 1.0 / length(along) * along;
  const double first = random.between(0.3, 0.7);
  const double second = random.chance(0.2) ? 0.0 : random.between(0.3, 0.7);
  c.radius_sum = first + second;
  c.harmonic_radius = harmonic_radius(first, second);
  c.overlap = random.chance(0.1) ? 0.0 : random.between(-0.03, 0.03);
  if (random.chance(0.1)) c.overlap = -law.range();
  c.distance = c.radius_sum - c.overlap;
  c.normal_velocity = random.between(-2.0, 2.0);
  c.reduced_mass = random.between(0.1, 1.0);
  const auto in_plane = [&](const Vec3& v) { return v - dot(v, c.normal) * c.normal; };
  s.motion.surface_velocity = in_plane(random.vector(2.0));
  s.motion.normal_rate = in_plane(random.vector(2.0));
  s.spring.stretch = random.chance(0.2) ? Vec3{} : random.vector(random.chance(0.5) ? 0.02 : 1e-4);
  s.spring.slipping = random.chance(0.5) ? 1.0 : 0.0;
  s.grip = random.chance(0.2) ? 0.0 : 1.0;
  s.bridged = c.overlap >= 0.0 || random.chance(0.5);
  return s;
}

Vector3<Pack> pack(const auto& vector_of_lane) {
  return {Pack([&](auto k) { return vector_of_lane(k).x; }),
          Pack([&](auto k) { return vector_of_lane(k).y; }),
          Pack([&](auto k) { return vector_of_lane(k).z; })};
}

using Lanes = std::array<Sample, pack_width>;

ContactOf<Pack> contact_of(const Lanes& lanes) {
  const auto take = [&](double Contact::*member) {
    return Pack([&](auto k) { return lanes[k].contact.*member; });
  };
  return {.normal = pack([&](auto k) { return lanes[k].contact.normal; }),
          .distance = take(&Contact::distance),
          .overlap = take(&Contact::overlap),
          .normal_velocity = take(&Contact::normal_velocity),
          .reduced_mass = take(&Contact::reduced_mass),
          .radius_sum = take(&Contact::radius_sum),
          .harmonic_radius = take(&Contact::harmonic_radius)};
}

constexpr std::size_t outputs = 15;

/// Everything a law gives, in a row.
template <class S>
std::array<S, outputs> row_of(const ContactForce<S>& f, const TangentialSpring<S>& s) {
  return {f.normal,
          f.tangential.x,
          f.tangential.y,
          f.tangential.z,
          f.normal_dashpot,
          f.prefactor_work,
          f.spring_lost,
          f.friction.dashpot,
          f.friction.slip,
          f.friction.elastic_energy,
          s.stretch.x,
          s.stretch.y,
          s.stretch.z,
          s.slipping,
          S(0.0)};
}

/// Largest difference between pack and lanes, and largest number, of each output.
struct Comparison {
  std::array<double, outputs> difference{};
  std::array<double, outputs> size{};
};

template <class Law>
void compare(const Law& law, const Lanes& lanes, Comparison& comparison) {
  constexpr double time_step = 1e-4;
  const TangentialMotion<Pack> motion{
      .surface_velocity = pack([&](auto k) { return lanes[k].motion.surface_velocity; }),
      .normal_rate = pack([&](auto k) { return lanes[k].motion.normal_rate; })};
  TangentialSpring<Pack> spring{pack([&](auto k) { return lanes[k].spring.stretch; }),
                                Pack([&](auto k) { return lanes[k].spring.slipping; })};
  const Pack grip([&](auto k) { return lanes[k].grip; });
  const Pack bridged([&](auto k) { return lanes[k].bridged ? 1.0 : 0.0; });
  const auto force =
      contact_force(law, contact_of(lanes), motion, grip, bridged > 0.5, time_step, spring);
  const auto packed = row_of(force, spring);
  for (std::size_t k = 0; k < pack_width; ++k) {
    Sample s = lanes[k];
    const auto alone = row_of(
        contact_force(law, s.contact, s.motion, s.grip, s.bridged, time_step, s.spring), s.spring);
    for (std::size_t n = 0; n < outputs; ++n) {
      ASSERT_TRUE(std::isfinite(alone[n])) << "output " << n;
      const double difference = std::abs(packed[n][k] - alone[n]);
      comparison.difference[n] = std::max(comparison.difference[n], difference);
      comparison.size[n] = std::max(comparison.size[n], std::abs(alone[n]));
    }
  }
}

TEST(Simd, AllLawsGiveAPackWhatTheyGiveEachOfItsContacts) {
  for_each_law([](const auto& law) {
    SCOPED_TRACE(name(law));
    Random random(3);
    Comparison comparison;
    for (int n = 0; n < 3000; ++n) {
      Lanes lanes;
      for (Sample& lane : lanes) lane = sample(law, random);
      compare(law, lanes, comparison);
    }
    // Some tens of roundings of 1e-16, of terms that are not larger than the largest results. What
    // the normal dashpot takes is the difference of two normal forces, times a way.
    constexpr double way = 2.0 * 1e-4;
    comparison.size[4] = std::max(comparison.size[4], way * comparison.size[0]);
    for (std::size_t n = 0; n < outputs; ++n) {
      EXPECT_LE(comparison.difference[n], 1e-14 * comparison.size[n]) << "output " << n;
    }
    EXPECT_GT(comparison.size[0], 0.0);
    EXPECT_EQ(comparison.size[8] > 0.0, law.rotates);  // some did slip
  });
}

}  // namespace
}  // namespace grainlaw::dem
