#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "apps/report/law_curve.h"
#include "apps/report/law_formula.h"
#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

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

/// Of "C of C Bo^b" the C: the formula stands beside it.
Html short_symbol(const std::string& name) {
  const Html symbol = coefficient_symbol(name);
  return {symbol.markup.substr(0, symbol.markup.find(" of "))};
}

Html coefficient_text(const continuum::RheologyTable& table, const std::string& name) {
  const std::string unit = coefficient_unit(name, table.units);
  return short_symbol(name) + " = "_html + text(with_error(estimate_of(table, name))) +
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
  if (report.material)
    return text(fmt::format(", fitted to {} states", report.material->fit.friction.data));
  const std::string& source = report.table.provenance.source;
  if (!report.fit) return ", from "_html + typeset(source.substr(0, source.find(';')));
  return text(
      fmt::format(", fitted to {} DEM runs ({})", report.fit->points.size(), fitted_tilts(report)));
}

Html range_text(const continuum::RheologyTable& table) {
  const auto& range = table.range.inertial_number;
  if (!range) return {};
  return "; data from <i>I</i> = "_html + text(significant(range->lower, 2)) + " to "_html +
         text(significant(range->upper, 2));
}

/// Values of the coefficients of friction, or of volume fraction, as the table names them.
Html coefficient_list(const continuum::RheologyTable& table, bool friction) {
  std::vector<Html> parts;
  for (const Coefficient& coefficient : coefficients(table)) {
    const std::string& name = coefficient.name;
    const bool base = name == "no_slip_height" || name == "mass_below";
    const bool of_fraction = name == "phi0" || name == "I_phi" || name == "p_phi" ||
                             (name.size() == 2 && name[0] == 'p');
    const bool absent = table.covariance && std::isnan(coefficient.estimate.error) &&
                        coefficient.estimate.value == 0.0;
    if (!base && !absent && of_fraction != friction) parts.push_back(coefficient_text(table, name));
  }
  return join(parts, ", "_html);
}

Line friction_line(const Report& report) {
  const continuum::RheologyTable& table = report.table;
  if (std::holds_alternative<continuum::GeneralisedBagnold>(table.law)) {
    return {"Law"_html,
            "<i>τ</i> − <i>τ<sub>c</sub></i> = <i>a</i> <i>γ̇</i>² + <i>b</i> <i>γ̇</i>, "_html +
                coefficient_text(table, "a") + ", "_html + coefficient_text(table, "b") +
                origin(report) + "."_html};
  }
  return {"Friction law"_html,
          friction_formula(std::get<continuum::MuPhi>(table.law)) + " with "_html +
              coefficient_list(table, true) + origin(report) + range_text(table) + "."_html};
}

std::optional<Line> volume_fraction_line(const Report& report) {
  const auto* law = std::get_if<continuum::MuPhi>(&report.table.law);
  if (!law) return std::nullopt;
  return Line{
      "Volume fraction"_html,
      fraction_formula(*law) + " with "_html + coefficient_list(report.table, false) + "."_html};
}

/// How far the points of homogeneous flow lie from their laws.
std::optional<Line> scatter_line(const Report& report) {
  if (!report.material) return std::nullopt;
  const calibration::MaterialFit& fit = report.material->fit;
  const auto scatter = [](const calibration::FitSummary& of) {
    const double freedom = of.data - static_cast<double>(of.coefficients.size());
    return significant(std::sqrt(of.chi_squared / freedom), 2);
  };
  return Line{"Scatter"_html,
              text(fmt::format("The states lie {} (friction) and {} (volume fraction) standard "
                               "errors off the laws (rms); 1 is chance.",
                               scatter(fit.friction),
                               scatter(fit.volume_fraction)))};
}

