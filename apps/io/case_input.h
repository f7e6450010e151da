#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/io/units.h"
#include "continuum/chute_1d.h"
#include "continuum/ring_flow.h"
#include "continuum/shear_band.h"
#include "continuum/split_bottom.h"

namespace grainlaw::io {

/// What is asked: the steady flow with its time-dependent path from rest, the steady flow alone, a
/// time-dependent flow as an answer of its own, or how far steady flow can be driven.
enum class Question { flow, steady, start, step, largest_flow };

/// Points of homogeneous shear: every combination of the numbers.
struct SimpleShearCase {
  std::vector<double> inertial_numbers{};
  std::vector<double> softnesses{0.0};
  std::vector<double> bond_numbers{0.0};
};

/// One thing that a sweep varies, over its values in internal units; coefficients in those of the
/// table.
struct SweepAxis {
  enum class Kind { inclination, mass_per_area, depth, stiffness, adhesion, coefficient };
  Kind kind = Kind::inclination;
  std::string name;  ///< of the key, or of the coefficient
  std::vector<double> values;
};

/// A flow to predict, in internal units (m = d = g = 1), and the units of its file.
struct CaseFile {
  std::string name;
  std::optional<continuum::ShearBandCase> band;            ///< a shear band, no chute
  std::optional<continuum::SplitBottomCase> split_bottom;  ///< geometry of the band of a ring cell
  std::optional<continuum::RingFlowCase> ring_cell;        ///< its rotation
  std::optional<SimpleShearCase> simple_shear;             ///< the law itself, no flow
  continuum::ChuteCase chute;  ///< mass_per_area is 0 where it is not given
  Question question = Question::flow;
  continuum::TransientOptions transient;
  std::optional<double> depth;      ///< height of the free surface above the base plane [d]
  std::optional<double> mass_flow;  ///< given instead of the tilt or the size [m / (d time)]
  bool tilt_sought = false;         ///< the tilt of `chute` is not given
  /// Axes of a sweep, every combination of which is asked; absent: one flow.
  std::optional<std::vector<SweepAxis>> sweep;
  Units units;
  std::string text;
  std::filesystem::path path;

  bool is_chute() const { return !band && !split_bottom && !ring_cell && !simple_shear; }
};

/// Throws InputError.
CaseFile read_case(const std::filesystem::path& path);
CaseFile parse_case(const std::string& text, const std::filesystem::path& path);

/// Message for a problem with a key of a case that is found after reading.
std::string case_message(const CaseFile& file,
                         std::string_view section,
                         std::string_view key,
                         std::string_view text);

/// The keys of a case file as Markdown.
std::string case_keys();

}  // namespace grainlaw::io
