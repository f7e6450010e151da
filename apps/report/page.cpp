#include <fmt/format.h>

#include <algorithm>

#include "apps/report/sections.h"
#include "apps/report/style_sheet.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

Html head(const ReportHead& report) {
  return {fmt::format(R"(<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta name="generator" content="grainlaw"/>
<title>{}</title>
<style>{}</style>
</head>
)",
                      text(report.title).markup,
                      style_sheet)};
}

Html made_by(const ReportHead& report) {
  if (report.command.empty()) return {};
  return R"(<p class="made">Made by <code>)"_html + text(report.command) + "</code></p>\n"_html;
}

/// One part of the page and its place in the list of contents.
struct Part {
  std::string_view id, title;
  Html content;
};

bool followed_in_time(const Report& report) {
  return std::ranges::any_of(report.runs, [](const auto& run) { return !run.in_time.empty(); });
}

/// What follows from runs of chutes is left out of a report of other things.
std::vector<Part> parts_of(const Report& report, const Figures& figures, const Pictures& pictures) {
  const bool other = report.material || report.contact_friction || !report.flows.empty();
  const bool chutes = !other || !report.runs.empty();
  std::vector<Part> parts;
  const auto add = [&](bool there, std::string_view id, std::string_view title, auto content) {
    if (there) parts.push_back({id, title, content()});
  };
  const bool given = !report.flows.empty() && !report.material;
  const bool summary = !report.contact_friction || !report.warnings.empty();
  add(summary, "summary", "Summary", [&] { return summary_section(report); });
  add(!other || given || report.fit, "law", "Law", [&] {
    return law_section(report, figures.law, pictures);
  });
  add(report.material.has_value(), "material", "Material laws", [&] {
    return material_section(*report.material, figures.material, pictures);
  });
  add(report.contact_friction.has_value(), "contact-friction", "Contact friction", [&] {
    return contact_friction_section(*report.contact_friction, figures.contact_friction, pictures);
  });
  add(chutes, "predictions", "Steady profiles", [&] {
    return prediction_section(report, figures.profiles, pictures);
  });
  add(followed_in_time(report), "in-time", "In time", [&] {
    return in_time_section(report, figures.in_time, pictures);
  });
  add(!report.flows.empty(), "flows", "Other flows", [&] {
    return flow_section(report, figures.flows, pictures);
  });
  add(!report.tables.empty(), "scores", "Errors by kind", [&] { return score_section(report); });
  add(chutes, "bagnold", "Bagnold law", [&] { return bagnold_section(report); });
  add(report.table.has_friction, "certificate", "Well-posedness", [&] {
    return certificate_section(report);
  });
  add(!report.seeds.empty(), "seeds", "Seeds", [&] { return seed_section(report); });
  add(chutes && (report.fit || !report.error_against_time.empty()),
      "time",
      "Error against run time",
      [&] { return time_section(report, figures.time, pictures); });
  add(report.budget.has_value(), "budget", "Budget", [&] {
    return budget_section(*report.budget, figures.budget, pictures);
  });
  add(chutes || !report.costs.empty(), "cost", "Run time", [&] {
    return cost_section(report, report.runs);
  });
  add(chutes, "health", "Health", [&] { return health_section(report); });
  add(chutes, "answers", "Answers", [&] { return answer_section(report); });
  add(true, "reading", "How to read this", [&] { return reading_section(report); });
  return parts;
}

std::vector<Part> parts_of(const SeriesReport& report,
                           const std::vector<FigureGroup>& figures,
                           const Pictures& pictures) {
  std::vector<Part> parts;
  parts.push_back({"summary", "Summary", summary_section(report)});
  parts.push_back({"series", "Series", series_section(report, figures, pictures)});
  parts.push_back({"cost", "Run time", cost_section(report, {})});
  parts.push_back({"reading", "How to read this", reading_section(report)});
  return parts;
}

Html contents(const std::vector<Part>& parts) {
  Html result = "<nav>"_html;
  for (const Part& part : parts) {
    result += Html{fmt::format("<a href=\"#{}\">{}</a> ", part.id, part.title)};
  }
  return result + "</nav>\n"_html;
}

/// Said once, with the first reason met, instead of at every picture.
Html missing_pictures(const Pictures& pictures) {
  if (pictures.failures.empty()) return {};
  return "<div class=\"note\"><p><strong>Figures are missing</strong>: "_html +
         text(pictures.failures.begin()->second) +
         ". Their data (CSV) and gnuplot scripts stand in <code>plots/</code>; all numbers are in "
         "the tables and in <code>report.json</code>.</p></div>\n"_html;
}

Html picture(const Figure& figure, const Pictures& pictures) {
  const auto drawn = pictures.svg.find(figure.name);
  const Html content = drawn == pictures.svg.end() ? R"(<div class="missing">Not drawn.</div>)"_html
                                                   : Html{drawn->second};
  const Html source = {fmt::format(R"( (<a href="plots/{}.gp">script</a>))", figure.name)};
  return "<figure>"_html + content + "<figcaption>"_html + figure.caption + source +
         "</figcaption></figure>\n"_html;
}

std::string whole_page(const ReportHead& report,
                       const std::vector<Part>& parts,
                       const Pictures& pictures) {
  Html body = "<h1>"_html + typeset(report.title) + "</h1>\n"_html + made_by(report) +
              contents(parts) + missing_pictures(pictures);
  for (const Part& part : parts) body += part.content;
  return "<!DOCTYPE html>\n<html lang=\"en\">\n" + head(report).markup + "<body>\n" + body.markup +
         "</body>\n</html>\n";
}

}  // namespace

Html show(const FigureGroup& group, const Pictures& pictures) {
  if (group.figures.empty()) return {};
  Html result;
  if (!group.title.markup.empty()) result += "<h3>"_html + group.title + "</h3>\n"_html;
  const std::size_t number = group.figures.size();
  const char* columns = number <= 2 ? " two" : number == 4 ? " four" : "";
  result += Html{fmt::format("<div class=\"figures{}\">\n", columns)};
  for (const Figure& figure : group.figures) result += picture(figure, pictures);
  return result + "</div>\n"_html;
}

Figures figures(const Report& report) {
  Figures result;
  result.law = law_figures(report);
  result.time = time_figures(report);
  if (!report.flows.empty()) result.flows = flow_figures(report);
  if (report.budget) result.budget = budget_figures(*report.budget);
  if (report.material) result.material = material_figures(*report.material);
  if (report.contact_friction) {
    result.contact_friction = contact_friction_figures(*report.contact_friction);
  }
  for (std::size_t k = 0; k < report.runs.size(); ++k) {
    result.profiles.push_back(profile_figures(report.runs[k], k + 1));
    result.in_time.push_back(in_time_figures(report.runs[k], k + 1));
  }
  return result;
}

std::string page(const Report& report, const Figures& figures, const Pictures& pictures) {
  return whole_page(report, parts_of(report, figures, pictures), pictures);
}

std::string page(const SeriesReport& report,
                 const std::vector<FigureGroup>& figures,
                 const Pictures& pictures) {
  return whole_page(report, parts_of(report, figures, pictures), pictures);
}

}  // namespace grainlaw::report
