#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/law_curve.h"
#include "apps/report/material_law.h"
#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::FitSummary;
using calibration::FittedCoefficient;
using calibration::LawInformation;
using calibration::ModelScore;
using calibration::RunInformation;

/// "0.34 to 0.58", "above 0.34" where the data set no upper limit.
std::string limits(const calibration::Interval& interval) {
  const bool low = std::isfinite(interval.lower);
  const bool high = std::isfinite(interval.upper);
  if (!low && !high) return "no limits";
  if (!high) return "above " + significant(interval.lower, 3);
  if (!low) return "below " + significant(interval.upper, 3);
  const std::string words =
      significant(interval.lower, 3) + " to " + significant(interval.upper, 3);
  return interval.by_profile ? words + " (profile)" : words;
}

/// Value of a coefficient in the table that is compared with; none where it has no such term.
std::optional<dem::Estimate> reference_value(const MaterialReport& material,
                                             const std::string& name) {
  if (!material.reference) return std::nullopt;
  const auto* law = std::get_if<continuum::MuPhi>(&material.reference->law);
  if (law && law->friction.kappa > 0.0 && name == "mu_inf") {
    return dem::Estimate{law->friction.mu0 + law->friction.beta / law->friction.kappa, 0.0};
  }
  if (law && law->friction.kappa > 0.0 && name == "I_mu") {
    return dem::Estimate{1.0 / law->friction.kappa, 0.0};
  }
  for (const Coefficient& coefficient : coefficients(*material.reference)) {
    if (coefficient.name == name) return coefficient.estimate;
  }
  return std::nullopt;
}

void add_reference_cells(const MaterialReport& material,
                         const FittedCoefficient& coefficient,
                         std::vector<Html>& cells) {
  if (!material.reference) return;
  const auto reference = reference_value(material, coefficient.name);
  if (!reference) {
    cells.insert(cells.end(), {text("–"), text("–")});
    return;
  }
  const double other = std::isfinite(reference->error) ? reference->error : 0.0;
  const double difference =
      (coefficient.value - reference->value) / std::hypot(coefficient.error, other);
  cells.push_back(text(significant(reference->value, 4)));
  cells.push_back(text(fixed(difference, 1)));
}

Table coefficient_table(const MaterialReport& material,
                        const std::string& law,
                        const FitSummary& fit) {
  Table result{
      .caption = fit_caption(law, fit),
      .head = {"Coefficient"_html, "Value"_html, "Standard error"_html, "95 % interval"_html},
      .rows = {},
      .text_columns = 1};
  if (material.reference) {
    result.head.push_back(code(material.reference_name));
    result.head.push_back("Difference [s.e.]"_html);
  }
  const auto add = [&](const FittedCoefficient& coefficient) {
    std::vector<Html> cells = {coefficient_symbol(coefficient.name)};
    for (Html& cell : value_cells({.value = coefficient.value, .error = coefficient.error})) {
      cells.push_back(std::move(cell));
    }
    cells.push_back(text(limits(coefficient.interval)));
    add_reference_cells(material, coefficient, cells);
    result.rows.push_back(std::move(cells));
  };
  for (const FittedCoefficient& coefficient : fit.coefficients) add(coefficient);
  if (!fit.derived.empty()) result.rows.push_back({"Derived"_html});
  for (const FittedCoefficient& coefficient : fit.derived) add(coefficient);
  return result;
}

Table score_table(const Html& caption, const std::vector<ModelScore>& scores) {
  Table result{.caption = caption,
               .head = {"Law"_html,
                        "Coefficients"_html,
                        "<i>χ</i>²"_html,
                        "AICc"_html,
                        "above the best"_html,
                        "Chosen"_html},
               .rows = {},
               .text_columns = 1};
  double best = std::numeric_limits<double>::infinity();
  for (const ModelScore& score : scores) best = std::min(best, score.aicc);
  for (const ModelScore& score : scores) {
    result.rows.push_back({typeset(score.name),
                           text(std::to_string(score.coefficients)),
                           text(significant(score.chi_squared, 4)),
                           text(fixed(score.aicc, 2)),
                           text(fixed(score.aicc - best, 2)),
                           text(score.chosen ? "yes" : "")});
  }
  return result;
}

