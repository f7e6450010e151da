#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "apps/certificate.h"
#include "apps/command_line.h"
#include "apps/grain_scales.h"
#include "apps/io/case_input.h"
#include "apps/io/profile_csv.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/safe_write.h"
#include "apps/predict_flow.h"
#include "apps/predict_sweep.h"
#include "apps/program.h"
#include "apps/steady_question.h"
#include "apps/summary.h"
#include "apps/trust.h"
#include "continuum/chute_1d.h"
#include "continuum/sampled_band.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using continuum::Outcome;

struct Arguments {
  std::string question;
  std::string table;
  std::string output;
  bool certificate = false;
};

using continuum::flows;

/// Beside the band of linear propagation, one that knows no linearity.
void describe_sampled_band(Summary& summary,
                           const std::optional<continuum::SampledBand>& band,
                           const io::Units& units) {
  if (!band) return;
  if (!band->rows.empty()) {
    const double velocity = units.size(io::dimension::velocity);
    const auto& surface = band->rows.back();
    summary.add("surface_velocity_95",
                "  95 % by sampling",
                fmt::format("{:.4g} to {:.4g}", surface.lower * velocity, surface.upper * velocity),
                units.symbol(io::dimension::velocity));
  }
  summary.add("bands_agree", "  bands agree", band->agrees);
  if (!band->agrees) summary.add("band_text", "  in words", band->text);
}

/// The transient is what SUNDIALS carries; the quadrature is its independent check.
void describe_transient(Summary& summary,
                        const continuum::TransientChute& transient,
                        const io::Units& units) {
  namespace is = io::dimension;
  const std::string velocity = units.symbol(is::velocity);
  const std::string time = units.symbol(is::time);
  const auto& answer = transient.answer;
  summary.heading("In time");
  summary.add("transient_outcome", "in time (CVODE)", std::string(name(answer.outcome)));
  summary.add("transient_text", "  in words", answer.text);
  if (answer.time) {
    const bool rest = answer.outcome == Outcome::arrested;
    summary.add(rest ? "arrest_time" : "start_time",
                rest ? "  at rest from t =" : "  started at t =",
                *answer.time * units.time,
                time);
  }
  if (transient.events.size() > 1) {
    std::vector<std::string> events;
    for (const continuum::ChuteEvent& event : transient.events)
      events.push_back(fmt::format("{} {:.6g}", name(event.kind), event.time * units.time));
    summary.add("events", "  events", events);
  }
  for (const continuum::Snapshot& snapshot : transient.snapshots) {
    const double t = snapshot.time * units.time;
    summary.add(fmt::format("surface_velocity_at_{:.6g}", t),
                fmt::format("  at t = {:.6g} {}", t, time),
                snapshot.profile.surface_velocity * units.size(is::velocity),
                velocity);
  }
  summary.add("transient_surface_velocity",
              "  at the end",
              transient.final_profile.surface_velocity * units.size(is::velocity),
              velocity);
  if (transient.quadrature_surface_velocity && transient.time_to_steady) {
    const double steady = *transient.quadrature_surface_velocity;
    summary.add("quadrature_surface_velocity",
                "  steady by quadrature",
                steady * units.size(is::velocity),
                velocity);
    summary.add("difference_from_quadrature",
                "  relative difference",
                transient.final_profile.surface_velocity / steady - 1.0);
  }
  if (transient.time_to_steady) {
    summary.add(
        "time_to_steady", "  within 1 % from t =", *transient.time_to_steady * units.time, time);
  }
  summary.add("transient_end", "  integrated to t =", transient.end_time * units.time, time);
  summary.add("transient_steps", "  steps", transient.statistics.steps);
  summary.add("transient_wall", "  wall time", transient.statistics.wall_seconds, "s");
}

/// PROFILE.csv, or PROFILE.json by the extension; snapshots go beside it as PROFILE_t0.5.csv.
void write_profile(const continuum::Profile& profile,
                   const continuum::Answer& answer,
                   const io::Units& units,
                   const fs::path& path) {
  const bool json = path.extension() == ".json";
  io::safe_write(
      path,
      json ? io::profile_json(profile, answer, units) : io::profile_csv(profile, answer, units));
}

fs::path snapshot_path(const fs::path& path, double time) {
  return path.parent_path() /
         fmt::format("{}_t{:.6g}{}", path.stem().string(), time, path.extension().string());
}

