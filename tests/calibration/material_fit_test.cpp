#include "calibration/material_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/calibration_checks.h"
#include "support/synthetic_states.h"

namespace grainlaw::calibration {
namespace {

using testing::failure;
using testing::mentions;
using testing::StateGrid;
using testing::StateNoise;
using testing::states;

/// Rows of tables 3, 5 and 7 of Shi et al. 2020 for mu_p = 0, 0.01 and 0.5.
continuum::MuPhi published(double mu0,
                           double mu_inf,
                           double I_mu,
                           double p_mu,
                           double alpha,
                           double beta,
                           continuum::InertialVolumeFraction phi,
                           double p_phi,
                           continuum::CohesionVolumeFraction g_c) {
  continuum::MuPhi law;
  law.friction = {.mu0 = mu0, .beta = (mu_inf - mu0) / I_mu, .kappa = 1.0 / I_mu};
  law.softness_friction = continuum::SoftnessFriction{.p_mu = p_mu};
  law.cohesion_friction = continuum::CohesionFriction{.alpha = alpha, .beta = beta};
  law.volume_fraction = phi;
  law.softness_volume_fraction = continuum::SoftnessVolumeFraction{.p_phi = p_phi};
  law.cohesion_volume_fraction = g_c;
  return law;
}

const std::vector<continuum::MuPhi> published_laws{
    published(0.1432, 0.3281, 0.0645, 0.4222, 0.3136, 1.6475, {0.656, 1.960}, 0.271,
              {-0.0175, -0.0060, 0.0029, -0.0003}),
    published(0.1645, 0.3499, 0.0818, 0.4950, 0.4490, 1.5218, {0.653, 2.246}, 0.272,
              {-0.0237, -0.0056, 0.0034, -0.0004}),
    published(0.3530, 0.7148, 0.7184, 0.3905, 0.2551, 1.5125, {0.595, 5.383}, 0.287,
              {-0.1359, 0.0668, -0.0162, 0.0015})};
const continuum::MuPhi& frictional = published_laws[2];

/// The control grid of Shi et al. 2020, table 2, as far as both laws are claimed to hold.
const StateGrid grid{.inertial_numbers = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4},
                     .softnesses = {0.0025, 0.005, 0.01, 0.02},
                     .bond_numbers = {0, 0.1, 0.5, 1, 2, 3, 5}};
const StateGrid cohesionless{.inertial_numbers = grid.inertial_numbers,
                             .softnesses = grid.softnesses,
                             .bond_numbers = {0}};

const continuum::MuPhi& law_of(const MaterialFit& fit) {
  return std::get<continuum::MuPhi>(fit.table.law);
}

const FittedCoefficient& derived(const FitSummary& summary, const std::string& name) {
  for (const FittedCoefficient& c : summary.derived) {
    if (c.name == name) return c;
  }
  throw std::out_of_range(name);
}

TEST(MaterialFit, PublishedLawsComeBackFromExactStates) {
  for (const continuum::MuPhi& truth : published_laws) {
    const MaterialFit fit = fit_material(states(truth, grid));
    const continuum::MuPhi& law = law_of(fit);
    EXPECT_NEAR(law.friction.mu0, truth.friction.mu0, 1e-7);
    EXPECT_NEAR(law.friction.kappa, truth.friction.kappa, 1e-6 * truth.friction.kappa);
    ASSERT_TRUE(law.softness_friction && law.cohesion_friction);
    EXPECT_NEAR(law.softness_friction->p_mu, truth.softness_friction->p_mu, 1e-6);
    EXPECT_NEAR(law.cohesion_friction->alpha, truth.cohesion_friction->alpha, 1e-6);
    EXPECT_NEAR(law.cohesion_friction->beta, truth.cohesion_friction->beta, 1e-6);
    EXPECT_NEAR(law.volume_fraction.I_phi, truth.volume_fraction.I_phi, 1e-6);
    EXPECT_NEAR(law.softness_volume_fraction->p_phi, truth.softness_volume_fraction->p_phi, 1e-6);
    const continuum::Confinement strong{.softness = 0.06, .bond_number = 5.0};
    EXPECT_NEAR(continuum::volume_fraction(law, 0.1, strong),
                continuum::volume_fraction(truth, 0.1, strong),
                1e-7);
    EXPECT_NEAR(derived(fit.friction, "mu_inf").value,
                truth.friction.mu0 + truth.friction.beta / truth.friction.kappa,
                1e-6);
    EXPECT_NO_THROW(continuum::validate(fit.table));
  }
}

}  // namespace
}  // namespace grainlaw::calibration
