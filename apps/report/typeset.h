#pragma once

#include <string>
#include <string_view>

#include "apps/report/html.h"

namespace grainlaw::report {

/// A sentence of the program as print has it: "mu0 + beta I^n, 1.2e-06 +- 3e-07" with Greek
/// letters, indices, powers and signs. Names of files and runs stay as they are. Escapes as text()
/// does.
Html typeset(std::string_view plain);

/// Markup of a symbol or of a typeset sentence as enhanced text of gnuplot, in single quotes.
std::string plot_symbol(const Html& symbol);

}  // namespace grainlaw::report
