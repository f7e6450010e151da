#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/report/figure.h"
#include "apps/report/html.h"
#include "apps/report/report.h"

namespace grainlaw::report {

/// Every picture of a report.
struct Figures {
  FigureGroup law;
  std::vector<FigureGroup> profiles;  ///< per run
  std::vector<FigureGroup> in_time;   ///< per run
  std::vector<FigureGroup> flows;     ///< of the runs that are no chutes
  FigureGroup time;
  FigureGroup budget;
  std::vector<FigureGroup> material;
  FigureGroup contact_friction;
};
Figures figures(const Report& report);

/// What gnuplot made of them.
struct Pictures {
  std::map<std::string, std::string> svg;  ///< by figure name, ready for the page
  std::map<std::string, std::string> failures;
};

/// The pictures of a group side by side, with a heading when it has a title.
Html show(const FigureGroup& group, const Pictures& pictures);

// The parts of the page, in their order. A part without content says so in one sentence.
Html summary_section(const Report& report);
Html summary_section(const SeriesReport& report);
Html law_section(const Report& report, const FigureGroup& group, const Pictures& pictures);
Html prediction_section(const Report& report,
                        const std::vector<FigureGroup>& groups,
                        const Pictures& pictures);
Html in_time_section(const Report& report,
                     const std::vector<FigureGroup>& groups,
                     const Pictures& pictures);
Html flow_section(const Report& report,
                  const std::vector<FigureGroup>& groups,
                  const Pictures& pictures);
Html score_section(const Report& report);
Html bagnold_section(const Report& report);
Html series_section(const SeriesReport& series,
                    const std::vector<FigureGroup>& groups,
                    const Pictures& pictures);
Html certificate_section(const Report& report);
Html material_section(const MaterialReport& material,
                      const std::vector<FigureGroup>& groups,
                      const Pictures& pictures);
Html contact_friction_section(const ContactFrictionReport& report,
                              const FigureGroup& group,
                              const Pictures& pictures);
Html seed_section(const Report& report);
Html time_section(const Report& report, const FigureGroup& group, const Pictures& pictures);
Html budget_section(const BudgetReport& budget, const FigureGroup& group, const Pictures& pictures);
Html cost_section(const ReportHead& report, const std::vector<RunComparison>& runs);
Html health_section(const Report& report);
Html answer_section(const Report& report);
Html reading_section(const Report& report);
Html reading_section(const SeriesReport& report);

/// The whole page.
std::string page(const Report& report, const Figures& figures, const Pictures& pictures);
std::string page(const SeriesReport& report,
                 const std::vector<FigureGroup>& figures,
                 const Pictures& pictures);

// Shared words.
Html fit_caption(const std::string& law, const calibration::FitSummary& fit);
/// Notes of a fit and what was left out of it.
Html fit_remarks(const calibration::FitSummary& fit);
/// Value and error in columns of their own, both cut at the second digit of the error.
std::vector<Html> value_cells(const dem::Estimate& estimate);
Html coefficient_symbol(const std::string& name);
std::string coefficient_unit(const std::string& name, const std::string& units);
/// Name of a run and its tilt, as the first cell of a table row.
Html run_label(const RunComparison& run);
/// Runs of one kind, in the order of the report.
std::vector<const RunComparison*> runs_of(const Report& report, calibration::SampleKind kind);
inline constexpr calibration::SampleKind all_kinds[] = {calibration::SampleKind::in_sample,
                                                        calibration::SampleKind::leave_one_out,
                                                        calibration::SampleKind::interpolation,
                                                        calibration::SampleKind::extrapolation,
                                                        calibration::SampleKind::cross_geometry,
                                                        calibration::SampleKind::independent};

}  // namespace grainlaw::report
