// Does a run that was stopped and taken up again follow the path of one that was not, bit for bit?
#include "dem/checkpoint.h"

#include <gtest/gtest.h>

#include <cstring>

#include "dem/run.h"
#include "tests/dem/checkpoint_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

constexpr Hertz hertz{.stiffness = 2e5, .damping = 150.0};
constexpr GaussianWell well{.strength = 0.25, .width = 0.01};
constexpr ReversibleAdhesion dry{.largest_force = 20.0, .slope = 500.0};
constexpr LiquidBridge wet{.surface_tension = 3.0, .contact_angle = 0.2, .volume = 2e-4};
const Sliding grip = sliding(0.5, 2e4, 5.0);
const StickSlip stick{
    .static_coefficient = 0.6, .coefficient = 0.4, .stiffness = 6e3, .damping = 5.0};

template <class Law>
void expect_same_path_of_column(const Law& law) {
  // 3000 steps: the column has fallen together, contacts slip and open, the grains shear.
  expect_same_path(with(small_chute(25.0), law, 50.0), law, 3000, 2500);
}

TEST(Checkpoint, RestartIsExactForEveryLawWithHistory) {
  expect_same_path_of_column(ContactLaw{soft, Cohesionless{}, grip});
  expect_same_path_of_column(ContactLaw{soft, well, grip});
  expect_same_path_of_column(ContactLaw{soft, dry, grip});
  expect_same_path_of_column(ContactLaw{soft, wet, grip});
  expect_same_path_of_column(ContactLaw{soft, wet, Frictionless{}});
  expect_same_path_of_column(ContactLaw{hertz, Cohesionless{}, grip});
  expect_same_path_of_column(ContactLaw{hertz, wet, grip});
  expect_same_path_of_column(ContactLaw{hertz, wet, Frictionless{}});
}

TEST(Checkpoint, RestartIsExactForStickSlipAndWithoutHistory) {
  expect_same_path_of_column(ContactLaw{soft, Cohesionless{}, stick});
  expect_same_path_of_column(ContactLaw{soft, wet, stick});
  expect_same_path_of_column(ContactLaw{hertz, dry, stick});
  expect_same_path_of_column(ContactLaw{soft, Cohesionless{}, Frictionless{}});
  expect_same_path_of_column(ContactLaw{hertz, well, Frictionless{}});
}

TEST(Checkpoint, RestartIsExactInEveryGeometry) {
  const ContactLaw law{soft, wet, grip};
  Scene walled = small_chute(25.0);
  std::get<Chute>(walled.geometry).sidewalls = Sidewalls{};
  std::get<Chute>(walled.geometry).base = FlatBase{};
  for (const Scene& scene : {walled,
                             small_shear(std::nullopt),
                             small_shear(10.0, 300),
                             small_plane_shear(std::nullopt),
                             small_plane_shear(10.0),
                             small_force_box(),
                             small_ring()}) {
    expect_same_path(with(scene, law, 50.0), law, 2000, 12000);
  }
}

/// Local data as text would not show the last bit: compare the frames and rows themselves.
void expect_equal_results(const LocalData& a, const LocalData& b) {
  ASSERT_EQ(a.frames.frames.size(), b.frames.frames.size());
  for (std::size_t k = 0; k < a.frames.frames.size(); ++k) {
    const ProfileFrame& of_a = a.frames.frames[k];
    const ProfileFrame& of_b = b.frames.frames[k];
    EXPECT_EQ(of_a.begin, of_b.begin);
    EXPECT_EQ(of_a.end, of_b.end);
    EXPECT_EQ(of_a.samples, of_b.samples);
    EXPECT_EQ(of_a.centre_of_mass, of_b.centre_of_mass);
    EXPECT_EQ(of_a.kinetic_energy, of_b.kinetic_energy);
    EXPECT_EQ(differing_bytes(of_a.bins, of_b.bins), 0u) << "frame " << k;
  }
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t k = 0; k < a.rows.size(); ++k) {
    EXPECT_EQ(a.rows[k].velocity.value, b.rows[k].velocity.value);
    EXPECT_EQ(a.rows[k].normal_stress.value, b.rows[k].normal_stress.value);
    EXPECT_EQ(a.rows[k].friction.value, b.rows[k].friction.value);
  }
  EXPECT_EQ(a.window.reason, b.window.reason);
  EXPECT_EQ(a.window.begin, b.window.begin);
  const RunSummary& of_a = a.summary;
  const RunSummary& of_b = b.summary;
  EXPECT_EQ(of_a.steps, of_b.steps);
  EXPECT_EQ(of_a.restitution, of_b.restitution);
  EXPECT_EQ(of_a.largest_overlap, of_b.largest_overlap);
  EXPECT_EQ(of_a.deep_overlap_share, of_b.deep_overlap_share);
  EXPECT_EQ(of_a.energy_residual, of_b.energy_residual);
  EXPECT_EQ(of_a.coordination, of_b.coordination);
}

/// A run that is stopped after a time and taken up again against one that goes through.
void expect_same_results(Scene scene) {
  scene.measurement.averaging_time = 8.0;
  scene.measurement.time_limit = 10.0;
  const LocalData whole = run(scene);
  Checkpoint checkpoint;
  RunOptions options;
  options.observer = [](const Progress& p) { return p.settling || p.time < 4.0; };
  options.save = [&](const Checkpoint& saved) { checkpoint = saved; };
  const LocalData part = run(scene, options);
  EXPECT_LT(part.frames.frames.size(), whole.frames.frames.size());
  RunOptions resume;
  resume.resume = &checkpoint;
  expect_equal_results(whole, run(scene, resume));
}

TEST(Checkpoint, RunThatIsTakenUpGivesTheSameLocalData) {
  expect_same_results(small_chute(25.0));
  Scene shear = small_shear(10.0, 300);
  shear.cohesion = dry;
  expect_same_results(shear);
}

TEST(Checkpoint, RunThatIsStoppedBeforeItMovesOnKeepsWhereItWas) {
  Scene scene = small_chute(25.0);
  Checkpoint first, second;
  RunOptions options;
  options.observer = [](const Progress& p) { return p.settling; };
  options.save = [&](const Checkpoint& saved) { first = saved; };
  run(scene, options);
  EXPECT_FALSE(first.numbers.empty());
  options.observer = [](const Progress&) { return false; };
  options.save = [&](const Checkpoint& saved) { second = saved; };
  options.resume = &first;
  EXPECT_TRUE(run(scene, options).frames.frames.empty());
  EXPECT_EQ(differences(first, second), "");
}

TEST(Checkpoint, OfAnotherSceneIsRefused) {
  const ContactLaw law{soft, Cohesionless{}, grip};
  Simulation small = flow(with(small_chute(25.0), law, 50.0), law);
  Simulation large = flow(with(small_chute(25.0, 60), law, 50.0), law);
  EXPECT_THROW(large.restore(state(small)), CheckpointError);
}

}  // namespace
}  // namespace grainlaw::dem
