#include "tests/apps/report/synthetic_report.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace grainlaw::test {
namespace {

using calibration::SampleKind;

constexpr double rho_p = 6.0 / std::numbers::pi;  // unit mass, unit diameter
constexpr double depth = 30.0;
constexpr double no_slip_height = 1.2;
constexpr double stiffness = 2e5;
constexpr double relaxation_time = 60.0;
constexpr double frame_length = 10.0;

/// The grains of this report follow mu = 0.36 + 0.62 I and phi = 0.6 (1 - I / 3) exactly; the law
/// "fitted" to them is a little off, as a fit is.
struct Law {
  double mu0, beta, phi0, I_phi;
};
constexpr Law truth{0.36, 0.62, 0.60, 3.0};
constexpr Law fitted{0.362, 0.60, 0.601, 2.9};

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}
double inertial_number(const Law& law, double tilt) {
  return (std::tan(tilt) - law.mu0) / law.beta;
}
double volume_fraction(const Law& law, double tilt) {
  return law.phi0 * (1.0 - inertial_number(law, tilt) / law.I_phi);
}

/// Bagnold profile with u = 0 at the no-slip height: u = (2/3) I sqrt(phi cos) (h^1.5 - y^1.5).
double velocity(const Law& law, double tilt, double z) {
  if (z <= no_slip_height) return 0.0;
  const double scale = std::sqrt(volume_fraction(law, tilt) * std::cos(tilt));
  return 2.0 / 3.0 * inertial_number(law, tilt) * scale *
         (std::pow(depth - no_slip_height, 1.5) - std::pow(std::max(0.0, depth - z), 1.5));
}

double started(double time) {
  return 1.0 - std::exp(-time / relaxation_time);
}

class Noise {
 public:
  explicit Noise(unsigned seed) : generator_(seed) {}
  dem::Estimate operator()(double value, double error) {
    return {.value = value + error * normal_(generator_), .error = error};
  }

 private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
};

dem::LocalRow local_row(double tilt, double z, Noise& noise) {
  const double phi = volume_fraction(truth, tilt);
  const double pressure = rho_p * phi * std::cos(tilt) * (depth - z);
  const double I = inertial_number(truth, tilt);
  const double rate = z > no_slip_height ? I * std::sqrt(pressure / rho_p) : 0.0;
  dem::LocalRow row;
  row.z = z;
  row.mass_above = rho_p * phi * (depth - z);
  row.velocity = noise(velocity(truth, tilt, z), 0.01 + 0.01 * velocity(truth, tilt, z));
  row.shear_rate = noise(rate, 0.01);
  row.volume_fraction = noise(phi, 0.003);
  row.friction = noise(std::tan(tilt), 0.004);
  row.normal_stress = noise(pressure, 0.1);
  row.shear_stress = noise(pressure * std::tan(tilt), 0.05);
  row.temperature = noise(0.1, 0.005);
  row.inertial_number = noise(I, 0.01);
  row.softness = {.value = pressure / stiffness, .error = 1e-7};
  row.effective_samples = 40.0 - z;
  return row;
}

dem::ProfileFrame frame(double tilt, double begin, Noise& noise) {
  dem::ProfileFrame result;
  result.begin = begin;
  result.end = begin + frame_length;
  for (double z = 0.5; z < depth; z += 1.0) {
    dem::BinMoments bin;
    bin.mass = rho_p * volume_fraction(truth, tilt);
    const double u = velocity(truth, tilt, z) * started(begin + 0.5 * frame_length);
    bin.momentum[0] = bin.mass * noise(u, 0.02 * u).value;
    result.bins.push_back(bin);
  }
  return result;
}

