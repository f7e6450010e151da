#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {

Html seed_section(const Report& report) {
  Table result{.caption =
                   "Means over the seeds with their error in time, and how much the seeds scatter "
                   "(standard deviation) beside what the errors in time of one run let expect. "
                   "Tables and bands hold the errors in time only."_html,
               .head = {"Condition"_html,
                        "Number"_html,
                        "Seeds"_html,
                        "Mean"_html,
                        "Scatter between seeds"_html,
                        "Expected"_html},
               .rows = {},
               .text_columns = 2};
  for (const SeedScatter& one : report.seeds) {
    result.rows.push_back({code(one.condition),
                           typeset(one.quantity),
                           text(std::to_string(one.seeds)),
                           text(with_error(one.mean)),
                           text(significant(one.scatter, 2)),
                           text(significant(one.expected_scatter(), 2))});
  }
  return section("seeds", "Scatter between seeds"_html, table(result));
}

}  // namespace grainlaw::report
