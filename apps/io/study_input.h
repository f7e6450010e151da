#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace grainlaw::io {

// The kinds of studies. Every study sets an error against a cost; paths are relative to its file.

/// One scene with time steps of shortest contact time / n.
struct TimeStepStudy {
  std::filesystem::path scene;
  std::vector<double> steps_per_contact;  ///< n, ascending
  bool allow_unstable_step = false;       ///< run also what is above the stability limit
};

/// Homogeneous shear of more and more grains.
struct GrainsStudy {
  std::filesystem::path scene;
  std::vector<double> grains;  ///< ascending
  std::vector<double> seeds;
};

/// A chute on longer and longer bases of one shape, mass per area kept.
struct BaseStudy {
  std::filesystem::path scene;
  std::vector<double> sides;  ///< along the flow [d], ascending
  std::vector<double> seeds;
};

/// A run that is finished, or a scene to run.
struct RunSource {
  std::filesystem::path run;    ///< empty: the scene is run
  std::filesystem::path scene;  ///< empty: the run is there
};

/// One run, cut into stretches of 1/16 to all of its averaging time.
struct AveragingTimeStudy {
  RunSource source;
  std::vector<double> reference_seeds;  ///< independent runs the stretches are held against
};

/// One run, at half, once and twice the width of its kernel.
struct KernelStudy {
  RunSource source;
};

/// The continuum solver against the quadrature.
struct SolverStudy {
  std::filesystem::path question;  ///< case file
  std::filesystem::path table;
  std::vector<double> cells;
  std::vector<double> tolerances;       ///< relative
  std::vector<double> regularisations;  ///< delta of a smeared yield stress, beside exact yield
};

/// Laws from simple to complex, fitted to some runs, predicting others.
struct LawStudy {
  std::vector<std::filesystem::path> fitted;
  std::vector<std::filesystem::path> predicted;
};

/// A campaign: DEM seconds spent against the error of what is predicted.
struct WholeStudy {
  std::filesystem::path campaign;
};

struct StudyFile {
  std::string title;
  double accuracy = 0.01;  ///< the error for which a setting is recommended, relative
  int repeats = 3;         ///< timings of which the median counts; DEM runs are timed once
  std::variant<TimeStepStudy,
               GrainsStudy,
               BaseStudy,
               AveragingTimeStudy,
               KernelStudy,
               SolverStudy,
               LawStudy,
               WholeStudy>
      kind;
  std::string text;
  std::filesystem::path path;
};

/// Throws InputError.
StudyFile read_study(const std::filesystem::path& path);

/// "time_step", "grains", "base", "averaging_time", "kernel", "solver", "law", "whole".
std::string_view kind_name(const StudyFile& study);

/// The keys of a study file as Markdown.
std::string study_keys();

}  // namespace grainlaw::io
