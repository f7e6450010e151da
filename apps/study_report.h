#pragma once

#include <filesystem>
#include <string>

#include "apps/study_result.h"

namespace grainlaw::study {

/// The points as CSV, one row each; texts that need it in quotes, what is not there empty.
std::string csv_text(const Result& result);

/// The points as a table, the reference, remarks and, last, what to choose, as Markdown.
std::string markdown_text(const Result& result);

/// A gnuplot script with its data that draws study.svg: error against cost, both logarithmic, a
/// line for each series, failures as crosses on the top edge.
std::string plot_script(const Result& result);

/// Writes study.csv, study.md, study.gp, study.svg and study.html into a folder that is there.
/// Returns a sentence where the figure could not be drawn; empty otherwise. Throws io::FileError.
std::string write_report(const Result& result, const std::filesystem::path& directory);

}  // namespace grainlaw::study
