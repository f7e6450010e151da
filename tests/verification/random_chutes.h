#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {

/// Numbers of a legal case: the same on every machine.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  /// Evenly over the decades.
  double decades(double low, double high) {
    return std::pow(10.0, between(std::log10(low), std::log10(high)));
  }
  bool chance(double share) { return between(0.0, 1.0) < share; }

 private:
  std::mt19937_64 bits_;
};

inline MuPhi random_mu_phi(Draw& draw) {
  MuPhi law{.friction = {.mu0 = draw.chance(0.1) ? 0.0 : draw.between(0.05, 0.6),
                         .beta = draw.decades(1e-3, 10.0),
                         .kappa = draw.chance(0.2) ? 0.0 : draw.decades(1e-2, 30.0)},
            .volume_fraction = {.phi0 = draw.between(0.4, 0.7),
                                .I_phi = draw.chance(0.2) ? INFINITY : draw.decades(0.5, 20.0)}};
  if (draw.chance(0.2)) law.friction.exponent = draw.between(0.4, 1.6);
  if (draw.chance(0.5))
    law.softness_friction = SoftnessFriction{
        .p_mu = draw.decades(0.05, 5.0),
        .form = draw.chance(0.5) ? SoftnessForm::linear : SoftnessForm::square_root};
  if (draw.chance(0.5))
    law.softness_volume_fraction = SoftnessVolumeFraction{.p_phi = draw.between(0.2, 0.4)};
  if (draw.chance(0.3))
    law.cohesion_friction =
        CohesionFriction{.alpha = draw.between(0.0, 1.0), .beta = draw.between(0.5, 2.0)};
  else if (draw.chance(0.3))
    law.cohesion_stress = CohesionStress{.factor = draw.between(0.0, 1.0)};
  return law;
}

inline GeneralisedBagnold random_bagnold(Draw& draw) {
  GeneralisedBagnold law{.a = draw.decades(1e-8, 100.0),
                         .b = draw.chance(0.3) ? 0.0 : draw.decades(1e-8, 100.0),
                         .tau_c = draw.chance(0.5) ? 0.0 : draw.decades(1e-3, 30.0),
                         .volume_fraction = draw.between(0.4, 0.65),
                         .inclination = draw.between(0.0, 1.0)};
  if (draw.chance(0.1)) {
    law.a = 0.0;
    law.b = draw.decades(1e-4, 10.0);
  }
  return law;
}

inline RheologyTable random_table(Draw& draw) {
  RheologyTable table;
  if (draw.chance(0.75))
    table.law = random_mu_phi(draw);
  else
    table.law = random_bagnold(draw);
  if (draw.chance(0.3))
    table.base = EffectiveBase{.no_slip_height = draw.between(0.0, 2.0),
                               .mass_below = draw.between(0.0, 0.3),
                               .recipe = {}};
  return table;
}

inline ChuteCase random_chute(Draw& draw) {
  ChuteCase chute{.inclination = draw.between(-60.0, 60.0) * degree,
                  .mass_per_area = draw.decades(0.5, 1e4)};
  if (draw.chance(0.5)) chute.grains.stiffness = draw.decades(10.0, 1e9);
  if (draw.chance(0.4)) chute.grains.adhesion = draw.decades(1e-6, 1e2);
  if (draw.chance(0.2))
    chute.walls = SideWalls{.width = draw.decades(2.0, 1e3),
                            .friction = draw.between(0.01, 0.6),
                            .pressure_ratio = draw.between(0.5, 1.2)};
  if (draw.chance(0.2)) chute.slip_length = draw.decades(1e-2, 10.0);
  return chute;
}

/// Finite numbers, phi positive, and beyond the closest packing only with a flag.
inline bool in_physics(const Profile& profile, const Answer& answer) {
  const bool flagged = std::ranges::any_of(
      answer.out_of_domain, [](const RangeFlag& flag) { return flag.quantity == "phi"; });
  return std::ranges::all_of(profile.rows, [&](const ProfileRow& row) {
    return std::isfinite(row.velocity) && std::isfinite(row.shear_rate) && std::isfinite(row.z) &&
           row.volume_fraction > 0.0 &&
           (row.volume_fraction < 1.0 || flagged || row.shear_rate == 0.0);
  });
}

/// The same in time, which costs a thousand times more: few cells, few time units.
inline void expect_typed_in_time(std::uint64_t seed, int cases) {
  Draw draw(seed);
  for (int number = 0; number < cases; ++number) {
    const RheologyTable table = random_table(draw);
    const ChuteCase chute = random_chute(draw);
    ASSERT_NO_THROW({
      const auto run = start_from_rest(
          table, chute, {.cells = 20, .relative_tolerance = 1e-3, .time_limit = 20});
      EXPECT_FALSE(run.answer.text.empty()) << "case " << number;
      EXPECT_TRUE(in_physics(run.final_profile, run.answer))
          << "case " << number << ": " << run.answer.text;
    }) << "case "
       << number;
  }
}

}  // namespace grainlaw::continuum
