#include "apps/predict_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/certificate.h"
#include "apps/grain_scales.h"
#include "apps/io/homogeneous_csv.h"
#include "apps/io/profile_csv.h"
#include "apps/io/ring_flow_csv.h"
#include "apps/io/safe_write.h"
#include "apps/io/split_bottom_csv.h"
#include "apps/summary.h"
#include "apps/trust.h"
#include "continuum/shear_band_start.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
namespace is = io::dimension;
using continuum::ShearBand;
using continuum::ShearBandCase;
using continuum::SplitBottom;

/// Adds numbers in the units of the file.
struct Lines {
  Summary& summary;
  const io::Units& units;

  void add(const char* key, const char* label, double value, io::Dimension dimension) const {
    summary.add(key, label, value * units.size(dimension), units.symbol(dimension));
  }
  void add(const char* key,
           const char* label,
           double value,
           double error,
           io::Dimension dimension) const {
    const double size = units.size(dimension);
    summary.add_estimate(key, label, value * size, error * size, units.symbol(dimension));
  }
};

std::string kind_of(const io::CaseFile& file) {
  if (file.split_bottom) return "split-bottom cell (geometry)";
  if (file.ring_cell) return "ring cell, over radius and height";
  if (file.simple_shear) return "homogeneous shear (the law itself)";
  constexpr const char* kinds[] = {"plane shear", "body-force box", "annular shear"};
  return kinds[file.band->flow.index()];
}

template <class Case>
bool nonlocal(const Case& flow) {
  return flow.nonlocal_amplitude.value_or(0.0) > 0.0;
}

/// Whether the way from rest is followed in time.
bool has_start(const io::CaseFile& file) {
  return file.band && !nonlocal(*file.band) &&
         !std::holds_alternative<continuum::AnnularShear>(file.band->flow);
}

const continuum::GrainProperties* grains_of(const io::CaseFile& file) {
  if (file.band) return &file.band->grains;
  if (file.ring_cell) return &file.ring_cell->cell.grains;
  return file.split_bottom ? &file.split_bottom->grains : nullptr;
}

/// What a prediction will use and leave out.
Summary check(const io::CaseFile& file, const continuum::RheologyTable& table) {
  Summary summary;
  std::vector<std::string> left_out;
  const auto leave_out = [&](bool absent, const char* what) {
    if (absent) left_out.emplace_back(what);
  };
  leave_out(!has_start(file), "time loop (CVODE): for plane shear and box by the local law");
  if (const auto* grains = grains_of(file)) {
    leave_out(!grains->stiffness, "softness: rigid grains");
    leave_out(!grains->adhesion, "cohesion: no adhesion given");
    const auto text = unknown_cohesion(table, grains->adhesion.has_value());
    if (text) left_out.push_back("cohesion: " + *text);
  }
  leave_out(!table.covariance, "error band: the table states no errors");
  leave_out(!table.has_friction, "friction: the table has phi only");
  leave_out((file.band && !nonlocal(*file.band)) || (file.ring_cell && !nonlocal(*file.ring_cell)),
            "nonlocal fluidity: no [nonlocal] amplitude");
  summary.add("case", "case", file.name);
  summary.add("flow", "flow", kind_of(file));
  summary.add("coefficients", "coefficients", continuum::coefficient_names(table));
  summary.add("leaves_out", "leaves out", left_out);
  summary.add(
      "run_time", "run time", std::string(file.ring_cell ? "about a second" : "below a second"));
  return summary;
}

void say_answer(Summary& summary, const continuum::Answer& answer) {
  summary.add("outcome", "answer", std::string(name(answer.outcome)));
  summary.add("text", "  in words", answer.text);
}

/// The local law has no length but the gradient of the stress: its width is no prediction.
template <class Flow>
void say_collapse(Summary& summary, const Flow& band) {
  summary.add("local_band_collapse", "LOCAL_BAND_COLLAPSE", band.local_band_collapse);
  if (band.local_band_collapse)
    summary.add("collapse_text",
                "  in words",
                fmt::format("the local law yields over less than {} d; grains flow over 5 to 10 d "
                            "there: give [nonlocal] amplitude",
                            continuum::thinnest_credible_band));
}

