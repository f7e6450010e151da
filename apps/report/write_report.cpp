#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "apps/io/safe_write.h"
#include "apps/report/gnuplot.h"
#include "apps/report/report.h"
#include "apps/report/report_json.h"
#include "apps/report/sections.h"
#include "apps/report/svg.h"

namespace grainlaw::report {
namespace {

namespace fs = std::filesystem;

void make_directory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) {
    throw io::FileError(
        fmt::format("cannot make the folder {}: {}", directory.string(), error.message()));
  }
}

/// Scripts and data of the figures can be made again: they are spared the sync to disk of
/// io::safe_write, which for a hundred small files costs more than the whole report.
void write_plot_file(const fs::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  file.close();
  if (!file)
    throw io::FileError(fmt::format("cannot write {}: {}", path.string(), std::strerror(errno)));
}

std::vector<const FigureGroup*> all_groups(const std::vector<FigureGroup>& figures) {
  std::vector<const FigureGroup*> groups;
  for (const FigureGroup& group : figures) groups.push_back(&group);
  return groups;
}

std::vector<const FigureGroup*> all_groups(const Figures& figures) {
  std::vector<const FigureGroup*> groups = {
      &figures.law, &figures.time, &figures.budget, &figures.contact_friction};
  for (const auto* several :
       {&figures.profiles, &figures.in_time, &figures.flows, &figures.material}) {
    std::ranges::copy(all_groups(*several), std::back_inserter(groups));
  }
  return groups;
}

/// Draws one figure; what stands in the folder from an earlier report must not pass for it.
void draw(const Figure& figure, const fs::path& directory, Pictures& pictures) {
  const fs::path svg = directory / (figure.name + ".svg");
  std::error_code ignored;
  fs::remove(svg, ignored);
  if (const auto failure = run_gnuplot(directory, figure.name + ".gp")) {
    pictures.failures[figure.name] = *failure;
    return;
  }
  const std::string drawn = inline_svg(io::read_file(svg), figure.name, figure.label);
  if (drawn.empty()) {
    pictures.failures[figure.name] = "gnuplot wrote no picture";
  } else {
    pictures.svg[figure.name] = drawn;
  }
}

Pictures draw_all(const std::vector<const FigureGroup*>& groups, const fs::path& directory) {
  make_directory(directory);
  Pictures pictures;
  for (const FigureGroup* group : groups) {
    for (const auto& [name, csv] : group->data) write_plot_file(directory / name, csv.text());
    for (const Figure& figure : group->figures) {
      write_plot_file(directory / (figure.name + ".gp"), figure.script);
      draw(figure, directory, pictures);
    }
  }
  return pictures;
}

template <class AnyReport, class AllFigures>
void write(const AnyReport& report, const AllFigures& all, const fs::path& directory) {
  make_directory(directory);
  io::safe_write(directory / "report.json", report_json(report));
  const Pictures pictures = draw_all(all_groups(all), directory / "plots");
  io::safe_write(directory / "report.html", page(report, all, pictures));
}

}  // namespace

void write_report(const Report& report, const fs::path& directory) {
  write(report, figures(report), directory);
}

void write_report(const SeriesReport& report, const fs::path& directory) {
  write(report, series_figures(report), directory);
}

}  // namespace grainlaw::report
