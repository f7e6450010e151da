#include "apps/io/study_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/io/input_file.h"

namespace grainlaw::io {
namespace {

namespace fs = std::filesystem;
using Numbers = std::vector<double>;

// In the order of StudyFile::kind.
constexpr std::array<std::string_view, 8> kinds = {
    "time_step", "grains", "base", "averaging_time", "kernel", "solver", "law", "whole"};

/// Reads the keys of one kind.
class Reader {
 public:
  Reader(Section section, fs::path folder)
      : section_(std::move(section)), folder_(std::move(folder)) {}

  fs::path path(std::string_view key, std::string_view meaning) {
    return folder_ / section_.read<std::string>({key, meaning});
  }
  std::vector<fs::path> paths(std::string_view key, std::string_view meaning) {
    std::vector<fs::path> result;
    for (const std::string& name : section_.read<std::vector<std::string>>({key, meaning})) {
      result.push_back(folder_ / name);
    }
    if (section_.has(key) && result.empty()) problem(key, "needs at least one file");
    return result;
  }
  /// Settings of a sweep from coarse to fine: at least two, each once.
  Numbers settings(const Key& key, const Numbers& otherwise, std::string_view note) {
    Numbers values = section_.find<Numbers>(key, note).value_or(otherwise);
    std::ranges::sort(values);
    if (section_.has(key.name) && (values.size() < 2 || has_twins(values))) {
      problem(key.name, "needs at least two different values: the finest is the reference");
    }
    return values;
  }
  Numbers list(const Key& key, const Numbers& otherwise, std::string_view note) {
    Numbers values = section_.find<Numbers>(key, note).value_or(otherwise);
    std::ranges::sort(values);
    if (has_twins(values)) problem(key.name, "has a value twice");
    return values;
  }
  void whole_numbers(std::string_view key, const Numbers& values) {
    const auto broken = [](double value) { return value != std::floor(value); };
    if (std::ranges::any_of(values, broken)) problem(key, "takes whole numbers");
  }
  Numbers seeds(std::string_view key, std::string_view meaning, std::string_view note) {
    const Numbers values = list({key, meaning, {}, from_to(0.0, 1e15)}, {}, note);
    whole_numbers(key, values);
    return values;
  }
  bool flag(const Key& key) { return section_.read_or<bool>(key, false); }
  RunSource source() {
    const auto run = section_.find<std::string>({"run", "finished run (RUN.h5)"});
    const auto scene = section_.find<std::string>({"scene", "scene file, which is run"});
    section_.exactly_one_of({"run", "scene"});
    RunSource result;
    if (run) result.run = folder_ / *run;
    if (scene) result.scene = folder_ / *scene;
    return result;
  }
  void problem(std::string_view key, std::string_view text) {
    section_.problem(key, fmt::format("'{}' {}", key, text));
  }
  Section& section() { return section_; }

 private:
  static bool has_twins(const Numbers& sorted) {
    return std::ranges::adjacent_find(sorted) != sorted.end();
  }

