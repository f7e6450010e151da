#include "apps/io/local_data_hdf5.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <thread>

#include "apps/io/safe_write.h"
#include "apps/io/sealed_file.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

/// Any bit pattern, also NaN with payload, denormals and -0.
double any_double(std::mt19937_64& random) {
  return std::bit_cast<double>(random());
}

dem::Estimate any_estimate(std::mt19937_64& random) {
  return {any_double(random), any_double(random), any_double(random)};
}

dem::LocalRow any_row(std::mt19937_64& random) {
  dem::LocalRow row;
  for (double* x : {&row.z, &row.mass_above, &row.effective_samples}) *x = any_double(random);
  for (dem::Estimate* x : {&row.velocity,
                           &row.shear_rate,
                           &row.volume_fraction,
                           &row.shear_stress,
                           &row.normal_stress,
                           &row.temperature,
                           &row.inertial_number,
                           &row.softness,
                           &row.bond_number,
                           &row.scaled_temperature,
                           &row.bulk_inertial_number,
                           &row.friction,
                           &row.pressure,
                           &row.coordination,
                           &row.dissipation,
                           &row.sliding_share}) {
    *x = any_estimate(random);
  }
  return row;
}

template <class T>
T any_numbers(std::mt19937_64& random) {
  std::array<double, sizeof(T) / sizeof(double)> values;
  for (double& value : values) value = any_double(random);
  return std::bit_cast<T>(values);
}

dem::ProfileFrame any_frame(std::mt19937_64& random, std::size_t bins) {
  dem::ProfileFrame frame;
  for (double* x : {&frame.begin, &frame.end, &frame.centre_of_mass, &frame.kinetic_energy}) {
    *x = any_double(random);
  }
  frame.samples = static_cast<int>(random() % 1000);
  frame.bins.resize(bins);
  frame.sliding.resize(bins);
  for (dem::BinMoments& bin : frame.bins) bin = any_numbers<dem::BinMoments>(random);
  for (dem::SlidingMoments& bin : frame.sliding) bin = any_numbers<dem::SlidingMoments>(random);
  return frame;
}

dem::LocalData any_data(std::size_t rows, std::size_t frames, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  dem::LocalData data;
  data.name = "theta 23\u00b0";
  data.conditions = {.geometry = "simple_shear",
                     .inclination = 0.4,
                     .gravity = 1.0,
                     .grain_diameter = 1.0,
                     .grain_density = 1.9,
                     .stiffness = 2e4,
                     .contact_friction = 0.5,
                     .attraction = 2.0,
                     .mass_per_area = 22.0,
                     .shear_rate = 0.3,
                     .base = "bumpy, thickness 1.5 d",
                     .tilts = {{0.0, 0.42}, {100.0, 0.4}}};
  data.window = {true, 100.0, 300.0, "mean velocity does not drift", any_double(random)};
  for (std::size_t k = 0; k < rows; ++k) data.rows.push_back(any_row(random));
  data.frames.z_begin = -1.5;
  for (std::size_t k = 0; k < frames; ++k) {
    data.frames.frames.push_back(any_frame(random, 3 + k % 4));  // not all of equal length
  }
  data.frames.bins_per_row = 4;
  data.frames.periodic = true;
  data.frames.kernel = {dem::KernelShape::gaussian, 0.7};
  for (const std::size_t count : {3u, 5u, 9u}) {  // wider kernels reach farther
    dem::WidthFields& fields = data.fields.emplace_back();
    fields.width = any_double(random);
    fields.z_begin = any_double(random);
    for (std::size_t k = 0; k < count; ++k) {
      fields.values.push_back(any_numbers<dem::FieldRow>(random));
      fields.errors.push_back(any_numbers<dem::FieldRow>(random));
    }
  }
  data.ring = dem::RingFields{
      .grid =
          {.wedge = 0.5, .r_begin = 4.7, .z_begin = -3.0, .width = 1.0, .columns = 4, .rows = 3},
      .values = {},
      .errors = {}};
  for (std::size_t k = 0; k < data.ring->grid.size(); ++k) {
    data.ring->values.push_back(any_numbers<dem::RingField>(random));
    data.ring->errors.push_back(any_numbers<dem::RingField>(random));
  }
  data.summary.steps = 123456789012;
  data.summary.flowing_grains = 836;
  data.summary.wall_seconds = 12.5;
  data.summary.energy_residual = any_double(random);
  return data;
}

