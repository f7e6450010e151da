// Uses each installed library once: a Bagnold chute must flow as its closed form says.
#include <calibration/mu_phi_fit.h>
#include <continuum/chute_1d.h>
#include <dem/run.h>

#include <cmath>
#include <cstdio>

using namespace grainlaw;

namespace {

double bagnold_surface_velocity() {
  continuum::RheologyTable table;
  table.law = continuum::GeneralisedBagnold{
      .a = 1.0, .b = 0.0, .tau_c = 0.0, .volume_fraction = 0.5, .inclination = 0.4};
  continuum::ChuteCase chute;
  chute.inclination = 0.4;
  chute.mass_per_area = 10.0;
  return continuum::steady_chute(table, chute).profile.surface_velocity;
}

bool scene_without_grains_is_refused() {
  try {
    dem::validate(dem::Scene{});
  } catch (const dem::SceneError&) {
    return true;
  }
  return false;
}

bool fit_without_runs_is_refused() {
  try {
    calibration::fit_mu_phi({});
  } catch (const calibration::FitError&) {
    return true;
  }
  return false;
}

}  // namespace

int main() {
  // u_s = (2/3) sqrt(c/a) h^1.5 with c = rho g sin(theta), rho = 0.5, h = 10 / 0.5
  const double expected = 2.0 / 3.0 * std::sqrt(0.5 * std::sin(0.4)) * std::pow(20.0, 1.5);
  const bool right = std::abs(bagnold_surface_velocity() / expected - 1.0) < 1e-12 &&
                     scene_without_grains_is_refused() && fit_without_runs_is_refused();
  std::puts(right ? "installed libraries work" : "installed libraries give wrong answers");
  return right ? 0 : 1;
}
