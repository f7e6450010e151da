#include "calibration/bagnold_fit.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <sstream>

#include "calibration/bagnold_solve.h"
#include "calibration/observations.h"
#include "dem/statistics.h"

namespace grainlaw::calibration {
namespace {

namespace slot = bagnold_slot;
using dem::LocalRow;

constexpr double most_chance = 0.05;  // that a term is kept by

/// Residuals far beyond their errors mean a law that is not this one, which no scatter of the data
/// can show in the errors of its coefficients.
void note_misfit(FitSummary& summary) {
  const double rms = std::sqrt(summary.chi_squared / summary.data);
  if (rms <= 2.0) return;
  std::ostringstream text;
  text.precision(2);
  text << "the residuals are " << rms
       << " standard errors on average: the law does not follow the profile to within its scatter; "
          "the errors of the coefficients hold the scatter only";
  summary.notes.push_back(text.str());
}

std::vector<std::string> names_of(const SolvedBagnold& solved) {
  const std::array<std::string, slot::count> all{"a", "b", "tau_c", "mass_below"};
  std::vector<std::string> names;
  for (std::size_t j = 0; j < slot::count; ++j) {
    if (solved.form.free[j]) names.push_back(all[j]);
  }
  return names;
}

void add_intervals(const SolvedBagnold& solved, FitSummary& summary) {
  const double half = interval_half_width(solved.blocks > 1, solved.blocks - 1);
  for (FittedCoefficient& c : summary.coefficients) {
    c.interval = {.lower = std::max(0.0, c.value - half * c.error),
                  .upper = c.value + half * c.error};
  }
}

FitSummary summarise(const SolvedBagnold& solved,
                     const std::vector<std::string>& names,
                     const std::vector<std::string>& left_out) {
  FitSummary summary = describe(names, solved.minimum, solved.uncertainty);
  summary.left_out = left_out;
  if (solved.blocks == 0) {
    summary.notes.emplace_back(
        "the run has no frames to form blocks from: errors take all rows as independent and are "
        "too small");
  }
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (!solved.minimum.at_bound[j]) continue;
    summary.notes.push_back(names[j] +
                            " is held at its bound, the free optimum lies beyond; its error is "
                            "one-sided");
  }
  note_misfit(summary);
  add_intervals(solved, summary);
  return summary;
}

/// Replaces the mass below the no-slip height, the last unknown, by what a table states: the height
/// [d] and the mass [rho_p d]. Both follow from one measured number, d height / d mass = 1 / rho
/// there.
void express_base(const dem::LocalData& run, SolvedBagnold& solved) {
  const dem::ChuteConditions& grains = run.conditions;
  const MassColumn column(run.rows, grains.grain_density);
  const double above = grains.mass_per_area - solved.minimum.values.back();
  const double step = 1e-3 * grains.grain_density * grains.grain_diameter;  // well inside one bin
  const double height_per_mass =
      (column.height(above - step) - column.height(above + step)) / (2.0 * step);
  const double mass_unit = grains.grain_density * grains.grain_diameter;
  const int last = static_cast<int>(solved.minimum.values.size()) - 1;
  std::vector<double> factor(static_cast<std::size_t>(last), 1.0);
  factor.insert(factor.end(), {height_per_mass / grains.grain_diameter, 1.0 / mass_unit});
  Matrix covariance(last + 2, last + 2);
  for (int i = 0; i < last + 2; ++i) {
    for (int j = 0; j < last + 2; ++j) {
      covariance(i, j) = factor[static_cast<std::size_t>(i)] * factor[static_cast<std::size_t>(j)] *
                         solved.uncertainty.covariance(std::min(i, last), std::min(j, last));
    }
  }
  solved.uncertainty.covariance = covariance;
  solved.uncertainty.identifiable.push_back(solved.uncertainty.identifiable.back());
  solved.minimum.at_bound.push_back(solved.minimum.at_bound.back());
  const double mass_below = solved.minimum.values.back() / mass_unit;
  solved.minimum.values.back() = std::max(0.0, column.height(above) / grains.grain_diameter);
  solved.minimum.values.push_back(mass_below);
}

std::vector<std::string> table_names(const SolvedBagnold& solved) {
  std::vector<std::string> names = names_of(solved);
  if (solved.form.free[slot::mass_below]) {
    names.insert(names.end() - 1, "no_slip_height");
  }
  return names;
}

continuum::RheologyTable make_table(const dem::LocalData& run,
                                    const Observations& observations,
                                    const SolvedBagnold& solved,
                                    const std::vector<std::string>& names) {
  const std::vector<double>& x = solved.minimum.values;
  continuum::RheologyTable table;
  table.law = continuum::GeneralisedBagnold{.a = solved.values[slot::a],
                                            .b = solved.values[slot::b],
                                            .tau_c = solved.values[slot::tau_c],
                                            .volume_fraction = observations.bulk_volume_fraction,
                                            .inclination = run.conditions.inclination};
  table.contact_friction = run.conditions.contact_friction;
  table.base = continuum::EffectiveBase{
      .no_slip_height = x[x.size() - 2], .mass_below = x.back(), .recipe = run.conditions.base};
  if (solved.uncertainty.null_space.empty()) {
    table.covariance = continuum::Covariance{names, solved.uncertainty.covariance.values};
  }
  table.range.inertial_number = range(run, observations, &LocalRow::inertial_number);
  table.range.softness = range(run, observations, &LocalRow::softness);
  table.provenance = {.source = "grainlaw, generalised Bagnold fit to one run",
                      .data = {run.name},
                      .checked_against = {}};
  return table;
}

/// Everything the fits of one run share.
struct Task {
  const dem::LocalData& run;
  BagnoldInput input;
  bool yields = false;  ///< tau_c is an unknown
  std::vector<std::string> left_out;