void say_band(Summary& summary, const ShearBand& band, const io::CaseFile& file) {
  const Lines lines{summary, file.units};
  const bool box = std::holds_alternative<continuum::BodyForceBox>(file.band->flow);
  const bool stress_sought = band.sought == ShearBand::Sought::stress;
  lines.add("driving_stress",
            box ? "largest shear stress" : "stress on the wall",
            band.driving_stress,
            stress_sought ? band.error : 0.0,
            is::stress);
  lines.add("driving_velocity",
            box ? "largest velocity" : "velocity of the wall",
            band.driving_velocity,
            stress_sought ? 0.0 : band.error,
            is::velocity);
  lines.add("yielded_width", "tau above yield over", band.yielded_width, is::length);
  lines.add("band_width", "90 % of velocity over", band.band_width, is::length);
  say_collapse(summary, band);
  lines.add("height", "extent", band.profile.height, is::length);
  summary.add("cells", "cells", static_cast<long>(band.cells));
  summary.add("discretisation_error", "  relative error", band.discretisation_error);
  summary.add("wall_seconds", "wall time", band.wall_seconds, "s");
}

/// The way there from rest, whose end knows nothing of the steady quadrature.
void say_start(Summary& summary, const continuum::BandStart& start, const io::Units& units) {
  summary.add("start_outcome", "from rest in time", std::string(name(start.answer.outcome)));
  if (start.time_to_steady)
    summary.add("time_to_steady",
                "  within 1 % from t =",
                *start.time_to_steady * units.size(is::time),
                units.symbol(is::time));
  summary.add("difference_from_quadrature", "  relative difference", start.difference);
  summary.add("transient_steps", "  steps", start.statistics.steps);
  summary.add("transient_wall", "  wall time", start.statistics.wall_seconds, "s");
}

void write(const std::string& output, const std::string& text, Summary& summary) {
  io::safe_write(output, text);
  summary.add("output", "profile", output);
}

[[noreturn]] void no_answer(const continuum::Answer& answer) {
  throw NoAnswer(std::string(name(answer.outcome)) + ": " + answer.text);
}

bool as_json(const std::string& output) {
  return fs::path(output).extension() == ".json";
}

/// What is sought of the drive: its speed, or its stress where the speed is given.
double response(const ShearBand& band) {
  return band.sought == ShearBand::Sought::stress ? band.driving_stress : band.driving_velocity;
}

void say_grains(Summary& summary,
                const ShearBand& band,
                const io::CaseFile& file,
                const continuum::RheologyTable& table) {
  const auto with = [&](const continuum::GrainProperties& grains) -> std::optional<double> {
    ShearBandCase other = *file.band;
    other.grains = grains;
    const ShearBand moved = continuum::shear_band(table, other);
    if (!flows(moved.answer.outcome)) return std::nullopt;
    return response(moved);
  };
  const bool stress = band.sought == ShearBand::Sought::stress;
  const bool uniform = !std::holds_alternative<continuum::PlaneShear>(file.band->flow);
  say_grain_scales(summary,
                   {.profile = band.profile,
                    .grains = file.band->grains,
                    .place = uniform ? "everywhere" : "at the wall at rest",
                    .response = stress ? "stress" : "velocity",
                    .value = response(band),
                    .dimension = stress ? is::stress : is::velocity,
                    .with = with},
                   table,
                   file.units);
}

