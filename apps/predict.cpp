#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "apps/command_line.h"
#include "apps/io/case_input.h"
#include "apps/io/profile_csv.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/safe_write.h"
#include "apps/program.h"
#include "apps/summary.h"
#include "continuum/chute_1d.h"

namespace grainlaw {
namespace {

using continuum::Outcome;

struct Arguments {
  std::string question;
  std::string table;
  std::string output;
};

bool is_flow(Outcome outcome) {
  return outcome == Outcome::steady || outcome == Outcome::plug;
}

/// Mass per area of a layer whose free surface stands at `depth`: height grows with mass, so a
/// bracketed secant finds it. Without a steady flow the law gives no height: the answer says why.
continuum::SteadyChute steady_at_depth(const continuum::RheologyTable& table,
                                       continuum::ChuteCase& chute,
                                       double depth) {
  const auto height_error = [&](double mass, continuum::SteadyChute& steady) {
    chute.mass_per_area = mass;
    steady = continuum::steady_chute(table, chute);
    return steady.profile.height - depth;
  };
  continuum::SteadyChute steady;
  const double full = chute.grains.density * depth;  // phi = 1: more mass than any layer holds
  double low = 0.2 * full;
  double high = full;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    const double error = height_error(middle, steady);
    if (!is_flow(steady.answer.outcome)) return steady;
    if (std::abs(error) <= 1e-13 * depth) break;
    (error > 0.0 ? high : low) = middle;
  }
  return steady;
}

/// The one line of trust that ends every prediction.
std::string trust(const continuum::Answer& answer, const continuum::RheologyTable& table) {
  if (!is_flow(answer.outcome)) return "no steady flow, so no range and no band to judge";
  std::string text;
  if (answer.out_of_domain.empty()) text = "inside the range of the data";
  for (const continuum::RangeFlag& flag : answer.out_of_domain) {
    if (!text.empty()) text += ", ";
    text += fmt::format(
        "OUT_OF_DOMAIN: {} reaches {:.3g} to {:.3g}, data {:.3g} to {:.3g} ({:.0f} % "
        "of the flowing mass outside)",
        flag.quantity,
        flag.reached_lowest,
        flag.reached_highest,
        flag.lower,
        flag.upper,
        100.0 * flag.fraction_outside);
  }
  if (answer.condition_number > 0.0) {
    text += fmt::format("; 1 % of mu moves I by {:.1f} %", answer.condition_number);
  }
  text += table.covariance ? "; band: one standard error from the table's covariance"
                           : "; no band: this table states no errors";
  const auto& checks = table.provenance.checked_against;
  return text +
         (checks.empty() ? "; checked against nothing" : "; checked against " + checks.front());
}

void describe(Summary& summary,
              const continuum::Answer& answer,
              const continuum::Profile& profile,
              const io::Units& units) {
  summary.add("outcome", "answer", std::string(name(answer.outcome)));
  summary.add("text", "  in words", answer.text);
  if (profile.rows.empty()) return;
  namespace is = io::dimension;
  summary.add("height",
              "free surface at",
              profile.height * units.size(is::length),
              units.symbol(is::length));
  summary.add_estimate("surface_velocity",
                       "surface velocity",
                       profile.surface_velocity * units.size(is::velocity),
                       profile.rows.back().velocity_error * units.size(is::velocity),
                       units.symbol(is::velocity));
  summary.add(
      "flux", "flux int phi v dz", profile.flux * units.size(is::flux), units.symbol(is::flux));
}

/// The transient is what SUNDIALS carries; the quadrature is its independent check.
void describe_transient(Summary& summary,
                        const continuum::TransientChute& transient,
                        const io::Units& units) {
  summary.add(
      "transient_outcome", "from rest (CVODE)", std::string(name(transient.answer.outcome)));
  summary.add("transient_text", "  in words", transient.answer.text);
  summary.add("transient_surface_velocity",
              "  surface velocity",
              transient.final_profile.surface_velocity * units.size(io::dimension::velocity),
              units.symbol(io::dimension::velocity));
  summary.add("transient_end",
              "  ended at t",
              transient.end_time * units.time,
              units.symbol(io::dimension::time));
  summary.add("transient_steps", "  steps", transient.statistics.steps);
  summary.add("transient_wall", "  wall time", transient.statistics.wall_seconds, "s");
}

/// What a prediction will use and leave out.
Summary check(const io::CaseFile& file, const continuum::RheologyTable& table) {
  Summary summary;
  const bool bagnold = std::holds_alternative<continuum::GeneralisedBagnold>(table.law);
  std::vector<std::string> left_out;
  if (file.question == io::Question::steady)
    left_out.emplace_back("time loop (CVODE): steady state asked");
  if (!table.covariance) left_out.emplace_back("error band: the table states no errors");
  if (!table.base)
    left_out.emplace_back("effective no-slip height: the table has none, u = 0 at z = 0");
  if (!file.chute.grains.stiffness) left_out.emplace_back("softness: rigid grains");
  if (!file.chute.grains.adhesion) left_out.emplace_back("cohesion: no adhesion given");
  summary.add("case", "case", file.name);
  summary.add("tilt", "tilt", io::degrees(file.chute.inclination), "degrees");
  summary.add("law",
              "law",
              std::string(bagnold ? "generalised Bagnold (its own tilt only)"
                                  : "mu(I, p*, Bo), phi(I, p*, Bo)"));
  summary.add("coefficients", "coefficients", continuum::coefficient_names(table));
  summary.add("leaves_out", "leaves out", left_out);
  summary.add("run_time", "run time", std::string("well below a second"));
  return summary;
}

ExitCode predict(const Arguments& arguments, const CommonOptions& options) {
  io::CaseFile file = io::read_case(arguments.question);
  const continuum::RheologyTable table =
      io::in_grain_units(io::read_table(arguments.table), file.units);
  if (options.check) {
    const Summary summary = check(file, table);
    fmt::print("{}", options.json ? summary.json() : summary.text());
    return ExitCode::answered;
  }
  continuum::SteadyChute steady = file.depth ? steady_at_depth(table, file.chute, *file.depth)
                                             : continuum::steady_chute(table, file.chute);
  continuum::add_error_band(steady, table, file.chute);
  Summary summary;
  describe(summary, steady.answer, steady.profile, file.units);
  continuum::Profile profile = steady.profile;
  bool answered = is_flow(steady.answer.outcome);
  if (file.question == io::Question::start) {
    const auto transient = continuum::start_from_rest(table, file.chute, file.transient);
    describe_transient(summary, transient, file.units);
    profile = transient.final_profile;
    answered = transient.answer.outcome != Outcome::not_converged;
  } else {
    summary.add("time_loop", "time loop", std::string("left out: only the steady state was asked"));
  }
  summary.add("trust", "trust", trust(steady.answer, table));
  if (!arguments.output.empty() && !profile.rows.empty()) {
    const bool json = std::filesystem::path(arguments.output).extension() == ".json";
    io::safe_write(arguments.output,
                   json ? io::profile_json(profile, steady.answer, file.units)
                        : io::profile_csv(profile, steady.answer, file.units));
    summary.add("output", "profile", arguments.output);
  }
  if (options.json || !options.quiet)
    fmt::print("{}", options.json ? summary.json() : summary.text());
  if (!answered)
    throw NoAnswer(std::string(name(steady.answer.outcome)) + ": " + steady.answer.text);
  return ExitCode::answered;
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommonOptions options;
  CommandLine line(
      "grainlaw-predict",
      "Predicts a chute flow from a fitted or published table; needs no DEM.",
      "  grainlaw predict data/cases/chute.toml --table data/tables/shi2020_mu_p_0.50.toml",
      options);
  Arguments arguments;
  line.required("CASE.toml", arguments.question, "the question");
  line.option("-t,--table", arguments.table, "rheology table", true);
  line.option("-o,--output", arguments.output, "profile as PROFILE.csv or PROFILE.json");
  if (const auto code = line.parse(argc, argv)) return *code;
  return run_program("grainlaw predict", [&] { return predict(arguments, options); });
}