dem::RunSummary run_summary() {
  dem::RunSummary summary;
  summary.time_step = 9.94e-5;
  summary.contact_time = 4.97e-3;
  summary.restitution = 0.8832;
  summary.steps = 6'035'000;
  summary.flowing_grains = 2250;
  summary.base_grains = 168;
  summary.wall_seconds = 412.0;
  summary.startup_wall_seconds = 160.0;
  summary.largest_overlap = 0.031;
  summary.deep_overlap_share = 0.0;
  summary.energy_residual = 4.1e-4;
  summary.coordination = 1.83;
  return summary;
}

dem::LocalData local_data(double degrees) {
  const double tilt = radians(degrees);
  Noise noise(static_cast<unsigned>(10.0 * degrees));
  dem::LocalData data;
  data.name = "chute-" + std::to_string(degrees).substr(0, 4);
  data.conditions = {.inclination = tilt,
                     .gravity = 1.0,
                     .grain_diameter = 1.0,
                     .grain_density = rho_p,
                     .stiffness = stiffness,
                     .contact_friction = 0.5,
                     .mass_per_area = rho_p * volume_fraction(truth, tilt) * depth,
                     .base = "bumpy, 1.5 d"};
  data.window = {.steady = true, .begin = 300.0, .end = 600.0, .reason = "no drift over 30 blocks"};
  for (double z = 0.5; z < depth; z += 1.0) data.rows.push_back(local_row(tilt, z, noise));
  data.frames.z_begin = 0.0;
  for (double t = 0.0; t < 600.0; t += frame_length) {
    data.frames.frames.push_back(frame(tilt, t, noise));
  }
  data.summary = run_summary();
  return data;
}

continuum::Profile predicted_profile(double tilt, double share) {
  continuum::Profile profile;
  for (int k = 0; k <= 100; ++k) {
    continuum::ProfileRow row;
    row.z = no_slip_height + (depth - no_slip_height) * k / 100.0;
    const double phi = volume_fraction(fitted, tilt);
    row.mass_above = rho_p * phi * (depth - row.z);
    row.pressure = std::cos(tilt) * row.mass_above;
    row.shear_stress = std::tan(tilt) * row.pressure;
    row.velocity = share * velocity(fitted, tilt, row.z);
    row.velocity_error = 0.025 * row.velocity;
    row.volume_fraction = phi;
    row.volume_fraction_error = 0.004;
    row.inertial_number = inertial_number(fitted, tilt);
    profile.rows.push_back(row);
  }
  profile.height = depth;
  profile.surface_velocity = profile.rows.back().velocity;
  return profile;
}

continuum::SteadyChute steady_answer(double tilt) {
  continuum::SteadyChute steady;
  steady.profile = predicted_profile(tilt, 1.0);
  steady.answer.outcome = continuum::Outcome::steady;
  steady.answer.text = "Steady flow; the friction asked for lies inside the law.";
  steady.answer.condition_number = std::tan(tilt) / (std::tan(tilt) - fitted.mu0);
  return steady;
}

void add_start(report::RunComparison& run) {
  const double tilt = run.data.conditions.inclination;
  continuum::TransientChute start;
  start.answer.outcome = continuum::Outcome::time_reached;
  start.statistics.steps = 1043;
  for (const dem::ProfileFrame& frame : run.data.frames.frames) {
    const double time = 0.5 * (frame.begin + frame.end);
    start.snapshots.push_back(
        {.time = time, .profile = predicted_profile(tilt, started(1.1 * time))});
  }
  run.in_time = calibration::compare_in_time(run.data, start);
  run.transient = std::move(start);
}

calibration::ProfileError profile_error(double size) {
  calibration::ProfileError error;
  error.velocity = {.value = size, .error = 0.0041};
  error.velocity_maximum = {.value = 1.4 * size, .error = 0.006};
  error.volume_fraction = {.value = 0.0062, .error = 0.0011};
  error.friction = {.value = 0.0085, .error = 0.0019};
  error.surface_velocity = {.value = -0.8 * size, .error = 0.005};
  error.flux = {.value = -0.7 * size, .error = 0.0047};
  error.in_standard_errors = 90.0 * size;
  return error;
}

