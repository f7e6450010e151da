#include "apps/certificate.h"

#include <fmt/format.h>

#include <cmath>

namespace grainlaw {
namespace {

std::string one_interval(const continuum::Range& range) {
  if (range.lower == 0.0 && std::isinf(range.upper)) return "every I";
  if (range.lower == 0.0) return fmt::format("I up to {:.3g}", range.upper);
  if (std::isinf(range.upper)) return fmt::format("I from {:.3g}", range.lower);
  return fmt::format("I {:.3g} to {:.3g}", range.lower, range.upper);
}

std::string probability_text(const continuum::CertifiedState& state) {
  if (!state.ill_posed_probability) return "; no probability: this table states no errors";
  return fmt::format("; F is known to {:.2g}, P[F < 0] = {:.3g}",
                     *state.margin_error,
                     *state.ill_posed_probability);
}

std::string flow_text(const continuum::CertifiedFlow& flow, bool bagnold) {
  const auto& [at, found, error, probability] = flow.worst;
  const std::string where = bagnold ? std::string("at its slowest shear")
                                    : fmt::format("at I {:.3g}, {}",
                                                  at.inertial_number,
                                                  confinement_text(at.softness, at.bond_number));
  return fmt::format("{}: least margin F = {:.3g} {}; {:.0f} % of the sheared rows ill-posed{}",
                     found.holds() ? "well-posed in 2D and 3D" : "ILL-POSED in 2D and 3D",
                     found.margin,
                     where,
                     100.0 * flow.ill_posed_fraction,
                     probability_text(flow.worst));
}

}  // namespace

std::string interval_text(const std::vector<continuum::Range>& intervals) {
  std::string text;
  for (const continuum::Range& range : intervals)
    text += (text.empty() ? "" : ", ") + one_interval(range);
  return text.empty() ? "no I" : text;
}

std::string confinement_text(double softness, double bond_number) {
  const std::string stiff =
      softness == 0.0 ? std::string("rigid") : fmt::format("p* {:.3g}", softness);
  return bond_number == 0.0 ? stiff : fmt::format("{}, Bo {:.3g}", stiff, bond_number);
}

void say_certificate(Summary& summary, const continuum::RheologyTable& table) {
  const bool bagnold = std::holds_alternative<continuum::GeneralisedBagnold>(table.law);
  summary.add("certificate",
              "well-posed in 2D, 3D",
              std::string("where short waves do not grow without bound, F >= 0 (1D flows need only "
                          "that stress rises with shear rate)"));
  for (const auto& [softness, Bo, intervals] : continuum::well_posedness_map(table)) {
    summary.add(
        fmt::format("well_posed_softness_{:g}_bond_{:g}", softness, Bo),
        "  " + (bagnold ? std::string("at its tilt") : confinement_text(softness, Bo)),
        bagnold && !intervals.empty() ? std::string("every shear rate") : interval_text(intervals));
  }
}

void say_certificate(Summary& summary,
                     const continuum::RheologyTable& table,
                     const continuum::Profile& profile,
                     const continuum::GrainProperties& grains) {
  const auto flow = continuum::certify(table, profile, grains);
  if (!flow) return;
  const bool bagnold = std::holds_alternative<continuum::GeneralisedBagnold>(table.law);
  summary.add("certificate_margin", "  least F of this flow", flow->worst.well_posedness.margin);
  summary.add("certificate_text", "    in words", flow_text(*flow, bagnold));
}

}  // namespace grainlaw
