#include <fmt/format.h>

#include "apps/report/sections.h"
#include "apps/report/style_sheet.h"

namespace grainlaw::report {
namespace {

Html head(const Report& report) {
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

Html made_by(const Report& report) {
  if (report.command.empty()) return {};
  return R"(<p class="made">Made by <code>)"_html + text(report.command) + "</code></p>\n"_html;
}

Html contents(const Report& report) {
  const std::vector<std::pair<std::string_view, std::string_view>> parts = {
      {"summary", "Summary"},
      {"law", "Law"},
      {"predictions", "Steady profiles"},
      {"start", "Start-up"},
      {"flows", "Other flows"},
      {"scores", "Errors by kind"},
      {"bagnold", "Bagnold law"},
      {"certificate", "Well-posedness"},
      {"time", "Error against run time"},
      {"cost", "Run time"},
      {"health", "Health"},
      {"answers", "Answers"},
      {"reading", "How to read this"}};
  Html result = "<nav>"_html;
  for (const auto& [id, title] : parts) {
    if (id == "flows" && report.flows.empty()) continue;
    if (id == "scores" && report.tables.empty()) continue;
    result += Html{fmt::format("<a href=\"#{}\">{}</a> ", id, title)};
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

}  // namespace

Html show(const FigureGroup& group, const Pictures& pictures) {
  if (group.figures.empty()) return {};
  Html result;
  if (!group.title.markup.empty()) result += "<h3>"_html + group.title + "</h3>\n"_html;
  const bool wide = group.figures.size() <= 2;
  result += wide ? "<div class=\"figures two\">\n"_html : "<div class=\"figures\">\n"_html;
  for (const Figure& figure : group.figures) result += picture(figure, pictures);
  return result + "</div>\n"_html;
}

Figures figures(const Report& report) {
  Figures result{.law = law_figures(report),
                 .profiles = {},
                 .starts = {},
                 .flows = {},
                 .time = time_figures(report)};
  if (!report.flows.empty()) result.flows = flow_figures(report);
  for (std::size_t k = 0; k < report.runs.size(); ++k) {
    result.profiles.push_back(profile_figures(report.runs[k], k + 1));
    result.starts.push_back(start_figures(report.runs[k], k + 1));
  }
  return result;
}

std::string page(const Report& report, const Figures& figures, const Pictures& pictures) {
  const Html body = "<h1>"_html + text(report.title) + "</h1>\n"_html + made_by(report) +
                    contents(report) + missing_pictures(pictures) + summary_section(report) +
                    law_section(report, figures.law, pictures) +
                    prediction_section(report, figures.profiles, pictures) +
                    start_section(report, figures.starts, pictures) +
                    flow_section(report, figures.flows, pictures) + score_section(report) +
                    bagnold_section(report) + certificate_section(report) +
                    time_section(report, figures.time, pictures) + cost_section(report) +
                    health_section(report) + answer_section(report) + reading_section();
  return "<!DOCTYPE html>\n<html lang=\"en\">\n" + head(report).markup + "<body>\n" + body.markup +
         "</body>\n</html>\n";
}

}  // namespace grainlaw::report