  BagnoldForm form(bool profile, bool pairs, bool free_base) const {
    BagnoldForm result{.profile = profile, .pairs = pairs};
    result.free[slot::tau_c] = yields;
    result.free[slot::mass_below] = free_base;
    result.fixed[slot::mass_below] = input.mass_below_base;
    return result;
  }
};

BagnoldVariant variant(const Task& task, bool profile, bool pairs, bool free_base) {
  SolvedBagnold solved = solve_bagnold(task.input, task.form(profile, pairs, free_base));
  BagnoldVariant result;
  result.data = profile ? (pairs ? "profile and pairs" : "profile") : "pairs";
  result.free_base = free_base;
  for (const double share : {0.25, 0.5, 0.75}) {
    result.ratios.push_back(stress_ratio(solved, task.input, share));
  }
  if (free_base) express_base(task.run, solved);
  result.summary = summarise(solved, table_names(solved), task.left_out);
  return result;
}

std::vector<BagnoldVariant> all_variants(const Task& task) {
  return {variant(task, true, true, true),
          variant(task, true, true, false),
          variant(task, true, false, true),
          variant(task, true, false, false),
          variant(task, false, true, false)};
}

ModelScore score(const std::string& name, const Minimum& minimum, double independent) {
  const double share = independent / static_cast<double>(minimum.residuals.size());
  ModelScore result{.name = name, .coefficients = static_cast<int>(minimum.values.size())};
  result.chi_squared =
      minimum.converged ? minimum.chi_squared * share : std::numeric_limits<double>::infinity();
  result.aicc =
      corrected_akaike(result.chi_squared, static_cast<int>(independent), result.coefficients);
  return result;
}

/// Linear, Bagnold and generalised law with the weights of the last.
std::vector<ModelScore> compare_models(const Task& task, const SolvedBagnold& generalised) {
  std::vector<ModelScore> scores;
  for (const std::size_t absent : {slot::a, slot::b}) {
    BagnoldForm form = generalised.form;
    form.free[absent] = false;
    scores.push_back(score(absent == slot::a ? "linear" : "Bagnold",
                           solve_bagnold_weighted(task.input, form, generalised),
                           generalised.independent_data));
  }
  scores.push_back(score("generalised", generalised.minimum, generalised.independent_data));
  return scores;
}

/// Wald's F test: (value / error)^2 with the degrees of freedom of the blocks the error comes from.
/// Right for correlated rows, where a comparison of chi^2 is not.
double chance_of_coefficient(const SolvedBagnold& solved, std::size_t which) {
  const int k = solved.unknown(which);
  if (k < 0 || solved.minimum.at_bound[static_cast<std::size_t>(k)]) return 1.0;
  const double variance = solved.uncertainty.covariance(k, k);
  constexpr double very_many = 1e6;
  const double freedom = solved.blocks > 1 ? solved.blocks - 1.0 : very_many;
  return f_survival(solved.values[which] * solved.values[which] / variance, 1.0, freedom);
}

/// The simplest law whose missing term is not measured; said in words.
void choose_model(const SolvedBagnold& generalised,
                  std::vector<ModelScore>& models,
                  FitSummary& summary) {
  const double chance_a = chance_of_coefficient(generalised, slot::a);
  const double chance_b = chance_of_coefficient(generalised, slot::b);
  std::size_t chosen = 2;
  if (chance_b > most_chance && chance_b >= chance_a) chosen = 1;
  if (chance_a > most_chance && chance_a > chance_b) chosen = 0;
  models[chosen].chosen = true;
  std::ostringstream text;
  text.precision(2);
  text << "simplest law the data ask for: " << models[chosen].name
       << " (probability that the term is chance: a gd^2: " << chance_a << ", b gd: " << chance_b
       << ")";
  summary.notes.push_back(text.str());
}

/// True where tau_c is more than chance.
bool yield_is_measured(Task& task) {
  task.yields = true;
  const SolvedBagnold solved = solve_bagnold(task.input, task.form(true, true, true));
  task.yields =
      solved.minimum.converged && chance_of_coefficient(solved, slot::tau_c) <= most_chance;
  return task.yields;
}

/// Looks for the plug and lets tau_c be fitted where there is one and it is measured.
void consider_yield(const BagnoldOptions& options,
                    Observations& observations,
                    Task& task,
                    BagnoldFit& fit) {
  if (!options.cohesive) {
    task.left_out.emplace_back("tau_c: the grains have no cohesion");
    return;
  }
  fit.plug = find_plug(task.run, observations);
  if (!fit.plug) {
    task.left_out.emplace_back("tau_c: no plug of 3 d or more moves without shear at the top");
    return;
  }
  Observations sheared = observations;
  leave_out_plug(task.run, *fit.plug, sheared);
  const Task without_yield = task;
  task.input = prepare(task.run, sheared);
  if (!yield_is_measured(task)) {
    task.input = without_yield.input;
    task.left_out.emplace_back("tau_c: the data give none that is more than chance (F test, 5 %)");
    fit.plug.reset();
    return;
  }
  observations = sheared;
  task.left_out = sheared.left_out;
}

std::optional<dem::Estimate> cohesion_of(const BagnoldFit& fit,
                                         const BagnoldOptions& options,
                                         double inclination) {
  const bool knows = options.mu0 && *options.mu0 < std::tan(inclination) && fit.plug;
  if (!knows) return std::nullopt;
  const FittedCoefficient& tau_c = fit.summary["tau_c"];
  return material_cohesion({.value = tau_c.value, .error = tau_c.error}, inclination, *options.mu0);
}

dem::Estimate middle(const BagnoldVariant& variant) {
  return {variant.ratios[1].value, variant.ratios[1].error};
}

}  // namespace

