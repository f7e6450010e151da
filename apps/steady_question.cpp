#include "apps/steady_question.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/exit_code.h"

namespace grainlaw {
namespace {

using continuum::Outcome;

/// Which side of the wanted depth a mass lies on.
enum class Side { too_shallow, too_deep };

Side side_of(const continuum::SteadyChute& steady, double depth) {
  switch (steady.answer.outcome) {
    case Outcome::arrested:
      return Side::too_shallow;  // a cohesive layer rests until it is deep
    case Outcome::steady:
    case Outcome::plug:
      return steady.profile.height > depth ? Side::too_deep : Side::too_shallow;
    default:
      return Side::too_deep;  // soft grains have a greatest depth
  }
}

/// Finds the mass per area of a layer whose free surface stands at `depth`, by bisection: height
/// grows with mass. Where no mass gives a flow of that depth the answer says why.
continuum::SteadyChute steady_at_depth(const continuum::RheologyTable& table,
                                       continuum::ChuteCase& chute,
                                       double depth) {
  const double unit = chute.grains.density * chute.grains.diameter;
  double low = (table.base ? table.base->mass_below : 0.0) * unit;
  double high = low + chute.grains.density * depth;  // phi = 1: more than any layer holds
  continuum::SteadyChute steady;
  for (int k = 0; k < 200; ++k) {
    chute.mass_per_area = 0.5 * (low + high);
    if (chute.mass_per_area <= low || chute.mass_per_area >= high) break;  // neighbouring numbers
    steady = continuum::steady_chute(table, chute);
    (side_of(steady, depth) == Side::too_deep ? high : low) = chute.mass_per_area;
  }
  if (continuum::flows(steady.answer.outcome) &&
      std::abs(steady.profile.height - depth) > 1e-9 * depth) {
    throw NoAnswer(
        fmt::format("no steady layer of this law is {:.6g} d deep at this tilt: the "
                    "nearest reaches {:.6g} d",
                    depth,
                    steady.profile.height));
  }
  return steady;
}

}  // namespace

continuum::SteadyChute steady_with_band(const continuum::RheologyTable& table,
                                        continuum::ChuteCase& chute,
                                        const std::optional<double>& depth) {
  continuum::SteadyChute steady =
      depth ? steady_at_depth(table, chute, *depth) : continuum::steady_chute(table, chute);
  continuum::add_error_band(steady, table, chute);
  return steady;
}

}  // namespace grainlaw
