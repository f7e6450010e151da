// Are the time scales of Shi et al. and the numbers made of them what the paper says?
#include "dem/time_scales.h"

#include <gtest/gtest.h>

namespace grainlaw::dem {
namespace {

/// A shear box of Shi et al. 2020, in m, kg, s: grains of 2 mm, 2000 kg/m^3, k_n = 100 N/m; the
/// third set at Bo = 1. Shear rates in the paper are per millisecond.
const FlowPoint box{.grain_density = 2000.0,
                    .diameter = 2e-3,
                    .stiffness = 100.0,
                    .attraction = 2e-3,
                    .gravity = 9.81,
                    .shear_rate = 5.0,
                    .pressure = 500.0,
                    .temperature = 1e-4};

TEST(TimeScales, OfShiEtAlAreThoseOfTheirGrains) {
  EXPECT_NEAR(time_scales(box).contact, 0.4000e-3, 1e-10);
  FlowPoint larger = box;
  larger.diameter = 2.2e-3;
  EXPECT_NEAR(time_scales(larger).contact, 0.4615e-3, 5e-8);
  EXPECT_NEAR(time_scales(box).gravity, std::sqrt(2e-3 / 9.81), 1e-15);
}

TEST(TimeScales, GiveTheNumbersByTheirRatios) {
  const DimensionlessNumbers n = dimensionless_numbers(time_scales(box));
  EXPECT_NEAR(n.inertial_number, 0.02, 1e-12);
  EXPECT_NEAR(n.softness, 0.01, 1e-12);
  EXPECT_NEAR(n.bond_number, 1.0, 1e-12);
  EXPECT_NEAR(n.temperature, 2000.0 * 1e-4 / 500.0, 1e-16);
}

TEST(TimeScales, OfAMechanismThatIsAbsentAreInfinite) {
  FlowPoint dry = box;
  dry.attraction = 0.0;
  dry.gravity = 0.0;
  const TimeScales t = time_scales(dry);
  EXPECT_TRUE(std::isinf(t.cohesion) && std::isinf(t.gravity));
  EXPECT_EQ(dimensionless_numbers(t).bond_number, 0.0);
}

TEST(InertialNumbers, OfOtherDefinitionsAreConvertedThereAndBack) {
  using enum InertialNumber;
  // The constant 0.85 of earlier work, by strain rate and bulk density, is 2.109 at phi = 0.65.
  EXPECT_NEAR(converted(0.85, strain_bulk, shear_grain, 0.65), 2.109, 5e-4);
  for (const auto from : {shear_grain, shear_bulk, strain_grain, strain_bulk}) {
    for (const auto to : {shear_grain, shear_bulk, strain_grain, strain_bulk}) {
      EXPECT_NEAR(converted(converted(0.3, from, to, 0.6), to, from, 0.6), 0.3, 1e-16);
    }
  }
  EXPECT_NEAR(conversion(shear_bulk, 0.64), 0.8, 1e-15);
  EXPECT_NEAR(conversion(strain_grain, 0.64), 0.5, 1e-15);
}

}  // namespace
}  // namespace grainlaw::dem
