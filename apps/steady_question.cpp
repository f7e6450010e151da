#include "apps/steady_question.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/exit_code.h"
#include "continuum/thin_layer.h"

namespace grainlaw {
namespace {

using continuum::ChuteQuestion;
using continuum::FoundChute;
using continuum::NoSuchFlow;
using continuum::Outcome;
namespace is = io::dimension;

std::string with_unit(double value, io::Dimension dimension, const io::Units& units) {
  return fmt::format("{:.6g} {}", value * units.size(dimension), units.symbol(dimension));
}

[[noreturn]] void refuse(const NoSuchFlow& missing,
                         const ChuteQuestion& question,
                         const io::Units& units) {
  const bool depth = missing.missed == NoSuchFlow::Missed::depth;
  const auto dimension = depth ? is::length : is::mass_flow;
  const auto& wanted = depth ? question.depth : question.mass_flow;
  std::string text = "no steady flow";
  if (wanted) text += depth ? " is this deep, " : " carries ";
  if (wanted) text += with_unit(*wanted, dimension, units);
  if (missing.nearest) text += "; the nearest: " + with_unit(*missing.nearest, dimension, units);
  throw NoAnswer(text + ": " + missing.what());
}

ChuteQuestion question_of(const io::CaseFile& file) {
  ChuteQuestion question{.chute = file.chute, .depth = file.depth, .mass_flow = file.mass_flow};
  if (!file.tilt_sought) question.inclination = file.chute.inclination;
  if (!file.depth && file.chute.mass_per_area > 0.0)
    question.mass_per_area = file.chute.mass_per_area;
  return question;
}

/// One line; its error only where it was found, not given.
struct Line {
  Summary& summary;
  const io::Units& units;

