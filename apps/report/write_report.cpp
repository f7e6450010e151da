#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

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

/// The files of a folder of pictures, as they are listed in it for the next report.
std::set<std::string> files_of(const std::vector<const FigureGroup*>& groups) {
  std::set<std::string> names;
  for (const FigureGroup* group : groups) {
    for (const auto& [name, csv] : group->data) names.insert(name);
    for (const Figure& figure : group->figures) {
      names.insert(figure.name + ".gp");
      names.insert(figure.name + ".svg");
    }
  }
  return names;
}

/// Removes what an earlier report wrote here and this one does not; nothing that is not listed.
void replace_earlier(const fs::path& directory, const std::set<std::string>& names) {
  const fs::path list = directory / ".written";
  std::ifstream earlier(list);
  for (std::string name; std::getline(earlier, name);) {
    if (names.contains(name) || name.empty() || fs::path(name).filename() != name) continue;
    std::error_code ignored;
    if (fs::is_regular_file(directory / name, ignored)) fs::remove(directory / name, ignored);
  }
  std::string text;
  for (const std::string& name : names) text += name + '\n';
  io::safe_write(list, text);
}

Pictures draw_all(const std::vector<const FigureGroup*>& groups, const fs::path& directory) {
  make_directory(directory);
  replace_earlier(directory, files_of(groups));
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
