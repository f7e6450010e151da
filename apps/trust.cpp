#include "apps/trust.h"

#include <fmt/format.h>

#include "apps/io/input_key.h"
#include "apps/io/profile_csv.h"

namespace grainlaw {
namespace {

std::string band_text(const continuum::RheologyTable& table, bool with_errors) {
  if (!table.covariance) return "; no band: this table states no errors";
  return with_errors ? "; band: one standard error from the table's covariance"
                     : "; no band: the table's covariance was not carried through";
}

}  // namespace

std::string checks_text(const continuum::RheologyTable& table) {
  const auto& checks = table.provenance.checked_against;
  return checks.empty() ? "; checked against nothing"
                        : "; checked against " + io::joined(checks, "; ");
}

std::string trust(const continuum::Answer& answer,
                  const continuum::RheologyTable& table,
                  bool with_errors) {
  if (!continuum::flows(answer.outcome) && answer.out_of_domain.empty())
    return "no steady flow, so no range and no band to judge" + checks_text(table);
  std::string text;
  if (answer.out_of_domain.empty()) text = "inside the range of the data";
  for (const continuum::RangeFlag& flag : answer.out_of_domain)
    text += (text.empty() ? "OUT_OF_DOMAIN: " : ", OUT_OF_DOMAIN: ") + io::flag_text(flag);
  if (answer.condition_number > 0.0)
    text += fmt::format("; 1 % of mu moves I by {:.1f} %", answer.condition_number);
  return text + band_text(table, with_errors) + checks_text(table);
}

}  // namespace grainlaw