dem::Estimate material_cohesion(const dem::Estimate& tau_c, double inclination, double mu0) {
  const double share = (std::tan(inclination) - mu0) / std::tan(inclination);
  return {share * tau_c.value, share * tau_c.error};
}

BagnoldFit fit_bagnold(const dem::LocalData& data, const BagnoldOptions& options) {
  const auto clock = std::chrono::steady_clock::now();
  BagnoldFit fit;
  Observations observations = select_rows(data, options.rows);
  Task task{.run = data, .input = prepare(data, observations), .left_out = observations.left_out};
  consider_yield(options, observations, task, fit);

  SolvedBagnold free = solve_bagnold(task.input, task.form(true, true, true));
  require_converged(free.minimum, data.name);
  fit.variants = all_variants(task);
  fit.summary = fit.variants[0].summary;
  fit.fixed_base_summary = fit.variants[1].summary;
  if (!fit.fixed_base_summary.converged) {
    throw FitError("the fit of " + data.name + " with u = 0 at the base top did not converge: " +
                   fit.fixed_base_summary.termination);
  }
  fit.ratio_mid_depth = middle(fit.variants[0]);
  fit.ratio_mid_depth_fixed = middle(fit.variants[1]);
  fit.models = compare_models(task, free);
  choose_model(free, fit.models, fit.summary);
  fit.cohesion = cohesion_of(fit, options, data.conditions.inclination);
  express_base(data, free);
  fit.table = make_table(data, observations, free, table_names(free));
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - clock;
  fit.summary.wall_seconds = elapsed.count();
  return fit;
}

}  // namespace grainlaw::calibration