calibration::FitSummary fit_summary(std::vector<calibration::FittedCoefficient> coefficients,
                                    std::vector<double> correlation) {
  calibration::FitSummary summary;
  summary.coefficients = std::move(coefficients);
  summary.correlation = std::move(correlation);
  summary.chi_squared = 3.4;
  summary.data = 6;
  summary.iterations = 7;
  summary.converged = true;
  summary.termination = "convergence";
  summary.wall_seconds = 0.004;
  return summary;
}

void add_bagnold(report::RunComparison& run) {
  const double tilt = run.data.conditions.inclination;
  const double a = rho_p * std::tan(tilt) / std::pow(inertial_number(truth, tilt), 2);
  calibration::BagnoldFit fit;
  fit.table.law = continuum::GeneralisedBagnold{.a = a, .b = 1.9};
  fit.summary = fit_summary({{"a", a, 0.05 * a}, {"b", 1.9, 1.1}, {"no_slip_height", 1.21, 0.06}},
                            {1.0, -0.93, 0.5, -0.93, 1.0, -0.4, 0.5, -0.4, 1.0});
  fit.fixed_base_summary =
      fit_summary({{"a", 1.2 * a, 0.03 * a}, {"b", 0.0, 0.4, true}}, {1.0, -0.9, -0.9, 1.0});
  fit.ratio_mid_depth = {.value = 0.093, .error = 0.099};
  fit.ratio_mid_depth_fixed = {.value = 0.0, .error = 0.02};
  run.own_bagnold = fit;
  run.own_bagnold_error = profile_error(0.012);
  run.foreign_bagnold_error = profile_error(0.31);
  run.foreign_bagnold_source = "chute-23.0";
}

calibration::FlowPoint flow_point(const dem::LocalData& data) {
  const double tilt = data.conditions.inclination;
  Noise noise(static_cast<unsigned>(1000.0 * tilt));
  calibration::FlowPoint point;
  point.name = data.name;
  point.inclination = tilt;
  point.friction = noise(std::tan(tilt), 0.001);
  point.inertial_number = noise(inertial_number(truth, tilt), 0.004);
  point.volume_fraction = noise(volume_fraction(truth, tilt), 0.0015);
  point.no_slip_height = noise(no_slip_height, 0.05);
  point.mass_below = noise(1.3, 0.06);
  point.softness_lower = 2e-5;
  point.softness_upper = 1.4e-4;
  return point;
}

report::RunComparison comparison(double degrees, SampleKind kind, double error) {
  report::RunComparison run;
  run.data = local_data(degrees);
  run.kind = kind;
  run.steady = steady_answer(radians(degrees));
  run.error = profile_error(error);
  run.point = flow_point(run.data);
  run.steady_against_transient = 3.1e-6;
  run.predict_seconds = 0.083;
  if (kind != SampleKind::in_sample) {
    run.naive_error = profile_error(3.0 * error);
    run.naive_source = "chute-23.0";
  }
  add_start(run);
  add_bagnold(run);
  return run;
}

report::RunComparison run_without_steady_flow() {
  report::RunComparison run;
  run.data = local_data(38.0);
  run.data.window = {.steady = false, .begin = 0, .end = 0, .reason = "still gaining speed"};
  run.data.rows.clear();
  run.kind = SampleKind::extrapolation;
  run.steady.answer.outcome = continuum::Outcome::no_steady;
  run.steady.answer.text = "No steady flow: tan(theta) = 0.78 exceeds the largest friction 0.66.";
  return run;
}