  Section section_;
  fs::path folder_;
};

TimeStepStudy read_time_step(Reader in) {
  TimeStepStudy study;
  study.scene = in.path("scene", "scene file: a chute or a simple shear");
  study.steps_per_contact = in.settings(
      {"steps_per_contact", "time steps in the shortest contact", {}, from_to(2.0, 1e4)},
      {10.0, 15.0, 20.0, 30.0, 50.0, 100.0},
      "[10, 15, 20, 30, 50, 100]");
  study.allow_unstable_step =
      in.flag({"allow_unstable_step", "run below 15 too, which is refused otherwise"});
  return study;
}

GrainsStudy read_grains(Reader in) {
  GrainsStudy study;
  study.scene = in.path("scene", "scene file: a simple shear");
  study.grains =
      in.settings({"grains", "numbers of grains", {}, from_to(8.0, 1e6)}, {}, "required");
  if (study.grains.empty()) in.section().report_missing({"grains", ""});
  in.whole_numbers("grains", study.grains);
  study.seeds = in.seeds("seeds", "of the runs of each size", "that of the scene");
  return study;
}

BaseStudy read_base(Reader in) {
  BaseStudy study;
  study.scene = in.path("scene", "scene file: a chute");
  study.sides = in.settings(
      {"sides", "lengths of the base, its shape kept", {"d"}, from_to(3.0, 1e4)}, {}, "required");
  if (study.sides.empty()) in.section().report_missing({"sides", ""});
  study.seeds = in.seeds("seeds", "of the runs of each size", "that of the scene");
  return study;
}

AveragingTimeStudy read_averaging_time(Reader in) {
  AveragingTimeStudy study;
  study.source = in.source();
  study.reference_seeds = in.seeds("reference_seeds",
                                   "of runs on other bases, whose mean is the reference",
                                   "stretches are held against each other");
  if (!study.source.run.empty() && !study.reference_seeds.empty()) {
    in.problem("reference_seeds", "needs a scene to run, not a finished run");
  }
  return study;
}

SolverStudy read_solver(Reader in) {
  SolverStudy study;
  study.question = in.path("case", "case file: a chute");
  study.table = in.path("table", "rheology table");
  study.cells = in.list({"cells", "of the grid", {}, from_to(8.0, 1e5)},
                        {25.0, 50.0, 100.0, 200.0, 400.0},
                        "[25, 50, 100, 200, 400]");
  in.whole_numbers("cells", study.cells);
  study.tolerances = in.list({"tolerances", "relative, of the time steps", {}, from_to(1e-12, 0.1)},
                             {1e-4, 1e-6, 1e-8},
                             "[1e-4, 1e-6, 1e-8]");
  study.regularisations =
      in.list({"regularisations", "deltas of a smeared yield stress", {}, positive},
              {},
              "exact yield only");
  return study;
}

LawStudy read_law(Reader in) {
  LawStudy study;
  study.fitted =
      in.paths("fitted",
               "runs the laws are fitted to: chutes, simple shear for p*, Bo, a shear band "
               "for the nonlocal amplitude");
  study.predicted = in.paths("predicted", "chutes and shear bands that are predicted");
  return study;
}

std::string_view meaning(std::string_view kind) {
  if (kind == "time_step") return "Error and cost of the time step";
  if (kind == "grains") return "Error and cost of the number of grains";
  if (kind == "base") return "Error and cost of the size of a chute";
  if (kind == "averaging_time") return "Error and cost of the averaging time";
  if (kind == "kernel") return "Bias and noise of the width of the kernel";
  if (kind == "solver") return "Error and cost of the continuum solver";
  if (kind == "law") return "Error of predictions and complexity of the law";
  return "From nothing to a prediction";
}

void read_kind(Section& top, const std::string& kind, const fs::path& folder, StudyFile& study) {
  const auto read = [&](std::string_view word, const auto& reader) {
    if (!top.applies(kind == word)) return;
    study.kind = reader(Reader(top.when("kind", word, meaning(word)), folder));
  };
  read("time_step", read_time_step);
  read("grains", read_grains);
  read("base", read_base);
  read("averaging_time", read_averaging_time);
  read("kernel", [](Reader in) { return KernelStudy{in.source()}; });
  read("solver", read_solver);
  read("law", read_law);
  read("whole", [](Reader in) {
    return WholeStudy{in.path("campaign", "campaign file, as for grainlaw calibrate")};
  });
}

void read_keys(InputFile& in, StudyFile& study) {
  Section top = in.top();
  study.title = top.read_or<std::string>(
      {"title", "of figure and summary"}, in.path().stem().string(), "name of the file");
  study.accuracy = top.read_or<double>(
      {"accuracy", "relative error for which a setting is recommended", {}, between(0.0, 1.0)},
      study.accuracy);
  study.repeats = static_cast<int>(top.read_or<std::int64_t>(
      {"repeats", "timings whose median counts; DEM runs are timed once", {}, from_to(1.0, 1000.0)},
      study.repeats));
  const std::string kind =
      top.choice({"kind", "what is varied"}, std::vector<std::string>(kinds.begin(), kinds.end()));
  read_kind(top, kind, in.path().parent_path(), study);
}

}  // namespace

StudyFile read_study(const fs::path& path) {
  InputFile in = InputFile::open(path);
  StudyFile study;
  read_keys(in, study);
  in.finish();
  study.text = in.text();
  study.path = path;
  return study;
}

std::string_view kind_name(const StudyFile& study) {
  return kinds[study.kind.index()];
}

std::string study_keys() {
  InputFile in = InputFile::listing();
  StudyFile study;
  read_keys(in, study);
  return in.key_list();
}

}  // namespace grainlaw::io
