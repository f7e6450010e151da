#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "apps/report/law_curve.h"
#include "apps/report/numbers.h"
#include "apps/report/sections.h"

namespace grainlaw::report {
namespace {

using calibration::SampleKind;

/// One line of the summary: what it is about, and a sentence.
struct Line {
  Html topic;
  Html sentence;
};

dem::Estimate estimate_of(const continuum::RheologyTable& table, const std::string& name) {
  for (const Coefficient& coefficient : coefficients(table)) {
    if (coefficient.name == name) return coefficient.estimate;
  }
  return {};
}

Html coefficient_text(const continuum::RheologyTable& table, const std::string& name) {
  const std::string unit = coefficient_unit(name, table.units);
  return coefficient_symbol(name) + " = "_html + text(with_error(estimate_of(table, name))) +
         text(unit == "1" ? "" : " " + unit);
}

std::string fitted_tilts(const Report& report) {
  std::vector<double> tilts;
  for (const auto& point : report.fit->points) tilts.push_back(point.inclination);
  std::sort(tilts.begin(), tilts.end());
  std::string result;
  for (const double tilt : tilts) result += (result.empty() ? "" : ", ") + degrees(tilt);
  return result;
}

Html origin(const Report& report) {
  if (!report.fit) return text(", from " + report.table.provenance.source);
  return text(
      fmt::format(", fitted to {} DEM runs ({})", report.fit->points.size(), fitted_tilts(report)));
}

Html range_text(const continuum::RheologyTable& table) {
  const auto& range = table.range.inertial_number;
  if (!range) return {};
  return "; data from <i>I</i> = "_html + text(significant(range->lower, 2)) + " to "_html +
         text(significant(range->upper, 2));
}

Line friction_line(const Report& report) {
  const continuum::RheologyTable& table = report.table;
  if (std::holds_alternative<continuum::GeneralisedBagnold>(table.law)) {
    return {"Law"_html,
            "<i>τ</i> − <i>τ<sub>c</sub></i> = <i>a</i> <i>γ̇</i>² + <i>b</i> <i>γ̇</i>, "_html +
                coefficient_text(table, "a") + ", "_html + coefficient_text(table, "b") +
                origin(report) + "."_html};
  }
  const auto& law = std::get<continuum::MuPhi>(table.law);
  const bool curved = law.friction.kappa > 0.0;
  Html sentence = "<i>μ</i>(<i>I</i>) = <i>μ</i><sub>0</sub> + <i>β</i><i>I</i>"_html;
  sentence += curved ? "/(1 + <i>κ</i><i>I</i>)"_html : Html{};
  sentence += " with "_html + coefficient_text(table, "mu0") + ", "_html;
  sentence += coefficient_text(table, "beta");
  sentence += curved ? ", "_html + coefficient_text(table, "kappa") : Html{};
  return {"Friction law"_html, sentence + origin(report) + range_text(table) + "."_html};
}

std::optional<Line> volume_fraction_line(const Report& report) {
  if (!std::holds_alternative<continuum::MuPhi>(report.table.law)) return std::nullopt;
  return Line{
      "Volume fraction"_html,
      "<i>φ</i>(<i>I</i>) = <i>φ</i><sub>0</sub> (1 − <i>I</i>/<i>I<sub>φ</sub></i>) with "_html +
          coefficient_text(report.table, "phi0") + ", "_html +
          coefficient_text(report.table, "I_phi") + "."_html};
}

std::optional<Line> not_identifiable_line(const Report& report) {
  if (!report.fit) return std::nullopt;
  std::vector<Html> sentences;
  for (const auto* fit : {&report.fit->friction, &report.fit->volume_fraction}) {
    for (const std::string& sentence : fit->not_identifiable) sentences.push_back(text(sentence));
  }
  if (sentences.empty()) return Line{"Identifiable"_html, "Every fitted coefficient."_html};
  return Line{"Not identifiable"_html, join(sentences, " "_html)};
}

Html error_of_run(const RunComparison& run) {
  Html result = text(degrees(run.data.conditions.inclination)) + ": "_html;
  if (!run.error)
    return result + "no profile ("_html + text(continuum::name(run.steady.answer.outcome)) +
           ")"_html;
  result += "<b>"_html + text(percent(run.error->velocity)) + "</b>"_html;
  if (run.naive_error) {
    result += " (naive guess "_html + text(percent(run.naive_error->velocity)) + ")"_html;
  }
  return result;
}

std::optional<Line> error_line(const Report& report, SampleKind kind, const Html& topic) {
  const auto runs = runs_of(report, kind);
  if (runs.empty()) return std::nullopt;
  std::vector<Html> parts;
  for (const RunComparison* run : runs) parts.push_back(error_of_run(*run));
  return Line{topic, "Velocity error at "_html + join(parts, "; "_html) + "."_html};
}

std::string flow_count(const Report& report, const std::string& geometry, const char* words) {
  const auto number = std::ranges::count(report.flows, geometry, [](const FlowComparison& flow) {
    return flow.data.conditions.geometry;
  });
  return number > 0 ? fmt::format("{} {}", number, words) : std::string();
}

std::optional<Line> flow_line(const Report& report) {
  std::vector<Html> parts;
  for (const std::string& part : {flow_count(report, "simple_shear", "of simple shear"),
                                  flow_count(report, "plane_shear", "of plane shear"),
                                  flow_count(report, "body_force_box", "of body-force boxes"),
                                  flow_count(report, "split_bottom", "of ring cells")}) {
    if (!part.empty()) parts.push_back(text(part));
  }
  if (parts.empty()) return std::nullopt;
  return Line{
      "Other flows"_html,
      "Runs "_html + join(parts, ", "_html) +
          R"(: see <a href="#flows">below</a>, and <a href="#scores">all errors</a>.)"_html};
}

Html in_words(const calibration::Stretch& stretch, double time_unit) {
  std::string words = stretch_title(stretch) + ": " + significant(100.0 * stretch.error, 2) + " %";
  const auto& stop = stretch.stop;
  if (stop && stop->measured && stop->predicted) {
    words += fmt::format(", stopped after {}, predicted {}",
                         with_error(scaled(*stop->measured, 1.0 / time_unit)),
                         significant(*stop->predicted / time_unit, 3));
  } else if (stop) {
    words += stop->measured ? ", stopped, predicted to flow on" : ", flows on, predicted to stop";
  }
  return text(words);
}

std::optional<Line> in_time_line(const Report& report) {
  std::vector<Html> parts;
  for (const RunComparison& run : report.runs) {
    for (const calibration::Stretch& stretch : run.in_time) {
      if (std::isfinite(stretch.error))
        parts.push_back(in_words(stretch, scales(run.data.conditions).time));
    }
  }
  if (parts.empty()) return std::nullopt;
  return Line{"In time"_html,
              "Nobody fitted it. Error of the velocity profile in time (rms), relative to the "
              "steady profile: "_html +
                  join(parts, "; "_html) + "."_html};
}

Line answers_line(const Report& report) {
  std::map<std::string, int> counts;
  std::vector<Html> others;
  for (const RunComparison& run : report.runs) {
    const continuum::Answer& answer = run.steady.answer;
    ++counts[std::string(continuum::name(answer.outcome))];
    if (answer.outcome != continuum::Outcome::steady) {
      others.push_back(text(degrees(run.data.conditions.inclination) + ": " + answer.text));
    }
  }
  std::vector<Html> parts;
  for (const auto& [outcome, number] : counts) {
    parts.push_back(text(fmt::format("{} {}", number, outcome)));
  }
  const Html end = others.empty() ? "."_html : ". "_html + join(others, " "_html);
  return {"Answers"_html, join(parts, ", "_html) + end};
}

/// Flags of one quantity over all runs.
struct Excursion {
  std::string tilts;
  continuum::RangeFlag widest;
};

std::map<std::string, Excursion> excursions(const Report& report) {
  std::map<std::string, Excursion> result;
  for (const RunComparison& run : report.runs) {
    for (const continuum::RangeFlag& flag : run.steady.answer.out_of_domain) {
      auto& [tilts, widest] = result.try_emplace(flag.quantity, Excursion{{}, flag}).first->second;
      tilts += (tilts.empty() ? "" : ", ") + degrees(run.data.conditions.inclination);
      widest.reached_lowest = std::min(widest.reached_lowest, flag.reached_lowest);
      widest.reached_highest = std::max(widest.reached_highest, flag.reached_highest);
    }
  }
  return result;
}

Line range_line(const Report& report) {
  std::vector<Html> parts;
  for (const auto& [quantity, excursion] : excursions(report)) {
    const continuum::RangeFlag& flag = excursion.widest;
    parts.push_back(text(fmt::format("{} at {} (reached {}, data {})",
                                     quantity,
                                     excursion.tilts,
                                     interval(flag.reached_lowest, flag.reached_highest),
                                     interval(flag.lower, flag.upper))));
  }
  if (parts.empty()) {
    return {"Range"_html, "Every prediction stays inside the range of the data."_html};
  }
  return {"Outside the data"_html, join(parts, "; "_html) + "."_html};
}

std::optional<Line> condition_line(const Report& report) {
  std::vector<Html> parts;
  for (const RunComparison& run : report.runs) {
    const double number = run.steady.answer.condition_number;
    if (!(number > 0.0)) continue;
    parts.push_back(text(degrees(run.data.conditions.inclination) + ": " + significant(number, 2)));
  }
  if (parts.empty()) return std::nullopt;
  return Line{"Condition number"_html,
              "An error of 1 % in <i>μ</i> becomes so many % in <i>I</i> and velocity: "_html +
                  join(parts, "; "_html) + "."_html};
}

Line cost_line(const Report& report) {
  double measured = 0.0;
  double predicted = 0.0;
  for (const RunComparison& run : report.runs) {
    measured += run.data.summary.wall_seconds;
    predicted += run.predict_seconds;
  }
  const double fitted =
      report.fit ? report.fit->friction.wall_seconds + report.fit->volume_fraction.wall_seconds
                 : 0.0;
  std::string sentence = "DEM " + duration(measured) + " (sum over the runs)";
  if (report.fit) sentence += ", fit " + duration(fitted);
  sentence += fmt::format(", all {} predictions {}.", report.runs.size(), duration(predicted));
  return {"Run time"_html, text(sentence)};
}

std::vector<Line> lines(const Report& report) {
  std::vector<Line> result = {friction_line(report)};
  const auto add = [&](const std::optional<Line>& line) {
    if (line) result.push_back(*line);
  };
  add(volume_fraction_line(report));
  add(not_identifiable_line(report));
  add(error_line(report, SampleKind::in_sample, "In sample"_html));
  add(error_line(report, SampleKind::leave_one_out, "Left out"_html));
  add(error_line(report, SampleKind::interpolation, "Interpolation"_html));
  add(error_line(report, SampleKind::extrapolation, "Extrapolation"_html));
  add(error_line(report, SampleKind::cross_geometry, "Cross geometry"_html));
  add(error_line(report, SampleKind::independent, "Independent table"_html));
  add(flow_line(report));
  if (report.runs.empty()) return result;
  add(in_time_line(report));
  add(answers_line(report));
  add(range_line(report));
  add(condition_line(report));
  add(cost_line(report));
  return result;
}

Html warnings(const ReportHead& report) {
  std::vector<Html> items;
  for (const std::string& warning : report.warnings) items.push_back(text(warning));
  if (items.empty()) return {};
  return "<div class=\"note\"><strong>Warnings</strong>"_html + list(items) + "</div>\n"_html;
}

}  // namespace

Html summary_section(const Report& report) {
  Html content = "<dl class=\"summary\">\n"_html;
  for (const Line& line : lines(report)) {
    content += "<dt>"_html + line.topic + "</dt><dd>"_html + line.sentence + "</dd>\n"_html;
  }
  return section("summary", "What came out"_html, content + "</dl>\n"_html + warnings(report));
}

Html summary_section(const SeriesReport& report) {
  return section("summary", "What came out"_html, warnings(report));
}

}  // namespace grainlaw::report