/// What a prediction will use and leave out.
Summary check(const io::CaseFile& file, const continuum::RheologyTable& table) {
  Summary summary;
  const bool bagnold = std::holds_alternative<continuum::GeneralisedBagnold>(table.law);
  std::vector<std::string> left_out;
  const bool in_time =
      file.question != io::Question::steady && file.question != io::Question::largest_flow;
  if (!in_time) left_out.emplace_back("time loop (CVODE): only the steady flow is asked");
  if (!table.covariance) left_out.emplace_back("error band: the table states no errors");
  if (!table.base)
    left_out.emplace_back("effective no-slip height: the table has none, u = 0 at z = 0");
  if (!file.chute.grains.stiffness) left_out.emplace_back("softness: rigid grains");
  if (!file.chute.grains.adhesion) left_out.emplace_back("cohesion: no adhesion given");
  if (const auto text = unknown_cohesion(table, file.chute.grains.adhesion.has_value()))
    left_out.push_back("cohesion: " + *text);
  if (!file.chute.walls) left_out.emplace_back("side walls: none given");
  if (file.chute.slip_length == 0.0) left_out.emplace_back("slip at the base: none given");
  summary.add("case", "case", file.name);
  if (file.tilt_sought)
    summary.add("tilt_sought", "tilt", std::string("is sought"));
  else
    summary.add("tilt", "tilt", io::degrees(file.chute.inclination), "degrees");
  summary.add("law",
              "law",
              std::string(bagnold ? "generalised Bagnold (its own tilt only)"
                                  : "mu(I, p*, Bo), phi(I, p*, Bo)"));
  summary.add("coefficients", "coefficients", continuum::coefficient_names(table));
  summary.add("leaves_out", "leaves out", left_out);
  summary.add(
      "run_time",
      "run time",
      std::string(!in_time ? "milliseconds" : "about 0.1 s per 1000 cells for a layer 50 d deep"));
  return summary;
}

void write_snapshots(const Arguments& arguments,
                     const io::CaseFile& file,
                     const continuum::TransientChute& transient) {
  if (arguments.output.empty()) return;
  for (const continuum::Snapshot& snapshot : transient.snapshots) {
    write_profile(snapshot.profile,
                  transient.answer,
                  file.units,
                  snapshot_path(arguments.output, snapshot.time * file.units.time));
  }
}

[[noreturn]] void refuse(const continuum::Answer& answer) {
  throw NoAnswer(std::string(name(answer.outcome)) + ": " + answer.text);
}

void describe_grains(Summary& summary,
                     const continuum::RheologyTable& table,
                     const continuum::Profile& profile,
                     const io::CaseFile& file) {
  const auto with = [&](const continuum::GrainProperties& grains) -> std::optional<double> {
    continuum::ChuteCase chute = file.chute;
    chute.grains = grains;
    const auto other = continuum::steady_chute(table, chute, {.rows = 2});
    if (!flows(other.answer.outcome)) return std::nullopt;
    return other.profile.surface_velocity;
  };
  say_grain_scales(summary,
                   {.profile = profile,
                    .grains = file.chute.grains,
                    .place = "at the base",
                    .response = "surface velocity",
                    .value = profile.surface_velocity,
                    .dimension = io::dimension::velocity,
                    .with = with},
                   table,
                   file.units);
}

void say_trust(Summary& summary,
               const continuum::Answer& answer,
               const continuum::RheologyTable& table,
               const continuum::GrainProperties& grains) {
  summary.heading("How far to trust it");
  summary.add("trust", "trust", trust(answer, table));
  say_unknown_cohesion(summary, table, grains.adhesion.has_value());
}

/// A flow in time: the answer, the profiles and the trust are those of the time integration.
ExitCode predict_in_time(const Arguments& arguments,
                         const io::CaseFile& file,
                         const continuum::RheologyTable& table,
                         Summary& summary,
                         const CommonOptions& options) {
  const auto transient = continuum::transient_chute(table, file.chute, file.transient);
  describe_transient(summary, transient, file.units);
  say_trust(summary, transient.answer, table, file.chute.grains);
  if (arguments.certificate)
    say_certificate(summary, table, transient.final_profile, file.chute.grains);
  if (!arguments.output.empty() && !transient.final_profile.rows.empty()) {
    write_snapshots(arguments, file, transient);
    write_profile(transient.final_profile, transient.answer, file.units, arguments.output);
    summary.add("output", "profile at the end", arguments.output);
  }
  print(summary, options);
  if (transient.answer.outcome == Outcome::not_converged || transient.final_profile.rows.empty())
    refuse(transient.answer);
  return ExitCode::answered;
}