ExitCode predict_band(const io::CaseFile& file,
                      const continuum::RheologyTable& table,
                      const std::string& output,
                      bool certificate,
                      const CommonOptions& options) {
  ShearBand band = continuum::shear_band(table, *file.band);
  continuum::add_error(band, table, *file.band);
  Summary summary;
  if (certificate) say_certificate(summary, table);
  say_answer(summary, band.answer);
  if (flows(band.answer.outcome)) {
    say_band(summary, band, file);
    if (has_start(file))
      say_start(summary, continuum::start_band(table, *file.band, {.cells = 100}), file.units);
    say_grains(summary, band, file, table);
  }
  summary.heading("How far to trust it");
  summary.add("trust", "trust", trust(band.answer, table));
  say_unknown_cohesion(summary, table, file.band->grains.adhesion.has_value());
  if (certificate && nonlocal(*file.band))
    summary.add("certificate_text",
                "  in words",
                std::string("of the local law alone: where the flow is nonlocal nothing is said"));
  else if (certificate)
    say_certificate(summary, table, band.profile, file.band->grains);
  if (!output.empty() && !band.profile.rows.empty()) {
    const bool annular = std::holds_alternative<continuum::AnnularShear>(file.band->flow);
    const bool box = std::holds_alternative<continuum::BodyForceBox>(file.band->flow);
    const char* coordinate = annular ? "r" : box ? "y" : "z";
    write(output,
          as_json(output) ? io::profile_json(band.profile, band.answer, file.units, coordinate)
                          : io::profile_csv(band.profile, band.answer, file.units, coordinate),
          summary);
  }
  print(summary, options);
  if (!flows(band.answer.outcome)) no_answer(band.answer);
  return ExitCode::answered;
}

/// Where the error function of the surface has a tenth and nine tenths of the rotation rate.
void say_spread(const Lines& lines, const SplitBottom& cell) {
  constexpr double decile = 0.9061938024;  // erf = 0.8
  const double half = decile * cell.surface_width;
  lines.add("tenth_radius", "  10 % of Omega at", cell.path_radius - half, is::length);
  lines.add("nine_tenths_radius", "  90 % of Omega at", cell.path_radius + half, is::length);
}

ExitCode predict_split_bottom(const io::CaseFile& file,
                              const continuum::RheologyTable& table,
                              const std::string& output,
                              bool certificate,
                              const CommonOptions& options) {
  const SplitBottom cell = continuum::split_bottom(table, *file.split_bottom);
  Summary summary;
  if (certificate) say_certificate(summary, table);
  say_answer(summary, cell.answer);
  const Lines lines{summary, file.units};
  if (!cell.rows.empty()) {
    const auto& middle = cell.rows[cell.rows.size() / 2];
    lines.add("path_radius", "R_c at the surface, path", cell.path_radius, is::length);
    lines.add("torque", "torque", cell.torque, is::energy);
    summary.add("inertial_number", "I at half depth", middle.inertial_number);
    summary.add("friction", "mu at half depth", middle.friction);
  }
  lines.add("measured_radius", "R_c, experiments", cell.measured_radius, is::length);
  lines.add("surface_width", "W at the surface", cell.surface_width, is::length);
  if (!cell.rows.empty()) say_spread(lines, cell);
  summary.add("trust", "trust", trust(cell.answer, table, false));
  say_unknown_cohesion(summary, table, file.split_bottom->grains.adhesion.has_value());
  if (!output.empty() && !cell.rows.empty())
    write(output,
          as_json(output) ? io::split_bottom_json(cell, file.units)
                          : io::split_bottom_csv(cell, file.units),
          summary);
  print(summary, options);
  if (cell.rows.empty()) no_answer(cell.answer);
  return ExitCode::answered;
}

ExitCode predict_ring_cell(const io::CaseFile& file,
                           const continuum::RheologyTable& table,
                           const std::string& output,
                           bool certificate,
                           const CommonOptions& options) {
  const continuum::RingFlow flow = continuum::ring_flow(table, *file.ring_cell);
  Summary summary;
  if (certificate) say_certificate(summary, table);
  say_answer(summary, flow.answer);
  const Lines lines{summary, file.units};
  if (flows(flow.answer.outcome)) {
    const auto& top = flow.rows.back();
    const auto& middle = flow.rows[flow.rows.size() / 2];
    lines.add("centre", "R_c at the surface", top.centre, is::length);
    lines.add("width", "W at the surface", top.width, is::length);
    say_collapse(summary, flow);
    lines.add("torque", "torque", flow.torque, is::energy);
    summary.add("inertial_number", "I at half depth", middle.inertial_number);
    summary.add("friction", "mu at half depth", middle.friction);
    summary.add("discretisation_error", "relative error", flow.discretisation_error);
    summary.add("wall_seconds", "wall time", flow.wall_seconds, "s");
  }
  summary.add("trust", "trust", trust(flow.answer, table, false));
  if (!output.empty() && flows(flow.answer.outcome))
    write(output,
          as_json(output) ? io::ring_flow_json(flow, file.units)
                          : io::ring_flow_csv(flow, file.ring_cell->cell.rotation_rate, file.units),
          summary);
  print(summary, options);
  if (!flows(flow.answer.outcome)) no_answer(flow.answer);
  return ExitCode::answered;
}