Html score_tables(const calibration::MaterialFit& fit) {
  Html result;
  if (!fit.families.empty()) {
    result += table(
        score_table("Families of the friction law, same data and weights."_html, fit.families));
  }
  if (fit.friction_models.size() > 1) {
    result +=
        table(score_table("Friction: terms dropped one at a time."_html, fit.friction_models));
  }
  if (fit.fraction_models.size() > 1) {
    result += table(
        score_table("Volume fraction: terms dropped one at a time."_html, fit.fraction_models));
  }
  return result;
}

std::string weight_text(double weight) {
  if (weight == 1.0) return "1";
  return weight > 0.0 ? significant(weight, 2) : "–";
}

Table point_table(const MaterialReport& material) {
  Table result{.caption =
                   "The points. Residuals in standard errors of the measured value; weight: – left "
                   "out, below 1 weighed less."_html,
               .head = {"Point"_html,
                        "<i>I</i>"_html,
                        "<i>p</i>*"_html,
                        "Bo"_html,
                        "<i>μ</i>"_html,
                        "residual"_html,
                        "weight"_html,
                        "<i>φ</i>"_html,
                        "residual"_html,
                        "weight"_html},
               .rows = {},
               .text_columns = 1};
  for (std::size_t i = 0; i < material.points.size(); ++i) {
    const calibration::StatePoint& point = material.points[i];
    const LawValue left = residual(material, point);
    result.rows.push_back({code(point.name),
                           text(significant(point.inertial_number.value, 3)),
                           text(significant(point.softness.value, 3)),
                           text(significant(point.bond_number.value, 3)),
                           text(with_error(point.friction)),
                           text(fixed(left.friction, 1)),
                           text(weight_text(material.fit.friction_weight[i])),
                           text(with_error(point.volume_fraction)),
                           text(fixed(left.volume_fraction, 1)),
                           text(weight_text(material.fit.fraction_weight[i]))});
  }
  return result;
}

/// The coefficient that is known worse by most without the run.
Html most_for(const LawInformation& information, const RunInformation& run) {
  const auto largest = std::max_element(run.error_increase.begin(), run.error_increase.end());
  if (largest == run.error_increase.end()) return text("–");
  const auto k = static_cast<std::size_t>(largest - run.error_increase.begin());
  const Html name = coefficient_symbol(information.coefficients[k]);
  if (!std::isfinite(*largest)) return name + text(", unknown without it");
  return name + text(fmt::format(": +{} %", fixed(100.0 * *largest, 1)));
}

Table information_table(const Html& law, const LawInformation& information) {
  constexpr std::size_t most_rows = 12;
  Table result{.caption = law +
                          ": what each run tells, most per second first. Gain: rise of "
                          "ln det(covariance) when the run is left out, to first order."_html,
               .head = {"Run"_html,
                        "Points"_html,
                        "Wall time"_html,
                        "Gain"_html,
                        "Gain per 1000 s"_html,
                        "Error without it, largest"_html},
               .rows = {},
               .text_columns = 1};
  for (std::size_t i = 0; i < std::min(most_rows, information.runs.size()); ++i) {
    const RunInformation& run = information.runs[i];
    result.rows.push_back({code(run.run),
                           text(std::to_string(run.points)),
                           text(run.wall_seconds > 0.0 ? duration(run.wall_seconds) : "–"),
                           text(significant(run.gain, 3)),
                           text(significant(1000.0 * run.gain_per_second, 3)),
                           most_for(information, run)});
  }
  if (information.runs.size() > most_rows) {
    result.rows.push_back(
        {text(fmt::format("{} more runs in report.json", information.runs.size() - most_rows))});
  }
  return result;
}

