#include "apps/study_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/io/safe_write.h"
#include "apps/report/gnuplot.h"
#include "apps/report/html.h"
#include "apps/report/numbers.h"
#include "apps/report/style_sheet.h"
#include "apps/report/svg.h"
#include "apps/report/typeset.h"

namespace grainlaw::study {
namespace {

namespace fs = std::filesystem;
using report::Html;

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.10g}", value) : std::string{};
}

/// In quotes where a reader of CSV would take it apart (RFC 4180).
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

/// As one line of a table.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '|') c = ' ';
  }
  return text;
}

std::string seconds(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-";
}

std::string outcome(const Point& point) {
  if (point.failed()) return "no result: " + one_line(point.failure);
  return std::isfinite(point.error) ? error_text(point) : "-";
}

std::string list(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += "- " + sentence + "\n";
  return text;
}

/// Error of a point as a cell; a reason may take several lines.
Html outcome_cell(const Point& point) {
  using report::operator""_html;
  if (!point.failed()) return report::typeset(outcome(point));
  constexpr std::size_t most = 120;  // letters; all of a long reason stands in study.md
  std::string reason = outcome(point);
  const std::size_t part = reason.find(';');
  if (reason.size() > most && part != reason.npos) reason = reason.substr(0, part) + "; ...";
  return R"(<span class="prose short">)"_html + report::typeset(reason) + "</span>"_html;
}

/// Without the columns that would say nothing: a series named like its quantity, times of a run
/// that all points share.
Html point_table(const Result& result) {
  const bool series = std::ranges::any_of(
      result.points, [](const Point& point) { return point.series != point.quantity; });
  const bool timed = std::ranges::any_of(
      result.points, [](const Point& point) { return std::isfinite(point.cpu_seconds); });
  report::Table table;
  table.caption = report::typeset("Every point; error against " + result.reference);
  table.text_columns = series ? 3 : 2;
  const auto add = [](std::vector<Html>& row, bool there, Html cell) {
    if (there) row.push_back(std::move(cell));
  };
  add(table.head, true, report::text("Quantity"));
  add(table.head, series, report::text("Series"));
  add(table.head, true, report::text("Setting"));
  add(table.head, timed, report::text("CPU time"));
  add(table.head, timed, report::text("Wall time"));
  add(table.head, true, report::text("Error"));
  for (const Point& point : result.points) {
    std::vector<Html>& row = table.rows.emplace_back();
    add(row, true, report::typeset(point.quantity));
    add(row, series, report::typeset(point.series));
    add(row, true, report::typeset(point.setting));
    add(row, timed, report::text(report::duration(point.cpu_seconds)));
    add(row, timed, report::text(report::duration(point.wall_seconds)));
    add(row, true, outcome_cell(point));
  }
  return report::table(table);
}

/// "Error against CPU time", "Error against width of the kernel w / d".
std::string figure_title(const Result& result) {
  return "Error against " + result.cost_label.substr(0, result.cost_label.find(" ["));
}

Html sentences(const std::vector<std::string>& of) {
  std::vector<Html> items;
  for (const std::string& sentence : of) items.push_back(report::typeset(sentence));
  return report::list(items);
}

std::string page(const Result& result, const std::string& svg, const std::string& failure) {
  using report::operator""_html;
  const Html figure =
      svg.empty() ? report::paragraph(report::text("Not drawn: " + failure))
                  : "<figure style=\"max-width:48rem\">"_html + Html{svg} + "</figure>\n"_html;
  Html body = "<h1>"_html + report::typeset(result.title) + "</h1>\n"_html +
              report::paragraph(report::text(result.machine)) +
              report::section("choose", "What to choose"_html, sentences(result.advice)) +
              report::section("figure", report::text(figure_title(result)), figure);
  if (!result.remarks.empty()) {
    body += report::section("remarks", "Remarks"_html, sentences(result.remarks));
  }
  body += report::section("points", "Points"_html, point_table(result));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
      report::text(result.title).markup,
      report::style_sheet,
      body.markup);
}

}  // namespace

std::string csv_text(const Result& result) {
  std::string text =
      "quantity,series,setting,cost,cpu_seconds,wall_seconds,error,error_bar,failure\n";
  for (const Point& point : result.points) {
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n",
                        quoted(point.quantity),
                        quoted(point.series),
                        quoted(point.setting),
                        number(point.cost),
                        number(point.cpu_seconds),
                        number(point.wall_seconds),
                        number(point.error),
                        number(point.error_bar),
                        quoted(one_line(point.failure)));
  }
  return text;
}

std::string markdown_text(const Result& result) {
  std::string text = fmt::format("# {}\n\nKind: {}. Machine: {}.\nErrors are against: {}\n\n",
                                 result.title,
                                 result.kind,
                                 result.machine,
                                 result.reference);
  text +=
      "| quantity | series | setting | CPU [s] | wall [s] | error |\n"
      "|---|---|---|---|---|---|\n";
  for (const Point& point : result.points) {
    text += fmt::format("| {} | {} | {} | {} | {} | {} |\n",
                        one_line(point.quantity),
                        one_line(point.series),
                        one_line(point.setting),
                        seconds(point.cpu_seconds),
                        seconds(point.wall_seconds),
                        outcome(point));
  }
  if (!result.remarks.empty()) text += "\n## Remarks\n\n" + list(result.remarks);
  return text + "\n## What to choose\n\n" + list(result.advice);
}

std::string write_report(const Result& result, const fs::path& directory) {
  io::safe_write(directory / "study.csv", csv_text(result));
  io::safe_write(directory / "study.md", markdown_text(result));
  io::safe_write(directory / "study.gp", plot_script(result));
  std::error_code ignored;
  fs::remove(directory / "study.svg", ignored);  // an older one must not pass for this one
  const auto failure = report::run_gnuplot(directory, "study.gp");
  std::string svg;
  if (!failure) {
    const std::string drawn = io::read_file(directory / "study.svg");
    svg = report::inline_svg(drawn, "study", figure_title(result));
  }
  io::safe_write(directory / "study.html", page(result, svg, failure.value_or("")));
  return failure.value_or("");
}

}  // namespace grainlaw::study