SceneFile any_scene() {
  SceneFile file;
  file.text = "units = \"grain\"\n# a comment\n";
  file.scene.seed = 42;
  return file;
}

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_rows(const dem::LocalData& a, const dem::LocalData& b) {
  static_assert(std::is_trivially_copyable_v<dem::LocalRow>);
  return a.rows.size() == b.rows.size() &&
         (a.rows.empty() ||
          std::memcmp(a.rows.data(), b.rows.data(), a.rows.size() * sizeof(dem::LocalRow)) == 0);
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_fields(const dem::LocalData& a, const dem::LocalData& b) {
  if (a.fields.size() != b.fields.size()) return false;
  for (std::size_t k = 0; k < a.fields.size(); ++k) {
    const dem::WidthFields& x = a.fields[k];
    const dem::WidthFields& y = b.fields[k];
    if (!same(x.width, y.width) || !same(x.z_begin, y.z_begin)) return false;
    if (!same_bits(x.values, y.values) || !same_bits(x.errors, y.errors)) return false;
  }
  return true;
}

bool same_frames(const dem::LocalData& a, const dem::LocalData& b) {
  if (a.frames.frames.size() != b.frames.frames.size()) return false;
  for (std::size_t k = 0; k < a.frames.frames.size(); ++k) {
    const dem::ProfileFrame& x = a.frames.frames[k];
    const dem::ProfileFrame& y = b.frames.frames[k];
    if (!same(x.begin, y.begin) || !same(x.kinetic_energy, y.kinetic_energy) ||
        x.samples != y.samples || !same_bits(x.bins, y.bins) || !same_bits(x.sliding, y.sliding)) {
      return false;
    }
  }
  return true;
}

TEST(LocalDataHdf5, EveryBitComesBack) {
  const TemporaryDirectory directory;
  const dem::LocalData data = any_data(30, 17, 1);
  write_local_data(data, any_scene(), directory / "run.h5");
  const dem::LocalData again = read_local_data(directory / "run.h5");
  EXPECT_TRUE(same_rows(data, again));
  EXPECT_TRUE(same_frames(data, again));
  EXPECT_TRUE(same_fields(data, again));
  EXPECT_EQ(again.frames.bins_per_row, 4u);
  EXPECT_TRUE(again.frames.periodic);
  EXPECT_EQ(again.frames.kernel.shape, dem::KernelShape::gaussian);
  EXPECT_EQ(again.frames.kernel.width, 0.7);
  EXPECT_EQ(again.name, data.name);
  EXPECT_EQ(again.conditions.geometry, data.conditions.geometry);
  EXPECT_EQ(again.conditions.shear_rate, data.conditions.shear_rate);
  EXPECT_EQ(again.conditions.base, data.conditions.base);
  EXPECT_EQ(again.conditions.mass_per_area, 22.0);
  EXPECT_EQ(again.conditions.tilts, data.conditions.tilts);
  EXPECT_TRUE(same(again.window.arrested_at.value(), *data.window.arrested_at));
  EXPECT_EQ(again.window.reason, data.window.reason);
  EXPECT_TRUE(again.window.steady);
  EXPECT_EQ(again.frames.z_begin, -1.5);
  EXPECT_EQ(again.summary.steps, 123456789012);
  EXPECT_EQ(again.summary.wall_seconds, 12.5);
  EXPECT_TRUE(same(again.summary.energy_residual, data.summary.energy_residual));
}

TEST(LocalDataHdf5, FieldsOfARingComeBackOverHeightAndRadius) {
  const TemporaryDirectory directory;
  const dem::LocalData data = any_data(2, 2, 3);
  write_local_data(data, any_scene(), directory / "run.h5");
  const dem::LocalData again = read_local_data(directory / "run.h5");
  ASSERT_TRUE(again.ring);
  EXPECT_EQ(again.ring->grid.columns, 4u);
  EXPECT_EQ(again.ring->grid.rows, 3u);
  EXPECT_EQ(again.ring->grid.r_begin, 4.7);
  EXPECT_TRUE(same_bits(again.ring->values, data.ring->values));
  EXPECT_TRUE(same_bits(again.ring->errors, data.ring->errors));
}

TEST(LocalDataHdf5, RingWithoutASteadyWindowHasItsGridOnly) {
  const TemporaryDirectory directory;
  dem::LocalData data = any_data(2, 2, 4);
  data.ring->values.clear();
  data.ring->errors.clear();
  write_local_data(data, any_scene(), directory / "run.h5");
  const dem::LocalData again = read_local_data(directory / "run.h5");
  ASSERT_TRUE(again.ring);
  EXPECT_TRUE(again.ring->values.empty());
  EXPECT_EQ(again.ring->grid.rows, 3u);
}

TEST(LocalDataHdf5, NothingIsStoredAboveTheHighestGrainAndItComesBackEmpty) {
  const TemporaryDirectory directory;
  dem::LocalData data = any_data(3, 2, 5);
  for (dem::ProfileFrame& frame : data.frames.frames) {
    frame.bins.resize(2000);
    frame.sliding.clear();
  }
  for (dem::LocalRow& row : data.rows) row.sliding_share = {};
  data.fields.clear();
  write_local_data(data, any_scene(), directory / "run.h5");
  EXPECT_LT(std::filesystem::file_size(directory / "run.h5"), 2000u * sizeof(dem::BinMoments));
  EXPECT_TRUE(same_frames(data, read_local_data(directory / "run.h5")));
}

TEST(LocalDataHdf5, AReducedFileIsSmallerAndSaysOfWhichItWasMade) {
  const TemporaryDirectory directory;
  dem::LocalData data = any_data(30, 400, 6);
  for (dem::ProfileFrame& frame : data.frames.frames) {
    frame.bins.assign(128, {.mass = 0.1});
    frame.sliding.assign(128, {});
    frame.samples = 10;
  }
  write_local_data(data, any_scene(), directory / "whole.h5");
  const RunRecord whole = read_run_record(directory / "whole.h5");
  write_reduced_data(whole, directory / "small.h5");
  const RunRecord small = read_run_record(directory / "small.h5");
  // 400 frames of random times before no window become 32, in half of the digits.
  EXPECT_LT(10 * std::filesystem::file_size(directory / "small.h5"),
            std::filesystem::file_size(directory / "whole.h5"));
  EXPECT_EQ(small.reduced_from, digest(whole));
  EXPECT_EQ(digest(small), digest(whole));
  EXPECT_TRUE(same_rows(small.data, data));
  EXPECT_TRUE(same_fields(small.data, data));
  EXPECT_TRUE(same_bits(small.data.ring->values, data.ring->values));
  EXPECT_EQ(small.scene_text, whole.scene_text);
  EXPECT_EQ(small.date, whole.date);
  write_reduced_data(small, directory / "again.h5");
  EXPECT_EQ(read_file(directory / "again.h5"), read_file(directory / "small.h5"));
}

TEST(LocalDataHdf5, TheFileKnowsWhatMadeIt) {
  const TemporaryDirectory directory;
  SceneFile scene = any_scene();
  scene.units = si_units(1e-3, 2500.0, 9.81);
  write_local_data(any_data(2, 2, 1), scene, directory / "run.h5");
  const RunRecord record = read_run_record(directory / "run.h5");
  EXPECT_EQ(record.scene_text, scene.text);
  EXPECT_EQ(record.seed, 42u);
  EXPECT_EQ(record.units.name, "si");
  EXPECT_EQ(record.units.mass, scene.units.mass);
  EXPECT_FALSE(record.version.empty());
  EXPECT_EQ(record.date.size(), std::string("2020-01-01T00:00:00Z").size());
}

TEST(LocalDataHdf5, ARunWhereASceneIsExpectedIsCalledAnHdf5File) {
  const TemporaryDirectory directory;
  write_local_data(any_data(2, 2, 1), any_scene(), directory / "run.h5");
  try {
    read_scene(directory / "run.h5");
    FAIL();
  } catch (const ReadError& error) {
    EXPECT_NE(std::string(error.what()).find("is an HDF5 file, e.g. a run"), std::string::npos)
        << error.what();
  }
}

TEST(LocalDataHdf5, ARunWithoutRowsOrFramesIsAFileToo) {
  const TemporaryDirectory directory;
  write_local_data(any_data(0, 0, 1), any_scene(), directory / "run.h5");
  const dem::LocalData again = read_local_data(directory / "run.h5");
  EXPECT_TRUE(again.rows.empty());
  EXPECT_TRUE(again.frames.frames.empty());
}

TEST(LocalDataHdf5, DigestIgnoresTheMachineAndNothingElse) {
  const TemporaryDirectory directory;
  dem::LocalData data = any_data(5, 5, 1);
  const auto digest_of = [&](const dem::LocalData& d, const SceneFile& scene) {
    write_local_data(d, scene, directory / "run.h5");
    return digest(directory / "run.h5");
  };
  const std::string first = digest_of(data, any_scene());
  data.summary.wall_seconds *= 2.0;
  EXPECT_EQ(digest_of(data, any_scene()), first);
  data.frames.frames.back().bins.back().contacts =
      std::nextafter(data.frames.frames.back().bins.back().contacts, 0.0);
  EXPECT_NE(digest_of(data, any_scene()), first);
  SceneFile other = any_scene();
  other.text += " ";
  EXPECT_NE(digest_of(any_data(5, 5, 1), other), first);
}

/// "" when the file is read, the message when it is refused. Anything else ends the test.
std::string refusal(const std::filesystem::path& path) {
  try {
    read_local_data(path);
    return "";
  } catch (const ReadError& error) {
    return error.what();
  }
}

TEST(LocalDataHdf5, AFileCutShortIsRefusedAtEveryLength) {
  const TemporaryDirectory directory;
  write_local_data(any_data(6, 3, 1), any_scene(), directory / "run.h5");
  const std::string bytes = read_file(directory / "run.h5");
  for (std::size_t length = 0; length < bytes.size(); length += length < 600 ? 1 : 97) {
    const auto path = directory.write("cut.h5", bytes.substr(0, length));
    EXPECT_NE(refusal(path), "") << length;
  }
  EXPECT_NE(refusal(directory / "cut.h5").find("is cut short"), std::string::npos);
}

TEST(LocalDataHdf5, AFlippedByteAnywhereIsFound) {
  const TemporaryDirectory directory;
  write_local_data(any_data(6, 3, 1), any_scene(), directory / "run.h5");
  const std::string bytes = read_file(directory / "run.h5");
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937_64 random(seed);
    std::string changed = bytes;
    changed[random() % changed.size()] ^= static_cast<char>(1 + random() % 255);
    EXPECT_NE(refusal(directory.write("changed.h5", changed)), "") << seed;
  }
}

