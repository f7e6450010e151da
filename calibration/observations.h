#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibration/bagnold_fit.h"
#include "continuum/rheology_table.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// The rows of one run that a fit uses, and why the others do not count.
struct Observations {
  std::vector<std::size_t> rows;      ///< indices into LocalData::rows, bottom to top
  double bulk_volume_fraction = 0.0;  ///< mean phi of those rows
  std::vector<std::string> left_out;  ///< sentences
};

/// Rows of the sheared bulk: not at the rough base (layering, no-slip above the base top), not in
/// the saltating layer below the surface, every field finite. Throws FitError when the run is not
/// steady or has fewer than 4 such rows; four is one more than a, b and the no-slip height.
Observations select_rows(const dem::LocalData& data, const RowSelection& selection);

/// Rows of the independent blocks of the steady window, [block][row] in the order of `data.rows`;
/// as many blocks as dem::block_velocities finds. Fields of a row that is empty during a block (the
/// saltating layer) are NaN there. No blocks when the run has no frames (imported data).
std::vector<std::vector<dem::LocalRow>> block_rows(const dem::LocalData& data);

/// The same for a fit, whose errors rest on them. Throws FitError when the run has frames but makes
/// fewer than 4 blocks: the scatter of so few says nothing.
std::vector<std::vector<dem::LocalRow>> blocks_for_fit(const dem::LocalData& data);

/// Middle value (the upper one of two); 0 for none.
double median(std::vector<double> values);

/// Means over all blocks but one, for the jackknife: values of the fields, without errors.
std::vector<dem::LocalRow> mean_without(const std::vector<std::vector<dem::LocalRow>>& blocks,
                                        std::size_t left_out);

/// Jackknife standard error from the values of a statistic with each block left out in turn
/// (Quenouille-Tukey), sqrt((n-1)/n sum (x_i - mean)^2), times Student's t of 68.27 % with n - 1
/// degrees of freedom: few blocks make the error itself unsure.
double jackknife_error(const std::vector<double>& without);

/// The measured mass column of one run: which height has which mass above it. The density is
/// uniform in each bin; beyond the rows it goes on with that of the last bin.
class MassColumn {
 public:
  MassColumn(const std::vector<dem::LocalRow>& rows, double grain_density);

  double height(double mass_above) const;  ///< z [length]
  double mass_above(double z) const;       ///< per unit area [mass/length^2]

 private:
  void add(double z, double mass);

  std::vector<double> z_;     // centres of the bins and faces between them
  std::vector<double> mass_;  // falls with z
};

/// Standard errors as weights may rest on them: not below a tenth of the median of the positive
/// ones, so that no single lucky datum rules the fit. Without any positive error all weigh alike,
/// with 1e-6 of the largest |value|.
std::vector<double> weight_errors(const std::vector<dem::Estimate>& estimates);

/// The same for a field in the chosen rows.
std::vector<double> weight_errors(const std::vector<dem::LocalRow>& rows,
                                  const std::vector<std::size_t>& chosen,
                                  dem::Estimate dem::LocalRow::*field);

/// Smallest and largest value of a field in the rows used; none when it was not measured.
std::optional<continuum::Range> range(const dem::LocalData& data,
                                      const Observations& observations,
                                      dem::Estimate dem::LocalRow::*field);

}  // namespace grainlaw::calibration
