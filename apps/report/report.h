#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/bagnold_fit.h"
#include "calibration/band_comparison.h"
#include "calibration/cohesion_series.h"
#include "calibration/comparison.h"
#include "calibration/contact_friction_fit.h"
#include "calibration/contact_series.h"
#include "calibration/information.h"
#include "calibration/material_band.h"
#include "calibration/mu_phi_fit.h"
#include "calibration/ring_band.h"
#include "calibration/ring_comparison.h"
#include "calibration/state_comparison.h"
#include "calibration/transient_comparison.h"
#include "continuum/chute_1d.h"
#include "continuum/shear_band.h"
#include "continuum/split_bottom.h"
#include "dem/local_data.h"

namespace grainlaw::report {

/// One DEM run against the continuum prediction of its scene.
struct RunComparison {
  dem::LocalData data;
  calibration::SampleKind kind = calibration::SampleKind::in_sample;
  continuum::SteadyChute steady;  ///< quadrature
  /// CVODE through the tilts of the run, with snapshots at the DEM frame times.
  std::optional<continuum::TransientChute> transient;
  std::vector<calibration::Stretch> in_time;       ///< the two side by side, tilt by tilt
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
  calibration::ErrorBudget budget;  ///< of the velocity; zeros where `error` is absent
  double predict_seconds = 0.0;     ///< wall, steady + transient + band
  std::vector<std::string> notes;   ///< what could not be fitted or compared, and why
};

/// A shear band as one law predicts it, beside the measured one.
struct BandPrediction {
  continuum::ShearBand band;
  std::optional<calibration::BandComparison> comparison;  ///< absent: one side has no profile
};

/// The rotation of a ring cell as one law predicts it, beside the measured one.
struct RingPrediction {
  continuum::RingFlow flow;
  std::optional<calibration::RingComparison>
      comparison;  ///< absent: no rotation, or DEM not steady
};

/// What one table says of a run of another flow than a chute.
struct FlowPrediction {
  calibration::SampleKind kind = calibration::SampleKind::independent;
  /// The box itself; independent rows of plane shear and body-force box; heights of a ring cell.
  std::vector<calibration::StateComparison> states;
  std::optional<BandPrediction> local;                 ///< of plane shear and body-force box
  std::optional<BandPrediction> nonlocal;              ///< with the amplitude of the report
  std::optional<continuum::SplitBottom> split_bottom;  ///< geometry of the band of a ring cell
  std::optional<RingPrediction> ring_local;            ///< of a ring cell
  std::optional<RingPrediction> ring_nonlocal;         ///< with the amplitude of the report
};

/// One run of another flow than a chute beside every table of the report.
struct FlowComparison {
  dem::LocalData data;
  std::optional<calibration::RingBand> ring;  ///< of a split-bottom cell
  double split_radius = 0.0;                  ///< R_s of it [length]
  std::vector<FlowPrediction> tables;         ///< in the order of the report
  std::vector<std::string> notes;
};

/// A of the nonlocal fluidity that the bands of a report are predicted with.
struct NonlocalAmplitude {
  double value = 0.0;
  double error = 0.0;  ///< standard error; 0: it was given
  std::string run;     ///< it was fitted to; empty: it was given
  double local_chi_squared = 0.0;
  double chi_squared = 0.0;
  int points = 0;
};

/// One number by which one run judges one table.
struct Score {
  std::string run;
  std::string flow;      ///< as scenes name it
  std::string quantity;  ///< "u", "mu", "phi", ...
  calibration::SampleKind kind = calibration::SampleKind::independent;
  dem::Estimate difference;  ///< relative; a norm for profiles, else signed
  double in_standard_errors = 0.0;
  double condition_number = 0.0;  ///< d ln I / d ln mu; 0: it has no meaning there
  std::optional<calibration::ErrorBudget> budget;
  std::string remark;  ///< outcome, range flags
};

/// A table and how the runs judge it.
struct TableScores {
  std::string name;
  continuum::RheologyTable table;
  std::vector<Score> scores;  ///< same runs and quantities, in the same order, for every table
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

/// Contact lifetimes of one run of a series, to be drawn.
struct LifetimeCurve {
  std::string name;
  std::string series;
  dem::LifetimeStatistics statistics;
};

struct StageCost {
  std::string stage;
  double wall_seconds = 0.0;
  double cpu_seconds = 0.0;  ///< 0: not measured, as of runs read from files
};

/// What every report says of its making.
struct ReportHead {
  std::string title;
  std::string command;  ///< that made it
  std::string machine;  ///< processor, cores and threads used; empty: not stated
  std::vector<StageCost> costs;
  std::vector<std::string> warnings;
};

/// Chutes that differ in one property at a time: Xi beside the lifetimes of contacts. No law is
/// fitted to them: there is no table and nothing is predicted.
struct SeriesReport : ReportHead {
  calibration::ContactSeries contacts;
  std::vector<LifetimeCurve> curves;
  std::optional<calibration::CohesionSeries> cohesion;  ///< absent: no grains attract each other
  std::string law_name;  ///< of the table whose Xi stands beside the measured one; empty: none
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

/// A run that a budget paid for.
struct BudgetRun {
  std::string name;
  std::string condition;  ///< the same for runs that differ in their seed only
  std::string why;
};

/// What was known after some of the time of a budget.
struct BudgetRound {
  std::vector<BudgetRun> runs;  ///< made since the round before
  double wall_seconds = 0.0;    ///< since the start, until the law of this round was known
  double cpu_seconds = 0.0;     ///< of all DEM runs until then
  /// u_s of every target as the law of this round predicts it [length/time]; NaN: it does not flow.
  std::vector<dem::Estimate> surface_velocity;
  /// Relative L2 velocity error of the same law for every target that was measured outside the
  /// budget; NaN: not measured.
  std::vector<double> reached;
  std::string failure;  ///< not empty: no law could be fitted yet, and why
};

/// A calibration that had to be done within a wall time.
struct BudgetReport {
  double seconds = 0.0;        ///< given
  double spent_seconds = 0.0;  ///< when the last law was known
  int processes = 1;
  std::vector<double> targets;  ///< tilts that are to be predicted [rad]
  std::vector<BudgetRound> rounds;
  std::vector<std::string> notes;  ///< sentences on what was left out or cut short
};

/// A law, given or fitted, and what it predicts. Everything in it was computed before; the report
/// only writes.
struct Report : ReportHead {
  continuum::RheologyTable table;
  std::optional<calibration::MuPhiFit> fit;  ///< absent when the table was given
  std::optional<MaterialReport> material;
  std::optional<ContactFrictionReport> contact_friction;
  std::vector<RunComparison> runs;
  std::vector<FlowComparison> flows;          ///< runs that are no chutes
  std::optional<NonlocalAmplitude> nonlocal;  ///< of the bands among them
  std::vector<RunComparison> left_out;        ///< fitted runs, the law refitted without each
  std::vector<TableScores> tables;            ///< the first is `table`; empty: no scores asked
  std::vector<SeedScatter> seeds;             ///< empty: one seed each
  std::vector<TimeErrorPoint> error_against_time;
  std::optional<BudgetReport> budget;  ///< absent: no budget was set
};

/// Writes DIR/report.html (self-contained, offline), DIR/report.json and, in DIR/plots, the gnuplot
/// scripts, CSV files and SVGs behind every figure. Without gnuplot the report has tables and CSV
/// and says so. Throws io::FileError.
void write_report(const Report& report, const std::filesystem::path& directory);
void write_report(const SeriesReport& report, const std::filesystem::path& directory);

}  // namespace grainlaw::report
