#include <fmt/format.h>

#include <cmath>

#include "apps/report/cohesion_section.h"
#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::ContactPoint;
using calibration::FittedCoefficient;

Html interval_cell(const FittedCoefficient& c) {
  return text(
      with_interval({.value = c.value, .error = c.error}, c.interval.lower, c.interval.upper));
}

/// "2000", "2 × 10⁵": a number that somebody chose.
std::string stiffness_text(double stiffness) {
  return stiffness < 1e4 ? significant(stiffness, 4) : power_text(stiffness);
}

Table ratio_table(const calibration::ContactSeries& contacts, const std::string& law) {
  Table result{.caption =
                   "Rheology: <i>Ξ</i> = <i>b</i>/(<i>a</i> <i>γ̇</i>) with 95 % at three "
                   "shares of the flowing height."_html,
               .head = {"Series"_html,
                        "Run"_html,
                        "<i>k<sub>n</sub>d</i>/(<i>mg</i>)"_html,
                        "<i>Ξ</i>(<i>h</i>/4)"_html,
                        "<i>Ξ</i>(<i>h</i>/2)"_html,
                        "<i>Ξ</i>(3<i>h</i>/4)"_html},
               .rows = {},
               .text_columns = 2};
  if (!law.empty()) {
    result.head.push_back("<i>Ξ</i>(<i>h</i>/2) of the law"_html);
    result.caption +=
        " Of the law: the flow that the table "_html + code(law) +
        " predicts, fitted alike; its stress knows softness and a yield that depends on the "
        "pressure, and no lifetimes of contacts."_html;
  }
  for (const ContactPoint& point : contacts.points) {
    result.rows.push_back({text(point.series),
                           code(point.name),
                           text(stiffness_text(point.stiffness)),
                           interval_cell(point.ratio[0]),
                           interval_cell(point.ratio[1]),
                           interval_cell(point.ratio[2])});
    if (law.empty()) continue;
    result.rows.back().push_back(
        text(point.ratio_of_law ? significant(*point.ratio_of_law, 3) : "no flow"));
  }
  return result;
}

Table lifetime_table(const calibration::ContactSeries& contacts) {
  Table result{.caption =
                   "Contacts: lifetimes scaled with the shear rate <i>γ̇</i> of the slice; "
                   "<i>N<sub>c</sub></i>: contacts that begin, per grain and "
                   "√(<i>d</i>/<i>g</i>); <i>Z</i> = <i>N<sub>c</sub></i> times the mean."_html,
               .head = {"Run"_html,
                        "<i>γ̇ t</i><sub>mean</sub>"_html,
                        "<i>γ̇ t</i><sub>mode</sub>"_html,
                        "<i>γ̇ τ<sub>l</sub></i>"_html,
                        "<i>N<sub>c</sub></i>"_html,
                        "<i>Z</i>"_html,
                        "Contacts"_html},
               .rows = {},
               .text_columns = 1};
  for (const ContactPoint& point : contacts.points) {
    if (!point.has_lifetimes()) continue;
    result.rows.push_back(
        {code(point.name),
         text(significant(point.mean.value, 3)),
         text(significant(point.mode.value, 3)),
         text(point.tail_sampled ? with_error(point.long_lifetime) : "not sampled"),
         text(with_error(point.collision_rate)),
         text(with_error(point.coordination)),
         text(count(point.contacts))});
  }
  return result;
}

void add_law(Table& result,
             const std::string& series,
             const char* law,
             const std::optional<calibration::RatioLaw>& fit,
             const char* published) {
  if (!fit) return;
  result.rows.push_back({text(series),
                         Html{law},
                         interval_cell(fit->factor),
                         interval_cell(fit->rate),
                         text(published)});
}

Table law_table(const calibration::ContactSeries& contacts) {
  Table result{
      .caption =
          "Laws across the runs, coefficients with 95 %; the last column: Brewster "
          "et al. (2008), eqs. 11 and 14, figs. 3 and 7."_html,
      .head = {"Series"_html, "Law"_html, "Factor"_html, "Exponent or rate"_html, "Published"_html},
      .rows = {},
      .text_columns = 2};
  for (const calibration::StiffnessLaws& laws : contacts.stiffness) {
    const std::array symbols{"<i>Ξ</i>(<i>h</i>/4) = <i>J k<sub>n</sub><sup>α</sup></i>",
                             "<i>Ξ</i>(<i>h</i>/2) = <i>J k<sub>n</sub><sup>α</sup></i>",
                             "<i>Ξ</i>(3<i>h</i>/4) = <i>J k<sub>n</sub><sup>α</sup></i>"};
    for (std::size_t k = 0; k < symbols.size(); ++k) {
      add_law(result, laws.series, symbols[k], laws.ratio[k], "1.25 × 10⁵, −1.3");
    }
    add_law(result,
            laws.series,
            "<i>N<sub>c</sub></i> ∝ <i>k<sub>n</sub><sup>α</sup></i>",
            laws.collision_rate,
            "0.25");
    add_law(result,
            laws.series,
            "<i>t</i><sub>mean</sub> ∝ <i>k<sub>n</sub><sup>α</sup></i>",
            laws.mean_lifetime,
            "−0.5");
  }
  add_law(result,
          "all",
          "<i>Ξ</i> = <i>c</i><sub>1</sub> exp(<i>c</i><sub>2</sub> <i>γ̇ "
          "τ<sub>l</sub></i>)",
          contacts.lifetime_law,
          "0.03, 4.9");
  return result;
}

Html correlations(const calibration::ContactSeries& contacts) {
  std::string sentence;
  for (const calibration::RankCorrelation& one : contacts.correlations) {
    if (!std::isfinite(one.value)) continue;
    sentence += sentence.empty() ? "" : ", ";
    sentence += fmt::format("{} with {}", significant(one.value, 2), one.with);
  }
  const auto runs = contacts.correlations.empty() ? 0 : contacts.correlations[0].runs;
  const std::string subject = "Rank correlation of Xi at half height over all runs: ";
  if (sentence.empty())
    sentence = fmt::format("none, as {} runs are too few or all Xi alike.", runs);
  else
    sentence += fmt::format(" ({} runs).", runs);
  return paragraph(typeset(subject + sentence));
}

Html left_out(const calibration::ContactSeries& contacts) {
  std::vector<Html> items;
  for (const std::string& sentence : contacts.left_out) items.push_back(typeset(sentence));
  const auto add = [&](const std::optional<calibration::RatioLaw>& law) {
    if (!law) return;
    for (const std::string& sentence : law->summary.left_out) items.push_back(typeset(sentence));
  };
  for (const calibration::StiffnessLaws& laws : contacts.stiffness) add(laws.ratio[1]);
  add(contacts.lifetime_law);
  return items.empty() ? Html{} : "<h3>Left out</h3>\n"_html + list(items);
}

}  // namespace

Html series_section(const SeriesReport& series,
                    const std::vector<FigureGroup>& groups,
                    const Pictures& pictures) {
  const calibration::ContactSeries& contacts = series.contacts;
  Html content = table(ratio_table(contacts, series.law_name)) + table(lifetime_table(contacts));
  for (const FigureGroup& group : groups) content += show(group, pictures);
  const Table laws = law_table(contacts);
  if (!laws.rows.empty()) content += table(laws);
  if (series.cohesion) content += "<h3>Cohesion</h3>\n"_html + cohesion_tables(*series.cohesion);
  return section("series",
                 "Series: the linear stress and how long contacts last"_html,
                 content + correlations(contacts) + left_out(contacts));
}

}  // namespace grainlaw::report