constexpr std::size_t most_states_said = 24;

/// One line per point; a table of many goes to the output.
void say_states(Summary& summary, const std::vector<continuum::HomogeneousState>& states) {
  const auto text = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.5g}", *value) : std::string("none");
  };
  for (std::size_t i = 0; i < std::min(states.size(), most_states_said); ++i) {
    const auto& s = states[i];
    const std::string at =
        fmt::format("I {:.4g}, p* {:.4g}, Bo {:.4g}", s.inertial_number, s.softness, s.bond_number);
    summary.add(fmt::format("state_{}", i + 1),
                at,
                fmt::format("mu {}, phi {}{}",
                            text(s.friction),
                            text(s.volume_fraction),
                            s.in_range ? "" : "  OUT_OF_DOMAIN"));
  }
  if (states.size() > most_states_said)
    summary.add(
        "more", "more", fmt::format("{} points: give -o", states.size() - most_states_said));
}

/// The margin of well-posedness at the points asked for.
void say_margins(Summary& summary,
                 const std::vector<continuum::HomogeneousState>& states,
                 const continuum::RheologyTable& table) {
  say_certificate(summary, table);
  for (std::size_t i = 0; i < std::min(states.size(), most_states_said); ++i) {
    const auto& s = states[i];
    const auto found = continuum::certify(table, {s.inertial_number, s.softness, s.bond_number});
    if (!found) continue;
    summary.add_estimate(
        fmt::format("margin_{}", i + 1),
        fmt::format(
            "  F at I {:.4g}, p* {:.4g}, Bo {:.4g}", s.inertial_number, s.softness, s.bond_number),
        found->well_posedness.margin,
        found->margin_error.value_or(0.0));
  }
}

ExitCode predict_simple_shear(const io::CaseFile& file,
                              const continuum::RheologyTable& table,
                              const std::string& output,
                              bool certificate,
                              const CommonOptions& options) {
  const auto& shear = *file.simple_shear;
  const auto states = continuum::homogeneous_shear(
      table, shear.inertial_numbers, shear.softnesses, shear.bond_numbers);
  Summary summary;
  say_states(summary, states);
  if (certificate && table.has_friction) say_margins(summary, states, table);
  const long outside = std::ranges::count(states, false, &continuum::HomogeneousState::in_range);
  summary.add("outside", "points outside", outside);
  summary.add("trust",
              "trust",
              fmt::format("{} of {} points outside the range of the data{}",
                          outside,
                          states.size(),
                          checks_text(table)));
  say_unknown_cohesion(
      summary, table, std::ranges::any_of(shear.bond_numbers, [](double Bo) { return Bo > 0.0; }));
  if (!output.empty())
    write(output,
          as_json(output) ? io::homogeneous_json(states) : io::homogeneous_csv(states),
          summary);
  print(summary, options);
  return ExitCode::answered;
}

}  // namespace

ExitCode predict_flow(const io::CaseFile& file,
                      const continuum::RheologyTable& table,
                      const std::string& output,
                      bool certificate,
                      const CommonOptions& options) {
  if (options.check) {
    print(check(file, table), options);
    return ExitCode::answered;
  }
  if (file.band) return predict_band(file, table, output, certificate, options);
  if (file.split_bottom) return predict_split_bottom(file, table, output, certificate, options);
  if (file.ring_cell) return predict_ring_cell(file, table, output, certificate, options);
  return predict_simple_shear(file, table, output, certificate, options);
}

}  // namespace grainlaw
