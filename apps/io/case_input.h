#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/io/units.h"
#include "continuum/chute_1d.h"
#include "continuum/shear_band.h"
#include "continuum/split_bottom.h"

namespace grainlaw::io {

enum class Question { steady, start };

/// A flow to predict, in internal units (m = d = g = 1), and the units of its file.
struct CaseFile {
  std::string name;
  std::optional<continuum::ShearBandCase> band;            ///< a shear band, no chute
  std::optional<continuum::SplitBottomCase> split_bottom;  ///< a ring cell, no chute
  continuum::ChuteCase chute;  ///< mass_per_area is 0 when the depth is given instead
  Question question = Question::steady;
  continuum::TransientOptions transient;
  std::optional<double> depth;  ///< height of the free surface above the base plane [d]
  Units units;
  std::string text;
  std::filesystem::path path;
};

/// Throws InputError.
CaseFile read_case(const std::filesystem::path& path);
CaseFile parse_case(const std::string& text, const std::filesystem::path& path);

/// The keys of a case file as Markdown.
std::string case_keys();

}  // namespace grainlaw::io
