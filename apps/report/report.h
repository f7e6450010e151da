#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/bagnold_fit.h"
#include "calibration/comparison.h"
#include "calibration/contact_friction_fit.h"
#include "calibration/information.h"
#include "calibration/material_band.h"
#include "calibration/mu_phi_fit.h"
#include "continuum/chute_1d.h"
#include "dem/local_data.h"

namespace grainlaw::report {

/// One DEM run against the continuum prediction of its scene.
struct RunComparison {
  dem::LocalData data;
  calibration::SampleKind kind = calibration::SampleKind::in_sample;
  continuum::SteadyChute steady;                   ///< quadrature
  std::optional<continuum::TransientChute> start;  ///< CVODE, from rest, at the DEM frame times
  std::vector<calibration::TransientError> start_error;
  std::optional<calibration::ProfileError> error;  ///< absent: no steady profile on one side
  double steady_against_transient = 0.0;  ///< relative max difference, quadrature against CVODE
  std::optional<calibration::ProfileError> naive_error;  ///< nearest calibration profile rescaled
  std::string naive_source;                              ///< name of that run
  std::optional<calibration::FlowPoint> point;  ///< measured I, mu, phi, drawn beside the law
  std::optional<calibration::BagnoldFit> own_bagnold;  ///< closure A fitted to this very run
  std::optional<calibration::ProfileError> own_bagnold_error;  ///< and its error in sample
  /// Closure A fitted at the nearest calibration tilt, used here as if a, b were constants.
  std::optional<calibration::ProfileError> foreign_bagnold_error;
  std::string foreign_bagnold_source;
  double predict_seconds = 0.0;    ///< wall, steady + transient + band
  std::vector<std::string> notes;  ///< what could not be fitted or compared, and why
};

/// Error of law and prediction when only part of the DEM averaging time is used.
struct TimeErrorPoint {
  double averaging_time = 0.0;    ///< per calibration run [time]
  double dem_wall_seconds = 0.0;  ///< of all calibration runs up to here, start-up included
  dem::Estimate mu0;              ///< as fitted from this much data
  double law_error = 0.0;  ///< largest relative difference of I(theta) over the fitted tilts from
                           ///< the fit to all data
  double law_standard_error = 0.0;  ///< of I at the tilt of that largest difference, relative, as
                                    ///< the fit claims
  /// Relative L2 velocity error of every run, in the order of Report::runs; NaN: no answer.
  std::vector<double> profile_error;
  std::vector<double> profile_standard_error;  ///< of profile_error; empty: not stated
  std::string failure;  ///< not empty: no fit was possible with this much data, and why
};

struct StageCost {
  std::string stage;
  double wall_seconds = 0.0;
  double cpu_seconds = 0.0;
};

/// One line of a law in a figure: states along which I or Bo varies, with the band where one was
/// bootstrapped.
struct LawLine {
  std::vector<calibration::State> states;
  std::optional<calibration::MaterialBand> band;
};

/// mu(I, p*, Bo) and phi(I, p*, Bo) fitted to many states of homogeneous flow.
struct MaterialReport {
  std::vector<calibration::StatePoint> points;
  calibration::MaterialFit fit;
  std::vector<std::string> left_out;      ///< runs that gave no point, and why
  std::vector<LawLine> against_inertia;   ///< one per p*, Bo = 0
  std::vector<LawLine> against_cohesion;  ///< one per pair of I and p* with several Bo
  calibration::LawInformation friction_information;
  calibration::LawInformation fraction_information;
  std::vector<calibration::CostPoint> cost;           ///< empty: no frames to average anew
  std::optional<continuum::RheologyTable> reference;  ///< published row to compare with
  std::string reference_name;
};

/// Coefficients of several tables as functions of the contact friction of their grains.
struct ContactFrictionReport {
  std::vector<continuum::RheologyTable> tables;
  std::vector<std::string> table_names;
  calibration::FrictionDependences curves;
  std::optional<continuum::RheologyTable> interpolated;  ///< at the contact friction asked for
};

/// One number of one condition that was run with several seeds (for chutes: bases).
struct SeedScatter {
  std::string condition;
  std::string quantity;  ///< "I", "mu", "phi", ...
  int seeds = 0;
  dem::Estimate mean;    ///< over the seeds; its error is that in time
  double scatter = 0.0;  ///< standard deviation between the seeds

  /// The same of one run, as the errors in time claim.
  double expected_scatter() const { return mean.error * std::sqrt(static_cast<double>(seeds)); }
};

/// All a report shows. Everything in it was computed before; the report only writes.
struct Report {
  std::string title;
  std::string command;  ///< that made it
  std::string machine;  ///< processor, cores and threads used; empty: not stated
  continuum::RheologyTable table;
  std::optional<calibration::MuPhiFit> fit;  ///< absent when the table was given
  std::optional<MaterialReport> material;
  std::optional<ContactFrictionReport> contact_friction;
  std::vector<RunComparison> runs;
  std::vector<SeedScatter> seeds;  ///< empty: one seed each
  std::vector<TimeErrorPoint> error_against_time;
  std::vector<StageCost> costs;
  std::vector<std::string> warnings;
};

/// Writes DIR/report.html (self-contained, offline), DIR/report.json and, in DIR/plots, the gnuplot
/// scripts, CSV files and SVGs behind every figure. Without gnuplot the report has tables and CSV
/// and says so. Throws io::FileError.
void write_report(const Report& report, const std::filesystem::path& directory);

}  // namespace grainlaw::report