TEST(LocalDataHdf5, DamageUnderAForgedSealIsReadOrRefusedButDoesNotCrash) {
  const TemporaryDirectory directory;
  write_local_data(any_data(6, 3, 1), any_scene(), directory / "run.h5");
  const std::string content = read_file(directory / "run.h5").substr(seal_bytes);
  // What our own reader checks: names, kinds and lengths. (HDF5 1.10 itself crashes on some files
  // with broken structures: that is why files are sealed.)
  for (const std::string name : {"moments", "velocity", "steady", "seed", "bins", "inclination"}) {
    std::string renamed = content;
    for (std::size_t at = 0; (at = renamed.find(name, at)) != std::string::npos; ++at) {
      renamed[at] = 'x';
    }
    const auto path = directory.write("forged.h5", seal("local data", 1, renamed));
    EXPECT_NE(refusal(path), "") << name;
  }
}

TEST(LocalDataHdf5, ForeignFilesAreNamedAsSuch) {
  const TemporaryDirectory directory;
  const auto message = [&](const std::string& bytes) {
    return refusal(directory.write("foreign.h5", bytes));
  };
  EXPECT_NE(message("").find("is empty"), std::string::npos);
  EXPECT_NE(message("this is text").find("is not a file that grainlaw wrote"), std::string::npos);
  EXPECT_NE(message("\x89HDF\r\n\x1a\n").find("is an HDF5 file, but not one"), std::string::npos);
  EXPECT_NE(message(seal("checkpoint", 1, "x")).find("a local data file is wanted"),
            std::string::npos);
  EXPECT_NE(message(seal("local data", 4, "x")).find("has format 4"), std::string::npos);
  EXPECT_NE(message(seal("local data", 3, "x")).find("cannot read the HDF5 part"),
            std::string::npos);
  EXPECT_NE(refusal(directory / "none.h5").find("No such file"), std::string::npos);
}

TEST(LocalDataHdf5, SeveralThreadsMayWriteAndReadAtOnce) {
  const TemporaryDirectory directory;
  std::vector<std::jthread> threads;
  std::array<bool, 4> equal{};
  for (std::size_t k = 0; k < equal.size(); ++k) {
    threads.emplace_back([&, k] {
      const auto path = directory / (std::to_string(k) + ".h5");
      const dem::LocalData data = any_data(20, 20, k);
      write_local_data(data, any_scene(), path);
      equal[k] = same_rows(data, read_local_data(path));
    });
  }
  threads.clear();
  for (const bool e : equal) EXPECT_TRUE(e);
}

}  // namespace
}  // namespace grainlaw::io