  void add(const char* key,
           const char* label,
           double value,
           io::Dimension dimension,
           double error = 0.0) const {
    const double size = units.size(dimension);
    if (error > 0.0)
      summary.add_estimate(key, label, value * size, error * size, units.symbol(dimension));
    else
      summary.add(key, label, value * size, units.symbol(dimension));
  }
};

/// The tilt or the mass at which the search ended, in words.
std::string place(const FoundChute& at, bool tilt, const io::Units& units) {
  return tilt ? fmt::format("{:.5g} degrees", io::degrees(at.chute.inclination))
              : with_unit(at.chute.mass_per_area, is::mass_per_area, units);
}

void describe_largest(Summary& summary,
                      const continuum::LargestFlow& largest,
                      const io::CaseFile& file) {
  const bool tilt = file.tilt_sought;
  const io::Units& units = file.units;
  summary.heading("Largest steady flow");
  summary.add("largest_ended_by", "ended by", std::string(largest.ended_by_data ? "data" : "law"));
  summary.add("largest_text",
              "  in words",
              largest.ended_by_data
                  ? fmt::format("the flow below: at {} I reaches the highest of the data",
                                place(largest.found, tilt, units))
                  : fmt::format("the flow below: at {} the law has its largest",
                                place(largest.found, tilt, units)));
  const double limit =
      tilt ? io::degrees(largest.law_limit) : largest.law_limit * units.size(is::mass_per_area);
  if (largest.law_end == Outcome::steady) {
    summary.add("law_limit", "limit of the law", limit, units.symbol(is::mass_per_area));
    summary.add("law_limit_text",
                "  in words",
                std::string("side walls hold at rest all that lies deeper"));
  } else {
    summary.add("law_limit",
                "limit of the law",
                limit,
                tilt ? std::string("degrees") : units.symbol(is::mass_per_area));
    summary.add("law_limit_outcome", "  beyond it", std::string(name(largest.law_end)));
  }
  if (largest.law) {
    summary.add("law_mass_flow",
                "  its largest flow",
                largest.law->mass_flow * units.size(is::mass_flow),
                units.symbol(is::mass_flow));
    summary.add("law_largest_at", "  which is at", place(*largest.law, tilt, units));
  } else {
    summary.add("law_flow_text",
                "  its largest flow",
                std::string("none: it grows without limit towards there"));
  }
}

}  // namespace

continuum::SteadyChute steady_with_band(const continuum::RheologyTable& table,
                                        continuum::ChuteCase& chute,
                                        const std::optional<double>& depth) {
  if (!depth) {
    continuum::SteadyChute steady = continuum::steady_chute(table, chute);
    continuum::add_error_band(steady, table, chute);
    return steady;
  }
  const ChuteQuestion question{.chute = chute, .inclination = chute.inclination, .depth = depth};
  try {
    FoundChute found = continuum::find_chute(table, question);
    chute = found.chute;
    continuum::add_error_band(found.steady, table, chute);
    return std::move(found.steady);
  } catch (const NoSuchFlow& missing) {
    refuse(missing, question, io::grain_units());
  }
}

namespace {

std::optional<continuum::ChuteErrors> errors_of(const SteadyAnswer& answer,
                                                const continuum::RheologyTable& table,
                                                const ChuteQuestion& question) {
  const bool by_data = answer.largest && answer.largest->ended_by_data && !question.inclination;
  return continuum::search_errors(table, [&](const continuum::RheologyTable& moved) {
    if (by_data) return continuum::end_of_data(moved, question);
    if (answer.largest) return continuum::largest_flow(moved, question).found;
    return continuum::find_chute(moved, question);
  });
}

}  // namespace

SteadyAnswer answer_steady(const continuum::RheologyTable& table, io::CaseFile& file) {
  const ChuteQuestion question = question_of(file);
  const bool largest = file.question == io::Question::largest_flow;
  try {
    SteadyAnswer answer;
    if (largest) answer.largest = continuum::largest_flow(table, question);
    FoundChute found = largest ? answer.largest->found : continuum::find_chute(table, question);
    file.chute = found.chute;
    answer.mass_flow = found.mass_flow;
    answer.steady = std::move(found.steady);
    if (flows(answer.steady.answer.outcome)) answer.errors = errors_of(answer, table, question);
    continuum::add_error_band(answer.steady, table, file.chute);
    return answer;
  } catch (const NoSuchFlow& missing) {
    refuse(missing, question, file.units);
  }
}

void describe(Summary& summary, const SteadyAnswer& answer, const io::CaseFile& file) {
  const auto& [outcome, text, time, flags, condition] = answer.steady.answer;
  const continuum::Profile& profile = answer.steady.profile;
  const Line line{summary, file.units};
  const continuum::ChuteErrors errors = answer.errors.value_or(continuum::ChuteErrors{});
  if (answer.largest) describe_largest(summary, *answer.largest, file);
  summary.heading("Steady flow");
  summary.add("outcome", "answer", std::string(name(outcome)));
  summary.add("text", "  in words", text);
  const double tilt = io::degrees(file.chute.inclination);
  if (file.tilt_sought && errors.inclination > 0.0)
    summary.add_estimate("inclination", "tilt", tilt, io::degrees(errors.inclination), "degrees");
  else
    summary.add("inclination", "tilt", tilt, "degrees");
  line.add("mass_per_area",
           "mass per area",
           file.chute.mass_per_area,
           is::mass_per_area,
           errors.mass_per_area);
  if (profile.rows.empty()) return;
  line.add(
      "height", "free surface at", profile.height, is::length, file.depth ? 0.0 : errors.height);
  line.add("mass_flow",
           "mass flow per width",
           answer.mass_flow,
           is::mass_flow,
           file.mass_flow ? 0.0 : errors.mass_flow);
  line.add("flux", "flux int phi v dz", profile.flux, is::flux);
  const double velocity = file.units.size(is::velocity);
  summary.add_estimate("surface_velocity",
                       "surface velocity",
                       profile.surface_velocity * velocity,
                       errors.surface_velocity * velocity,
                       file.units.symbol(is::velocity));
}

void describe_depth(Summary& summary,
                    const continuum::RheologyTable& table,
                    const continuum::Profile& profile,
                    const io::CaseFile& file) {
  const auto layer = continuum::thin_layer(table, file.chute, profile);
  if (!layer) return;
  const Line line{summary, file.units};
  line.add("flowing_depth", "flowing depth", layer->flowing_depth, is::length);
  line.add("stop_depth", "  h_stop, estimate", layer->stop_depth, is::length);
  summary.add("thin", "  THIN, below h_stop", layer->thin());
  if (layer->thin())
    summary.add(
        "thin_text",
        "  in words",
        std::string("a rough base would probably hold so thin a layer at rest, of which a "
                    "local law knows nothing (nonlocal fluidity, A = 0.48 of glass beads)"));
}

}  // namespace grainlaw