Table cost_table(const MaterialReport& material, const FitSummary& fit, bool friction) {
  Table result{.caption = friction ? "Friction law from a part of the averaging time."_html
                                   : "Volume fraction law from a part of the averaging time."_html,
               .head = {"Share"_html, "DEM time"_html, "Scatter [s.e.]"_html},
               .rows = {},
               .text_columns = 1};
  for (const FittedCoefficient& c : fit.coefficients) {
    result.head.push_back(coefficient_symbol(c.name));
  }
  for (const calibration::CostPoint& point : material.cost) {
    std::vector<Html> cells = {
        text(point.share < 1.0 ? fmt::format("1/{:.0f}", 1.0 / point.share) : "all"),
        text(duration(point.dem_wall_seconds))};
    if (!point.failure.empty()) {
      cells.push_back(text(point.failure));
    } else {
      cells.push_back(
          text(significant(friction ? point.friction_scatter : point.fraction_scatter, 2)));
      for (const auto& value : friction ? point.friction : point.volume_fraction) {
        cells.push_back(text(with_error(value)));
      }
    }
    result.rows.push_back(std::move(cells));
  }
  return result;
}

Html cost_part(const MaterialReport& material,
               const std::vector<FigureGroup>& groups,
               const Pictures& pictures) {
  Html result = "<h3>What the coefficients cost</h3>\n"_html;
  result += table(information_table("Friction"_html, material.friction_information));
  result += table(information_table("Volume fraction"_html, material.fraction_information));
  if (material.cost.empty()) {
    return result + paragraph(
                        "Error against averaging time is not known: the runs have no "
                        "frames."_html);
  }
  result += table(cost_table(material, material.fit.friction, true));
  result += table(cost_table(material, material.fit.volume_fraction, false));
  result += paragraph(
      "Errors fall as one over the root of the time while noise limits them. Where the scatter "
      "stands well above 1 and grows with time instead, the form of the law limits: more "
      "averaging does not help, another law or a narrower range does."_html);
  return result + show(groups.back(), pictures);
}

std::size_t used(const std::vector<double>& weights) {
  return static_cast<std::size_t>(
      std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0.0; }));
}

Html introduction(const MaterialReport& material) {
  const calibration::MaterialFit& fit = material.fit;
  Html result = paragraph(text(fmt::format(
      "{} points, {} of them fitted for friction and {} for volume fraction. The covariance of the "
      "table joins both laws through the runs they share.",
      material.points.size(),
      used(fit.friction_weight),
      used(fit.fraction_weight))));
  std::vector<Html> items;
  for (const std::string& sentence : material.left_out) items.push_back(typeset(sentence));
  if (items.empty()) return result;
  return result + R"(<div class="aside">Without a point:)"_html + long_list(items, "runs") +
         "</div>\n"_html;
}

}  // namespace

Html material_section(const MaterialReport& material,
                      const std::vector<FigureGroup>& groups,
                      const Pictures& pictures) {
  const calibration::MaterialFit& fit = material.fit;
  Html content = introduction(material);
  content += table(coefficient_table(material, "Friction μ(I, p*, Bo)", fit.friction));
  content += fit_remarks(fit.friction);
  content +=
      table(coefficient_table(material, "Volume fraction φ(I, p*, Bo)", fit.volume_fraction));
  content += fit_remarks(fit.volume_fraction);
  for (std::size_t k = 0; k + 1 < groups.size(); ++k) content += show(groups[k], pictures);
  constexpr std::size_t most_points = 60;
  content += score_tables(fit);
  content += folded(material.points.size(), most_points, "points", table(point_table(material)));
  content += cost_part(material, groups, pictures);
  return section("material", "Material laws of homogeneous flow"_html, content);
}

}  // namespace grainlaw::report