calibration::MuPhiFit mu_phi_fit(const std::vector<report::RunComparison>& runs) {
  calibration::MuPhiFit fit;
  continuum::MuPhi law;
  law.friction = {.mu0 = fitted.mu0, .beta = fitted.beta, .kappa = 0.0};
  law.volume_fraction = {.phi0 = fitted.phi0, .I_phi = fitted.I_phi};
  fit.table.law = law;
  fit.table.base =
      continuum::EffectiveBase{.no_slip_height = 1.2, .mass_below = 1.31, .recipe = "bumpy, 1.5 d"};
  fit.table.covariance = continuum::Covariance{
      .names = {"mu0", "beta", "phi0", "I_phi"},
      .matrix = {4.4e-6, -1.6e-5, 0, 0, -1.6e-5, 9e-5, 0, 0, 0, 0, 1e-6, -1e-4, 0, 0, -1e-4, 0.02}};
  fit.table.range.inertial_number = continuum::Range{.lower = 0.041, .upper = 0.206};
  fit.table.provenance = {.source = "grainlaw 0.1.0", .data = {}, .checked_against = {}};
  fit.friction = fit_summary({{"mu0", fitted.mu0, 0.0021}, {"beta", fitted.beta, 0.0095}},
                             {1.0, -0.82, -0.82, 1.0});
  fit.friction.not_identifiable = {
      "kappa = 0.4 ± 0.9 is not distinguishable from 0: the linear law is used."};
  fit.volume_fraction = fit_summary({{"phi0", fitted.phi0, 0.001}, {"I_phi", fitted.I_phi, 0.14}},
                                    {1.0, -0.71, -0.71, 1.0});
  for (const report::RunComparison& run : runs) {
    if (run.kind == SampleKind::in_sample) fit.points.push_back(*run.point);
  }
  return fit;
}

std::vector<report::TimeErrorPoint> error_against_time(std::size_t runs) {
  std::vector<report::TimeErrorPoint> points;
  const std::array<double, 5> scatter = {0.8, -0.6, 0.9, 0.4, 0.0};
  for (std::size_t k = 0; k < scatter.size(); ++k) {
    const double time = 300.0 / std::pow(2.0, 4.0 - static_cast<double>(k));
    const double error = 0.02 * std::sqrt(300.0 / time);
    report::TimeErrorPoint point;
    point.averaging_time = time;
    point.dem_wall_seconds = 480.0 + 2.5 * time;
    point.mu0 = {.value = fitted.mu0 + 0.05 * error * scatter[k], .error = 0.1 * error};
    point.law_error = std::abs(scatter[k]) * error;
    point.law_standard_error = error;
    for (std::size_t run = 0; run < runs; ++run) {
      const bool steady = run + 1 < runs;
      point.profile_error.push_back(steady ? 0.01 + error * (0.5 + 0.2 * static_cast<double>(run))
                                           : NAN);
      point.profile_standard_error.push_back(steady ? 0.3 * error : NAN);
    }
    points.push_back(point);
  }
  points.front().failure = "chute-21.0 has 3 blocks, at least 4 are needed";
  return points;
}

}  // namespace

report::Report synthetic_report() {
  report::Report report;
  report.title = "Chute flow of frictional spheres";
  report.command = "grainlaw calibrate campaign.toml";
  report.machine = "2 cores, 2 threads";
  report.runs = {comparison(21.0, SampleKind::in_sample, 0.019),
                 comparison(23.0, SampleKind::in_sample, 0.011),
                 comparison(26.0, SampleKind::in_sample, 0.013),
                 comparison(24.8, SampleKind::interpolation, 0.0214),
                 comparison(27.5, SampleKind::extrapolation, 0.046),
                 run_without_steady_flow()};
  report.runs[4].steady.answer.out_of_domain = {{.quantity = "I",
                                                 .lower = 0.041,
                                                 .upper = 0.206,
                                                 .reached_lowest = 0.264,
                                                 .reached_highest = 0.264,
                                                 .fraction_outside = 1.0}};
  report.fit = mu_phi_fit(report.runs);
  report.table = report.fit->table;
  report.error_against_time = error_against_time(report.runs.size());
  report.costs = {{"DEM runs", 1240.0, 2470.0}, {"fit", 0.008, 0.0}, {"predictions", 0.42, 0.0}};
  return report;
}

}  // namespace grainlaw::test