std::optional<Line> not_identifiable_line(const Report& report) {
  if (!report.fit) return std::nullopt;
  std::vector<Html> sentences;
  for (const auto* fit : {&report.fit->friction, &report.fit->volume_fraction}) {
    for (const std::string& sentence : fit->not_identifiable)
      sentences.push_back(typeset(sentence));
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
  parts.reserve(runs.size());
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
  for (const std::string& part : {flow_count(report, "simple_shear", "simple shear"),
                                  flow_count(report, "plane_shear", "plane shear"),
                                  flow_count(report, "body_force_box", "body-force box"),
                                  flow_count(report, "split_bottom", "ring cell")}) {
    if (!part.empty()) parts.push_back(text(part));
  }
  if (parts.empty()) return std::nullopt;
  const bool one = report.flows.size() == 1;
  return Line{
      "Other flows"_html,
      join(parts, ", "_html) + text(one ? " run: " : " runs: ") +
          R"(<a href="#flows">profiles and states</a>, <a href="#scores">all errors</a>.)"_html};
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
      others.push_back(typeset(degrees(run.data.conditions.inclination) + ": " + answer.text));
    }
  }
  std::vector<Html> parts;
  parts.reserve(counts.size());
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
    parts.push_back(typeset(fmt::format("{} at {} (reached {}, data {})",
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
  std::string sentence = "DEM " + (measured > 0.0 ? duration(measured) : "not stated") +
                         (report.runs.size() > 1 ? " (sum over the chutes)" : "");
  if (report.fit) sentence += ", fit " + duration(fitted);
  const std::size_t runs = report.runs.size();
  sentence += runs == 1 ? ", the prediction " : fmt::format(", all {} predictions ", runs);
  sentence += duration(predicted) + ".";
  return {"Run time"_html, text(sentence)};
}

std::string share_text(std::size_t part, std::size_t all) {
  return part == all ? fmt::format("all {}", all) : fmt::format("{} of {}", part, all);
}

/// What a series of chutes says of Xi and of contacts.
std::vector<Line> series_lines(const calibration::ContactSeries& contacts) {
  constexpr std::size_t half = 1;  // of the height, among the three of a point
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  double least = low, most = 0.0;
  std::size_t told = 0;
  for (const calibration::ContactPoint& point : contacts.points) {
    const calibration::FittedCoefficient& xi = point.ratio[half];
    if (xi.interval.lower > 0.0) ++told;
    least = std::fmin(least, xi.interval.upper);
    most = std::fmax(most, xi.interval.upper);
    if (!point.tail_sampled) continue;
    low = std::fmin(low, point.long_lifetime.value);
    high = std::fmax(high, point.long_lifetime.value);
  }
  const std::size_t all = contacts.points.size();
  std::vector<Line> result = {{"Runs"_html, text(fmt::format("{} steady chutes.", all))}};
  if (all == 0) return result;
  result.push_back(
      {"<i>Ξ</i> at half height"_html,
       text(fmt::format(
           "Told from 0 in {} of the runs; upper ends of the 95 % "
           "intervals: {}.",
           told == 0 ? "none" : share_text(told, all),
           std::isfinite(most) ? interval(least, most) : significant(least, 2) + " to no limit"))});
  if (high > 0.0)
    result.push_back({"Long lifetimes"_html,
                      "<i>γ̇ τ<sub>l</sub></i> = "_html + text(interval(low, high)) + "."_html});
  for (const calibration::StiffnessLaws& laws : contacts.stiffness) {
    if (!laws.collision_rate) continue;
    const auto& rate = laws.collision_rate->rate;
    result.push_back({"Collisions"_html,
                      "<i>N<sub>c</sub></i> ∝ <i>k<sub>n</sub><sup>α</sup></i>, <i>α</i> = "_html +
                          text(fmt::format("{} ({}).",
                                           with_error({.value = rate.value, .error = rate.error}),
                                           laws.series))});
  }
  return result;
}

/// The law and its predictions are shown of one table only.
Line tables_line(const Report& report) {
  return {
      "Tables"_html,
      text(fmt::format("{}, ", report.tables.size())) +
          "side by side under <a href=\"#scores\">errors by kind</a>; what follows is of "_html +
          code(report.tables.front().name) + ", the first."_html};
}

std::vector<Line> lines(const Report& report) {
  std::vector<Line> result;
  if (report.tables.size() > 1) result.push_back(tables_line(report));
  result.push_back(friction_line(report));
  const auto add = [&](const std::optional<Line>& line) {
    if (line) result.push_back(*line);
  };
  add(volume_fraction_line(report));
  add(scatter_line(report));
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
  for (auto warning = report.warnings.begin(); warning != report.warnings.end(); ++warning) {
    const bool said = std::find(report.warnings.begin(), warning, *warning) != warning;
    if (!said) items.push_back(typeset(*warning));
  }
  if (items.empty()) return {};
  return R"(<div class="note"><strong>Warnings</strong>)"_html + list(items) + "</div>\n"_html;
}

Html summary_of(const std::vector<Line>& lines, const ReportHead& report) {
  Html content = "<dl class=\"summary\">\n"_html;
  for (const Line& line : lines) {
    content += "<dt>"_html + line.topic + "</dt><dd>"_html + line.sentence + "</dd>\n"_html;
  }
  return section("summary", "What came out"_html, content + "</dl>\n"_html + warnings(report));
}

}  // namespace

Html summary_section(const Report& report) {
  return summary_of(lines(report), report);
}

Html summary_section(const SeriesReport& report) {
  return summary_of(series_lines(report.contacts), report);
}

}  // namespace grainlaw::report
