// Laws from simple to complex, each fitted to what the runs of a study can tell.
#include "apps/study_laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/compare_flows.h"
#include "apps/io/import.h"
#include "calibration/bagnold_fit.h"
#include "calibration/material_fit.h"
#include "calibration/mu_phi_fit.h"

namespace grainlaw::study {
namespace {

using continuum::RheologyTable;
using Data = LawData;

io::RunRecord read_steady(const std::filesystem::path& path) {
  io::RunRecord record = io::read_run(path);
  if (!record.data.window.steady) {
    throw io::InputError(path.string() + ": is not steady: " + record.data.window.reason);
  }
  return record;
}

void add_fitted(Data& data, const std::filesystem::path& path) {
  io::RunRecord run = read_steady(path);
  const std::string& geometry = run.data.conditions.geometry;
  if (is_chute(run.data)) return data.chutes.push_back(std::move(run.data));
  if (geometry == "simple_shear") return data.boxes.push_back(std::move(run.data));
  if (is_band(run.data)) return data.bands.push_back(std::move(run));
  throw io::InputError(path.string() + ": a " + geometry +
                       "; laws are fitted to chutes, simple shear and shear bands");
}

/// Those that were fitted; the mass below the no-slip height follows from the height.
int fitted_coefficients(const RheologyTable& table) {
  const auto names = table.covariance ? table.covariance->names : coefficient_names(table);
  return static_cast<int>(names.size() - std::ranges::count(names, "mass_below"));
}

FittedLaw one_for_all(RheologyTable table) {
  const int coefficients = fitted_coefficients(table);
  const auto shared = std::make_shared<RheologyTable>(std::move(table));
  return {[shared](const dem::ChuteConditions&) -> const RheologyTable& { return *shared; },
          coefficients};
}

/// Closure A belongs to a tilt: that of the nearest fitted run is used.
template <class Fit>
FittedLaw one_per_tilt(const Data& data, int coefficients, const Fit& fit) {
  if (data.chutes.empty()) throw calibration::FitError("it belongs to a tilt: no chute is fitted");
  const auto tables = std::make_shared<std::vector<std::pair<double, RheologyTable>>>();
  for (const dem::LocalData& run : data.chutes) {
    tables->emplace_back(run.conditions.inclination, fit(run));
  }
  return {[tables](const dem::ChuteConditions& chute) -> const RheologyTable& {
            return std::ranges::min_element(
                       *tables,
                       {},
                       [&](const auto& table) { return std::abs(table.first - chute.inclination); })
                ->second;
          },
          coefficients* static_cast<int>(data.chutes.size()),
          true};
}

/// tau = a gd^2 with mu = tau/p and I = gd d sqrt(rho_p/p) of the run: a = mu rho_p d^2 / I^2.
RheologyTable bagnold_table(const dem::LocalData& run) {
  const calibration::FlowPoint point = calibration::flow_point(run);
  const double I = point.inertial_number.value;
  RheologyTable table;
  table.law =
      continuum::GeneralisedBagnold{.a = point.friction.value * run.conditions.grain_density *
                                         std::pow(run.conditions.grain_diameter / I, 2),
                                    .volume_fraction = point.volume_fraction.value,
                                    .inclination = run.conditions.inclination};
  table.base = calibration::effective_base(point);
  return table;
}

RheologyTable generalised_table(const dem::LocalData& run) {
  return calibration::fit_bagnold(run, {.cohesive = run.conditions.attraction > 0.0}).table;
}

calibration::StatePoint chute_state(const dem::LocalData& run) {
  const calibration::FlowPoint point = calibration::flow_point(run);
  const dem::ChuteConditions& grains = run.conditions;
  const double softness = 0.5 * (point.softness_lower + point.softness_upper);
  calibration::StatePoint state;
  state.name = run.name;
  state.inertial_number = point.inertial_number;
  state.friction = calibration::friction_for_fit(point);
  if (!(state.friction.error > 0.0)) state.friction.error = point.friction.error;
  state.volume_fraction = point.volume_fraction;
  state.softness = {softness, 0.0};
  // Bo = f_a / (p d^2) at the p of that softness, p* = p d / k_n.
  state.bond_number = {
      softness > 0.0 ? grains.attraction / (softness * grains.stiffness * grains.grain_diameter)
                     : 0.0,
      0.0};
  return state;
}

calibration::StatePoint box_state(const dem::LocalData& run) {
  const dem::LocalRow& row = run.rows.front();
  const dem::ChuteConditions& grains = run.conditions;
  calibration::StatePoint state;
  state.name = run.name;
  state.inertial_number = row.inertial_number;
  state.friction = row.friction;
  state.volume_fraction = row.volume_fraction;
  state.softness = row.softness;
  const double d = grains.grain_diameter;
  state.bond_number = {grains.attraction / (row.normal_stress.value * d * d), 0.0};
  return state;
}

/// Which variables beside I a law may depend on.
struct Terms {
  bool softness = false;
  bool cohesion = false;
};

std::vector<calibration::StatePoint> states_of(const Data& data, Terms terms) {
  std::vector<calibration::StatePoint> states;
  for (const dem::LocalData& run : data.chutes) states.push_back(chute_state(run));
  for (const dem::LocalData& run : data.boxes) states.push_back(box_state(run));
  for (calibration::StatePoint& state : states) {
    if (!terms.softness) state.softness = {0.0, 0.0};
    if (!terms.cohesion) state.bond_number = {0.0, 0.0};
  }
  return states;
}

void require_told(const continuum::MuPhi& law, Terms terms) {
  const bool told = terms.cohesion   ? law.cohesion_friction || law.cohesion_stress
                    : terms.softness ? law.softness_friction.has_value()
                                     : true;
  if (told) return;
  throw calibration::FitError(
      fmt::format("the runs do not tell a term in {} from none", terms.cohesion ? "Bo" : "p*"));
}

/// mu(I, p*) or mu(I, p*, Bo), where the runs can tell these terms. Of chutes the base is known.
RheologyTable material_table(const Data& data, Terms terms) {
  const dem::LocalData& grains = data.chutes.empty() ? data.boxes.front() : data.chutes.front();
  const auto fit =
      calibration::fit_material(states_of(data, terms),
                                {.range = {},
                                 .contact_friction = grains.conditions.contact_friction,
                                 .cohesion = terms.cohesion ? "largest attraction" : ""});
  require_told(std::get<continuum::MuPhi>(fit.table.law), terms);
  RheologyTable table = fit.table;
  if (!data.chutes.empty()) table.base = calibration::fit_mu_phi(data.chutes).table.base;
  return table;
}

RheologyTable inertial_table(const Data& data) {
  if (data.chutes.empty()) return material_table(data, {});
  return calibration::fit_mu_phi(data.chutes).table;
}

/// mu(I, p*), or mu(I) where the runs do not tell more.
RheologyTable local_table(const Data& data) {
  try {
    return material_table(data, {.softness = true});
  } catch (const calibration::FitError&) {
    return inertial_table(data);
  }
}

FittedLaw nonlocal_law(const Data& data) {
  if (data.bands.empty()) {
    throw calibration::FitError("its amplitude needs a shear band among the fitted runs");
  }
  const RheologyTable table = local_table(data);
  const double amplitude = fit_nonlocal(data.bands.front(), table).value;
  FittedLaw law = one_for_all(table);
  ++law.coefficients;
  law.nonlocal = amplitude;
  return law;
}

}  // namespace

bool is_chute(const dem::LocalData& data) {
  return data.conditions.geometry == "chute";
}

LawData read_law_data(const io::LawStudy& study) {
  Data data;
  for (const auto& path : study.fitted) add_fitted(data, path);
  for (const auto& path : study.predicted) {
    data.predicted.push_back(read_steady(path));
    const dem::LocalData& run = data.predicted.back().data;
    if (!is_chute(run) && !is_band(run)) {
      throw io::InputError(path.string() +
                           ": is neither chute nor shear band, which is what is predicted");
    }
  }
  if (data.chutes.empty() && data.boxes.empty()) {
    throw io::InputError("the fitted runs have neither a chute nor a simple shear to fit a law to");
  }
  return data;
}

std::vector<Law> laws() {
  constexpr Terms soft{.softness = true, .cohesion = false};
  constexpr Terms cohesive{.softness = true, .cohesion = true};
  return {{"Bagnold", [](const Data& data) { return one_per_tilt(data, 2, bagnold_table); }},
          {"generalised Bagnold",
           [](const Data& data) { return one_per_tilt(data, 3, generalised_table); }},
          {"mu(I)", [](const Data& data) { return one_for_all(inertial_table(data)); }},
          {"mu(I) + p*", [](const Data& data) { return one_for_all(material_table(data, soft)); }},
          {"mu(I) + p* + Bo",
           [](const Data& data) { return one_for_all(material_table(data, cohesive)); }},
          {"nonlocal", nonlocal_law}};
}

}  // namespace grainlaw::study