/// The steady flow: by quadrature, whose profile has the error band, and unless it is left out by
/// time integration from rest, which knows nothing of the former.
ExitCode predict_steady(const Arguments& arguments,
                        const io::CaseFile& file,
                        const continuum::RheologyTable& table,
                        const continuum::SteadyChute& steady,
                        Summary& summary,
                        const CommonOptions& options) {
  std::optional<continuum::TransientChute> transient;
  const bool as_given =
      !file.depth && !file.mass_flow && file.question != io::Question::largest_flow;
  if (as_given)  // a search holds other things than tilt and mass
    describe_sampled_band(
        summary, continuum::sample_error_band(steady, table, file.chute), file.units);
  describe_depth(summary, table, steady.profile, file);
  if (file.question == io::Question::flow) {
    transient = continuum::transient_chute(table, file.chute, file.transient);
    describe_transient(summary, *transient, file.units);
    write_snapshots(arguments, file, *transient);
  } else {
    summary.add(
        "time_loop",
        "time loop",
        std::string(file.question == io::Question::steady ? "left out: answer = \"steady\""
                                                          : "left out: answer = \"largest_flow\""));
  }
  describe_grains(summary, table, steady.profile, file);
  say_trust(summary, steady.answer, table, file.chute.grains);
  if (arguments.certificate) say_certificate(summary, table, steady.profile, file.chute.grains);
  if (!arguments.output.empty() && !steady.profile.rows.empty()) {
    write_profile(steady.profile, steady.answer, file.units, arguments.output);
    summary.add("output", "profile", arguments.output);
  }
  print(summary, options);
  if (!flows(steady.answer.outcome)) refuse(steady.answer);
  if (transient && !flows(transient->answer.outcome)) refuse(transient->answer);
  return ExitCode::answered;
}

/// Before anything is computed: nothing that is read here, or was by others, is written over.
void refuse_overwriting(const Arguments& arguments, const io::CaseFile& file) {
  if (arguments.output.empty()) return;
  std::vector<std::string> outputs = {arguments.output};
  for (const double time : file.transient.output_times)
    outputs.push_back(snapshot_path(arguments.output, time * file.units.time).string());
  for (const std::string& output : outputs) {
    refuse_overwriting_input(output, {arguments.question, arguments.table});
    refuse_overwriting_run(output);
  }
}

ExitCode predict(const Arguments& arguments, const CommonOptions& options) {
  io::CaseFile file = io::read_case(arguments.question);
  refuse_overwriting(arguments, file);
  const continuum::RheologyTable table =
      io::in_grain_units(io::read_table(arguments.table), file.units);
  if (!file.simple_shear) continuum::validate(table);  // no flow follows from phi alone
  if (file.sweep) return predict_sweep(file, arguments.table, arguments.output, options);
  if (!file.is_chute())
    return predict_flow(file, table, arguments.output, arguments.certificate, options);
  if (options.check) {
    print(check(file, table), options);
    return ExitCode::answered;
  }
  const SteadyAnswer found = answer_steady(table, file);
  Summary summary;
  if (arguments.certificate) say_certificate(summary, table);
  describe(summary, found, file);
  if (file.question == io::Question::start || file.question == io::Question::step)
    return predict_in_time(arguments, file, table, summary, options);
  return predict_steady(arguments, file, table, found.steady, summary, options);
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommandLine line(
      "predict",
      "Predicts a chute flow or a shear band from a fitted or published table.\n"
      "Needs no DEM.",
      "  grainlaw predict data/cases/chute.toml -t data/tables/shi2020_mu_p_0.50.toml");
  Arguments arguments;
  line.required("CASE.toml", arguments.question, "the question");
  line.option("-t,--table", arguments.table, "rheology table", true);
  line.option("-o,--output", arguments.output, "profile as PROFILE.csv or PROFILE.json");
  line.flag("--certificate", arguments.certificate, "where the law is well-posed in 2D and 3D");
  return line.run(
      argc, argv, [&](const CommonOptions& options) { return predict(arguments, options); });
}
