#include "apps/predict_flow.h"

#include <fmt/format.h>

#include <filesystem>

#include "apps/io/profile_csv.h"
#include "apps/io/safe_write.h"
#include "apps/io/split_bottom_csv.h"
#include "apps/summary.h"
#include "apps/trust.h"

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

const char* kind_of(const ShearBandCase& band) {
  constexpr const char* kinds[] = {"plane shear", "body-force box", "annular shear"};
  return kinds[band.flow.index()];
}

bool nonlocal(const ShearBandCase& band) {
  return band.nonlocal_amplitude.value_or(0.0) > 0.0;
}

/// What a prediction will use and leave out.
Summary check(const io::CaseFile& file, const continuum::RheologyTable& table) {
  Summary summary;
  std::vector<std::string> left_out{"time loop: the steady state is asked"};
  const auto& grains = file.band ? file.band->grains : file.split_bottom->grains;
  if (!grains.stiffness) left_out.emplace_back("softness: rigid grains");
  if (!grains.adhesion) left_out.emplace_back("cohesion: no adhesion given");
  if (!table.covariance) left_out.emplace_back("error band: the table states no errors");
  if (file.band && !nonlocal(*file.band))
    left_out.emplace_back("nonlocal fluidity: no [nonlocal] amplitude");
  summary.add("case", "case", file.name);
  summary.add("flow",
              "flow",
              std::string(file.band ? kind_of(*file.band) : "split-bottom cell (geometry)"));
  summary.add("coefficients", "coefficients", continuum::coefficient_names(table));
  summary.add("leaves_out", "leaves out", left_out);
  summary.add("run_time", "run time", std::string("below 0.1 s"));
  return summary;
}

void say_answer(Summary& summary, const continuum::Answer& answer) {
  summary.add("outcome", "answer", std::string(name(answer.outcome)));
  summary.add("text", "  in words", answer.text);
}

/// The local law has no length but the gradient of the stress: its width is no prediction.
void say_collapse(Summary& summary, const ShearBand& band) {
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

ExitCode predict_band(const io::CaseFile& file,
                      const continuum::RheologyTable& table,
                      const std::string& output,
                      const CommonOptions& options) {
  ShearBand band = continuum::shear_band(table, *file.band);
  continuum::add_error(band, table, *file.band);
  Summary summary;
  say_answer(summary, band.answer);
  if (flows(band.answer.outcome)) say_band(summary, band, file);
  summary.add("trust", "trust", trust(band.answer, table));
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

ExitCode predict_split_bottom(const io::CaseFile& file,
                              const continuum::RheologyTable& table,
                              const std::string& output,
                              const CommonOptions& options) {
  const SplitBottom cell = continuum::split_bottom(table, *file.split_bottom);
  Summary summary;
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
  summary.add("trust", "trust", trust(cell.answer, table, false));
  if (!output.empty() && !cell.rows.empty())
    write(output,
          as_json(output) ? io::split_bottom_json(cell, file.units)
                          : io::split_bottom_csv(cell, file.units),
          summary);
  print(summary, options);
  if (cell.rows.empty()) no_answer(cell.answer);
  return ExitCode::answered;
}

}  // namespace

ExitCode predict_flow(const io::CaseFile& file,
                      const continuum::RheologyTable& table,
                      const std::string& output,
                      const CommonOptions& options) {
  if (options.check) {
    print(check(file, table), options);
    return ExitCode::answered;
  }
  return file.band ? predict_band(file, table, output, options)
                   : predict_split_bottom(file, table, output, options);
}

}  // namespace grainlaw
