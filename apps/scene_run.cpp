#include "apps/scene_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/progress.h"
#include "dem/run.h"
#include "dem/statistics.h"

namespace grainlaw {
namespace {

/// The chute a scene is, if it is one.
const dem::Chute* chute_of(const dem::Scene& scene) {
  return std::get_if<dem::Chute>(&scene.geometry);
}

/// Working memory of the engine: the records of the grains and of their listed pairs, which exist
/// twice while grains are sorted and lists made anew; together about 1 kB a grain.
double memory_megabytes(const dem::Scene& scene) {
  constexpr double bytes_per_grain = 400.0;
  constexpr double bytes_per_pair = 120.0;
  constexpr double skin = 0.3;  // [d]
  const double reach = 1.0 + skin + dem::attraction_range(scene) / scene.grains.diameter;
  const double pairs_per_grain = 4.0 * dem::nominal_packing * reach * reach * reach;
  const double grains = dem::grains(scene) + dem::glued_grains(scene);
  return grains * (bytes_per_grain + bytes_per_pair * pairs_per_grain) / 1e6 + 1.0;
}

/// Time of one step; of a long chute it is measured on a part, as the whole takes long to pack.
double step_seconds(const dem::Scene& scene) {
  constexpr double enough_grains = 4000.0;
  const dem::Chute* const chute = chute_of(scene);
  if (chute == nullptr || !scene.start.empty()) return dem::measure_step_seconds(scene);
  const double shortest = dem::limits::least_period * scene.grains.largest();
  const double share =
      std::clamp(enough_grains / chute->grains, std::min(1.0, 1.2 * shortest / chute->length), 1.0);
  dem::Scene part = scene;
  auto& shorter = std::get<dem::Chute>(part.geometry);
  shorter.length *= share;
  shorter.grains = static_cast<int>(std::ceil(chute->grains * share));
  return dem::measure_step_seconds(part) * chute->grains / shorter.grains;
}

/// A few lines on the contacts of the narrowest and of the widest definition.
void add_lifetimes(const dem::LifetimeStatistics& lifetimes, Summary& summary) {
  constexpr std::size_t level = 1;  // P = 0.1
  if (lifetimes.distances.empty()) return;
  const dem::LifetimeDistribution& narrow = lifetimes.distances.front();
  const dem::LifetimeDistribution& wide = lifetimes.distances.back();
  if (wide.contacts + wide.unfinished + wide.unknown == 0.0) {
    summary.add("lifetime_warning",
                "warning",
                fmt::format("no contact begins in the slice z = {:.4g} to {:.4g} d: choose "
                            "slice_centre inside the layer",
                            lifetimes.slice_begin,
                            lifetimes.slice_end));
    return;
  }
  summary.add("contacts", "contacts followed", narrow.contacts);
  const auto add = [&](const char* key, const char* label, dem::Estimate x, const char* unit) {
    summary.add_estimate(key, label, x.value, x.error, unit);
  };
  add("mean_lifetime", "  mean lifetime", narrow.mean, "sqrt(d/g)");
  add("collision_rate", "  collisions per grain", narrow.collision_rate, "sqrt(g/d)");
  add("long_lifetime", "  long lifetime x shear rate", narrow.long_lifetime[level], "");
  add("long_shear", "  shear stress of long ones", narrow.long_shear, "of the contact stress");
  for (const dem::LifetimeDistribution& contacts : lifetimes.distances) {
    if (contacts.tail_sampled(level)) continue;
    summary.add("lifetime_warning",
                "warning",
                fmt::format("only {:.0f} contacts (d_c = {:.4g} d) outlive the long lifetime, "
                            "below {:.0f} it is a guess; a longer averaging_time would help",
                            contacts.beyond[level],
                            contacts.distance,
                            dem::LifetimeDistribution::enough_beyond));
    break;
  }
}

/// What the units of the lines are in those of the file.
std::string units_text(const io::Units& units) {
  const bool si = units.name == "si";
  return fmt::format(
      "these numbers are in m, d, g of the grains: m = {:.4g} {}, d = {:.4g} {}, sqrt(d/g) = "
      "{:.4g} {}",
      units.mass,
      si ? "kg" : "rho_p d^3",
      units.length,
      si ? "m" : "d",
      units.time,
      si ? "s" : "sqrt(rho_p d^3/k_n)");
}

}  // namespace

RunTime run_time(const dem::Scene& scene) {
  const dem::Measurement& wanted = scene.measurement;
  const double longest = wanted.time_limit / dem::time_step(scene) * step_seconds(scene);
  return {.least = std::min(longest, longest * wanted.averaging_time / wanted.time_limit),
          .most = longest};
}

Summary check_scene(const io::SceneFile& file, const RunTime& time) {
  const dem::Scene& scene = file.scene;
  const double shortest = dem::shortest_contact_time(scene);
  const double step = dem::time_step(scene);
  const dem::SceneSummary parts = dem::summarise(scene);
  Summary summary;
  summary.add("scene", "scene", scene.name);
  summary.add("uses", "uses", parts.used);
  summary.add("leaves_out", "leaves out", parts.left_out);
  if (file.units.name != io::grain_units().name)
    summary.add("units", "units", units_text(file.units));
  summary.add("geometry", "geometry", std::string(dem::kind(scene.geometry)));
  summary.add("grains", "flowing grains", static_cast<long>(dem::grains(scene)));
  if (const dem::Chute* const chute = chute_of(scene)) {
    summary.add(
        "mass_per_area", "mass per area", dem::mass_per_area(scene.grains, *chute), "m/d^2");
  }
  summary.add("shortest_contact_time", "shortest contact", shortest, "sqrt(d/g)");
  summary.add("time_step", "time step", step, "sqrt(d/g)");
  summary.add("time_step_reason",
              "  because",
              fmt::format("shortest contact time / {:.4g} ({})",
                          shortest / step,
                          scene.time_step > 0.0 ? "given in the scene" : "default"));
  summary.add(
      "time_step_limit", "  at most", shortest / dem::limits::least_steps_per_contact, "sqrt(d/g)");
  summary.add("memory", "memory, about", std::ceil(memory_megabytes(scene)), "MB");
  summary.add("run_time_shortest", "run time, at least", duration_text(time.least));
  summary.add("run_time_longest", "run time, at most", duration_text(time.most));
  return summary;
}

std::string outcome_line(const dem::LocalData& data) {
  return fmt::format("{}: {} after {}: {}",
                     data.name,
                     data.window.steady ? "steady" : "not steady",
                     duration_text(data.summary.wall_seconds),
                     data.window.reason);
}

std::optional<int> few_samples(const dem::LocalData& data) {
  double least = std::numeric_limits<double>::infinity();
  for (const dem::LocalRow& row : data.rows) least = std::min(least, row.effective_samples);
  const bool few = dem::convergence(least) == dem::Convergence::not_converged;
  if (!data.window.steady || !few) return std::nullopt;
  return static_cast<int>(std::lround(least));
}

const dem::FieldRow* row_at(const dem::WidthFields& fields, double z) {
  const double k = std::floor((z - fields.z_begin) / fields.row_width);
  const bool inside = k >= 0.0 && k < static_cast<double>(fields.values.size());
  return inside ? &fields.values[static_cast<std::size_t>(k)] : nullptr;
}

/// How far the numbers go over the rows of dense flow, by which laws are judged.
void add_ranges(Summary& summary, const dem::LocalData& data) {
  constexpr double dense = 0.5;  // volume fraction; looser is the saltating surface
  const auto add = [&](const char* key, const char* label, double dem::DimensionlessNumbers::*n) {
    double low = std::numeric_limits<double>::infinity();
    double high = 0.0;
    for (const dem::LocalRow& row : data.rows) {
      const double value = dem::dimensionless_numbers(data.conditions, row).*n;
      if (row.volume_fraction.value < dense || !std::isfinite(value) || value < 0.0) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (high > 0.0) summary.add(key, label, fmt::format("{:.3g} to {:.3g}", low, high));
  };
  add("inertial_number_range", "I where dense", &dem::DimensionlessNumbers::inertial_number);
  add("softness_range", "p* where dense", &dem::DimensionlessNumbers::softness);
  add("bond_number_range", "Bo where dense", &dem::DimensionlessNumbers::bond_number);
}

/// What half and twice the width of the kernel make of a row.
void add_width_dependence(Summary& summary, const dem::LocalData& data, double z) {
  if (data.fields.size() != 3) return;  // a homogeneous box has no kernel
  const dem::Kernel& kernel = data.frames.kernel;
  summary.add("kernel", "  kernel", fmt::format("{}, w = {} d", name(kernel.shape), kernel.width));
  const dem::FieldRow* at_width = row_at(data.fields[1], z);
  const auto add = [&](const char* key, const char* label, const dem::FieldRow* other) {
    if (at_width == nullptr || other == nullptr) return;
    const auto percent = [&](double dem::FieldRow::*field) {
      return fmt::format("{:+.2g} %", 100.0 * (other->*field / at_width->*field - 1.0));
    };
    summary.add(key,
                label,
                fmt::format("shear rate {}, volume fraction {}, mu {}, temperature {}",
                            percent(&dem::FieldRow::shear_rate),
                            percent(&dem::FieldRow::volume_fraction),
                            percent(&dem::FieldRow::friction),
                            percent(&dem::FieldRow::temperature)));
  };
  add("at_half_width", "    at w/2", row_at(data.fields[0], z));
  add("at_double_width", "    at 2 w", row_at(data.fields[2], z));
}

Summary describe(const dem::LocalData& data) {
  const dem::RunSummary& run = data.summary;
  Summary summary;
  summary.add("name", "run", data.name);
  summary.add("geometry", "geometry", data.conditions.geometry);
  if (data.conditions.geometry == "chute") {
    summary.add("inclination", "tilt", io::degrees(data.conditions.inclination), "degrees");
    for (std::size_t k = 1; k < data.conditions.tilts.size(); ++k) {
      summary.add(fmt::format("tilt_time_{}", k),
                  k == 1 ? "  changed at" : "  and at",
                  data.conditions.tilts[k].time,
                  "sqrt(d/g)");
    }
  }
  summary.add("steady", "steady", data.window.steady);
  summary.add("reason", "  because", data.window.reason);
  if (data.window.arrested_at) {
    summary.add("arrested_at", "arrested at", *data.window.arrested_at, "sqrt(d/g)");
  }
  summary.add("window_begin", "averaged from", data.window.begin, "sqrt(d/g)");
  summary.add("window_end", "to", data.window.end, "sqrt(d/g)");
  if (!data.rows.empty()) {
    const dem::LocalRow& middle = data.rows[data.rows.size() / 2];
    summary.add("middle_z", "mid layer at z", middle.z, "d");
    const auto add = [&](const char* key, const char* label, dem::Estimate x, const char* unit) {
      const std::string word{name(dem::convergence(x.effective_samples))};
      summary.add_estimate(key, label, x.value, x.error, unit, {dem::half_width(x, 0.95), word});
    };
    add("velocity", "  velocity", middle.velocity, "sqrt(g d)");
    add("shear_rate", "  shear rate", middle.shear_rate, "sqrt(g/d)");
    add("volume_fraction", "  volume fraction", middle.volume_fraction, "");
    add("friction", "  stress ratio mu", middle.friction, "");
    add("inertial_number", "  inertial number I", middle.inertial_number, "");
    add("softness", "  softness p*", middle.softness, "");
    if (data.conditions.attraction > 0.0) {
      add("bond_number", "  bond number Bo", middle.bond_number, "");
    }
    add("scaled_temperature", "  temperature T*", middle.scaled_temperature, "");
    summary.add("effective_samples", "  independent samples", middle.effective_samples);
    add_width_dependence(summary, data, middle.z);
    if (data.conditions.geometry == "chute") {
      summary.add("height", "height", data.rows.back().z + 0.5 * data.frames.row_width(), "d");
    }
    add_ranges(summary, data);
  }
  if (data.lifetimes) add_lifetimes(*data.lifetimes, summary);
  if (const auto few = few_samples(data)) {
    summary.add("few_samples",
                "warning",
                fmt::format("only {} independent samples of the velocity at its worst height: "
                            "standard errors are rough; a longer averaging_time would help",
                            *few));
  }
  constexpr double large_residual = 0.01;  // ten times what the default step keeps to
  if (run.energy_residual > large_residual) {
    summary.add("energy_warning",
                "warning",
                fmt::format("{:.2g} of the dissipated energy is not accounted for: the time step "
                            "is too long for these contacts",
                            run.energy_residual));
  }
  summary.add("coordination", "coordination Z", run.coordination);
  summary.add("steps", "steps", run.steps);
  summary.add("time_step", "time step", run.time_step, "sqrt(d/g)");
  summary.add("restitution", "restitution at this step", run.restitution);
  summary.add("largest_overlap", "largest overlap", run.largest_overlap, "radii");
  summary.add("deep_overlap_share", "contacts deeper than 0.1 r", run.deep_overlap_share);
  summary.add("energy_residual", "energy ledger residual", run.energy_residual, "of dissipation");
  summary.add("wall_seconds", "wall time", run.wall_seconds, "s");
  return summary;
}

}  // namespace grainlaw
