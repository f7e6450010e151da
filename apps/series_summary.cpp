#include "apps/series_summary.h"

#include <fmt/format.h>

#include <cmath>

namespace grainlaw {
namespace {

void add_law_line(Summary& summary,
                  const std::string& key,
                  const std::string& label,
                  const std::optional<calibration::RatioLaw>& law) {
  if (!law) return;
  summary.add_estimate(key + "_factor", label, law->factor.value, law->factor.error);
  summary.add_estimate(key + "_rate", "  exponent or rate", law->rate.value, law->rate.error);
}

void add_contact_lines(Summary& summary, const calibration::ContactSeries& contacts) {
  for (const calibration::StiffnessLaws& laws : contacts.stiffness) {
    add_law_line(summary, laws.series + "_Xi", laws.series + ": Xi at h/2 over k_n", laws.ratio[1]);
    add_law_line(summary, laws.series + "_Nc", laws.series + ": N_c over k_n", laws.collision_rate);
  }
  add_law_line(summary, "Xi_lifetime", "Xi over exp(gd tau_l)", contacts.lifetime_law);
  for (const calibration::RankCorrelation& one : contacts.correlations) {
    const std::string label = "rank correlation of Xi with " + one.with;
    if (std::isfinite(one.value)) {
      summary.add("rank_" + one.with, label, one.value);
    } else {
      summary.add("rank_" + one.with, label, std::string("none: too few runs, or all Xi alike"));
    }
  }
  if (!contacts.left_out.empty()) summary.add("left_out", "left out", contacts.left_out);
}

void add_cohesion_lines(Summary& summary, const calibration::CohesionSeries& cohesion) {
  if (cohesion.mu0) {
    summary.add_estimate("mu0", "mu0 without cohesion", cohesion.mu0->value, cohesion.mu0->error);
  }
  for (const calibration::CohesivePoint& point : cohesion.points) {
    summary.add_estimate("tau_c_" + point.name,
                         "tau_c of " + point.name,
                         point.yield_stress.value,
                         point.yield_stress.error,
                         "(stress-rate pairs)");
  }
  for (const calibration::PooledCohesion& one : cohesion.pooled) {
    summary.add_estimate(
        fmt::format("c0_{:.3g}_{}", one.attraction, one.series),
        fmt::format("c0 at f_a = {:.3g} m g, {}", one.attraction, one.series),
        one.cohesion.value,
        one.cohesion.error,
        one.tilts > 1 ? fmt::format("({} tilts, chance of one value {:.2g})", one.tilts, one.chance)
                      : "(one tilt)");
  }
  if (!cohesion.left_out.empty()) {
    summary.add("cohesion_left_out", "left out", cohesion.left_out);
  }
}

}  // namespace

void add_series_lines(Summary& summary, const report::SeriesReport& series) {
  add_contact_lines(summary, series.contacts);
  if (series.cohesion) add_cohesion_lines(summary, *series.cohesion);
}

}  // namespace grainlaw
