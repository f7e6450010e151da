#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "continuum/shear_band_cells.h"

namespace grainlaw::continuum {
namespace {

void require_positive(const char* name, double value) {
  if (!(std::isfinite(value) && value > 0.0))
    throw std::invalid_argument(fmt::format("{} = {} must be finite and positive", name, value));
}

void require_one(const char* names,
                 const std::optional<double>& first,
                 const std::optional<double>& second) {
  if (first.has_value() == second.has_value())
    throw std::invalid_argument(fmt::format("give exactly one of {}", names));
  require_positive(names, first ? *first : *second);
}

void check(const PlaneShear& flow) {
  require_one("wall velocity, wall stress", flow.drive.velocity, flow.drive.stress);
  require_one("height, mass per area", flow.extent.height, flow.extent.mass_per_area);
  require_positive("load", flow.load);
  if (!(std::isfinite(flow.gravity) && flow.gravity >= 0.0))
    throw std::invalid_argument(fmt::format("gravity = {} must not be negative", flow.gravity));
}

void check(const BodyForceBox& flow) {
  require_one("height, mass per area", flow.extent.height, flow.extent.mass_per_area);
  require_positive("amplitude", flow.amplitude);
  require_positive("pressure", flow.pressure);
}

void check(const AnnularShear& flow) {
  require_one("wall velocity, wall stress", flow.drive.velocity, flow.drive.stress);
  require_positive("inner radius", flow.inner_radius);
  require_positive("pressure", flow.pressure);
  if (!(std::isfinite(flow.outer_radius) && flow.outer_radius > flow.inner_radius))
    throw std::invalid_argument(fmt::format(
        "outer radius = {} must exceed the inner one, {}", flow.outer_radius, flow.inner_radius));
}

void check(const ShearBandCase& band) {
  require_positive("grain diameter", band.grains.diameter);
  require_positive("grain density", band.grains.density);
  if (band.grains.stiffness) require_positive("grain stiffness", *band.grains.stiffness);
  if (band.grains.adhesion && !(*band.grains.adhesion >= 0.0))
    throw std::invalid_argument("adhesion must not be negative");
  if (band.nonlocal_amplitude && !(*band.nonlocal_amplitude >= 0.0))
    throw std::invalid_argument("the nonlocal amplitude A must not be negative");
  std::visit([](const auto& flow) { check(flow); }, band.flow);
}

void divide(std::optional<double>& value, double unit) {
  if (value) *value /= unit;
}

void scale(WallDrive& drive, Extent* extent, const BandUnits& units) {
  divide(drive.velocity, units.length);
  divide(drive.stress, units.stress);
  if (extent == nullptr) return;
  divide(extent->height, units.length);
  divide(extent->mass_per_area, units.mass_per_area);
}

PlaneShear dimensionless(PlaneShear flow, const BandUnits& units) {
  scale(flow.drive, &flow.extent, units);
  flow.load /= units.stress;
  flow.gravity /= units.length;
  return flow;
}

BodyForceBox dimensionless(BodyForceBox flow, const BandUnits& units) {
  WallDrive none;
  scale(none, &flow.extent, units);
  flow.amplitude /= units.length;
  flow.pressure /= units.stress;
  return flow;
}

AnnularShear dimensionless(AnnularShear flow, const BandUnits& units) {
  scale(flow.drive, nullptr, units);
  flow.inner_radius /= units.length;
  flow.outer_radius /= units.length;
  flow.pressure /= units.stress;
  return flow;
}

}  // namespace

BandProblem make_problem(const RheologyTable& table,
                         const ShearBandCase& band,
                         const BandUnits& units) {
  check(band);
  const auto* law = std::get_if<MuPhi>(&table.law);
  if (law == nullptr)
    throw TableError(
        "a generalised Bagnold law holds at its own tilt only: a shear band needs a table of "
        "mu(I) and phi(I)");
  if (band.nonlocal_amplitude.value_or(0.0) > 0.0) require_linear_onset(law->friction);
  BandProblem problem{.law = *law, .grains = {}, .flow = {}};
  if (band.grains.stiffness)
    problem.grains.stiffness = *band.grains.stiffness / (units.stress * units.length);
  if (band.grains.adhesion)
    problem.grains.adhesion = *band.grains.adhesion / (units.stress * units.length * units.length);
  problem.amplitude = band.nonlocal_amplitude.value_or(0.0);
  std::visit([&](const auto& flow) { problem.flow = dimensionless(flow, units); }, band.flow);
  return problem;
}

}  // namespace grainlaw::continuum
