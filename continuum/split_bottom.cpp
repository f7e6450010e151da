#include "continuum/split_bottom.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "continuum/range_flags.h"

namespace grainlaw::continuum {
namespace {

/// Point of the path of least torque that starts with radius 1 at the free surface; all others are
/// the same path in another size.
struct PathPoint {
  double depth = 0.0;
  double radius = 1.0;
  double slope = 0.0;  ///< d radius / d depth

  double depth_over_radius() const { return depth / radius; }
};

/// Euler-Lagrange equation of the torque, y the depth: r'' = (1 + r'^2) (2/r - r'/y). At the
/// surface r' = 0 and r'' = 1/r.
std::array<double, 2> path_rate(double depth, double radius, double slope) {
  return {slope, (1.0 + slope * slope) * (2.0 / radius - slope / depth)};
}

/// One Runge-Kutta step of fourth order down to depth * growth.
PathPoint descend(const PathPoint& from, double growth) {
  const double h = from.depth * (growth - 1.0);
  const auto rate = [&](double part, const std::array<double, 2>& k) {
    return path_rate(
        from.depth + part * h, from.radius + part * h * k[0], from.slope + part * h * k[1]);
  };
  const auto k1 = path_rate(from.depth, from.radius, from.slope);
  const auto k2 = rate(0.5, k1);
  const auto k3 = rate(0.5, k2);
  const auto k4 = rate(1.0, k3);
  const auto sum = [&](std::size_t i) { return h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]); };
  return {from.depth + h, from.radius + sum(0), from.slope + sum(1)};
}

constexpr double growth = 1.005;  // of the depth per step: 1e-9 of the radius

/// Close to the surface r = 1 + y^2/2 up to terms of sixth order.
constexpr PathPoint surface_point{1e-3, 1.0 + 0.5e-6, 1e-3};

/// The point at which the path, descending, has this ratio of depth and radius; bisection of the
/// last step, in which the ratio passes it.
PathPoint passing(const PathPoint& before, double ratio) {
  const bool rising = before.depth_over_radius() < ratio;
  double low = 1.0;
  double high = growth;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    const bool short_of = (descend(before, middle).depth_over_radius() < ratio) == rising;
    (short_of ? low : high) = middle;
  }
  return descend(before, high);
}

void require_positive(const char* name, double value) {
  if (!(std::isfinite(value) && value > 0.0))
    throw std::invalid_argument(fmt::format("{} = {} must be finite and positive", name, value));
}

/// State at the centre of the band in units d = rho_p = g = 1, its rate and pressure given.
void add_material(const MuPhi& law, const GrainProperties& grains, SplitBottomRow& row) {
  const Confinement at = confinement(grains, row.pressure);
  row.inertial_number = row.shear_rate / std::sqrt(row.pressure);
  row.friction = std::max(0.0, friction(law, row.inertial_number, at));
  row.volume_fraction = std::max(0.0, volume_fraction(law, row.inertial_number, at));
}

/// Rows in the middle of equal parts of the depth, bottom to top, in units d = rho_p = g = 1; the
/// ends are left out: at the split the band has no width, at the surface no pressure. The weight is
/// that at rest, I -> 0. Returns the torque.
double fill_rows(const MuPhi& law,
                 const GrainProperties& grains,
                 const SplitBottomCase& cell,
                 double scale,
                 std::vector<SplitBottomRow>& rows) {
  const double d = cell.grains.diameter;
  const double omega = cell.rotation_rate * std::sqrt(d / cell.gravity);
  const double depth = cell.depth / d;
  const double part = depth / static_cast<double>(rows.size());
  PathPoint path = surface_point;
  double pressure = 0.0;
  double torque = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SplitBottomRow& row = rows[rows.size() - 1 - i];
    const double below = part * (static_cast<double>(i) + 0.5);
    const double target = below / scale;
    while (path.depth < target) path = descend(path, std::min(growth, target / path.depth));
    row.z = depth - below;
    row.radius = target < surface_point.depth ? scale : scale * path.radius;
    row.width = inner_width(row.z / depth, *cell.surface_width / d);
    const double phi = static_volume_fraction(law, confinement(grains, std::max(pressure, 1e-30)));
    row.pressure = pressure + 0.5 * part * phi;
    pressure += part * phi;
    row.shear_rate = row.radius * omega / (row.width * std::sqrt(std::numbers::pi));
    add_material(law, grains, row);
    torque += 2.0 * std::numbers::pi * row.radius * row.radius * row.friction * row.pressure *
              std::hypot(1.0, path.slope) * part;
  }
  return torque;
}

/// Pressure is highest at the bottom, so softness takes the friction of the lowest row first.
/// Written so that a weight beyond all numbers counts too.
bool no_friction_left(const MuPhi& law, const GrainProperties& grains, const SplitBottomRow& row) {
  return !(std::isfinite(row.pressure) &&
           friction_factor(law, confinement(grains, row.pressure)) > 0.0);
}

void to_case_units(const SplitBottomCase& cell, SplitBottom& result) {
  const double d = cell.grains.diameter;
  const double stress = cell.grains.density * cell.gravity * d;
  for (SplitBottomRow& row : result.rows) {
    row.z *= d;
    row.radius *= d;
    row.width *= d;
    row.pressure *= stress;
    row.shear_rate /= std::sqrt(d / cell.gravity);
  }
  result.torque *= stress * d * d * d;
}

std::string no_single_path(double ratio, const BandPaths& paths) {
  if (ratio < surface_point.depth_over_radius())
    return fmt::format(
        "H / R_s = {:.4g} is too shallow a filling: its path of least torque is not followed",
        ratio);
  if (paths.surface_radius.empty())
    return fmt::format(
        "no path of least torque leads from the split to the free surface at H / R_s = {:.4g}: "
        "the band closes into a dome below it",
        ratio);
  std::string radii;
  for (const double radius : paths.surface_radius) radii += fmt::format(" {:.5g}", radius);
  return fmt::format(
      "{} paths of least torque lead to the free surface at H / R_s = {:.4g}, at R_c / R_s ={}: "
      "none is picked",
      paths.surface_radius.size(),
      ratio,
      radii);
}

}  // namespace

void check(const SplitBottomCase& cell) {
  require_positive("split radius", cell.split_radius);
  require_positive("depth", cell.depth);
  require_positive("rotation rate", cell.rotation_rate);
  require_positive("gravity", cell.gravity);
  require_positive("grain diameter", cell.grains.diameter);
  require_positive("grain density", cell.grains.density);
  if (cell.surface_width) require_positive("surface width", *cell.surface_width);
  constexpr double most = 1e60;  // beyond it powers of the depth are no numbers any more
  const double depth = cell.depth / cell.grains.diameter;
  if (!(depth > 1.0 / most && depth < most))
    throw std::invalid_argument(
        fmt::format("depth = {} is {:.3g} d: it must lie between {:g} and {:g} d",
                    cell.depth,
                    depth,
                    1.0 / most,
                    most));
}

GrainProperties dimensionless_grains(const SplitBottomCase& cell) {
  const double d = cell.grains.diameter;
  const double stress = cell.grains.density * cell.gravity * d;
  GrainProperties grains;
  if (cell.grains.stiffness) grains.stiffness = *cell.grains.stiffness / (stress * d);
  if (cell.grains.adhesion) grains.adhesion = *cell.grains.adhesion / (stress * d * d);
  return grains;
}

BandPaths least_torque_paths(double depth_over_split_radius) {
  constexpr double deepest = 1e3;  // the path is a cone there to 1e-6, r = sqrt(2) y
  BandPaths paths;
  PathPoint point = surface_point;
  while (point.depth < deepest) {
    const PathPoint next = descend(point, growth);
    const bool here = point.depth_over_radius() < depth_over_split_radius;
    if (here != (next.depth_over_radius() < depth_over_split_radius))
      paths.surface_radius.push_back(1.0 / passing(point, depth_over_split_radius).radius);
    point = next;
  }
  return paths;
}

double measured_surface_radius(double depth_over_split_radius) {
  return 1.0 - std::pow(depth_over_split_radius, 2.5);
}

double rotation_share(double radius, double centre, double width) {
  return 0.5 + 0.5 * std::erf((radius - centre) / width);
}

double inner_width(double height_over_depth, double surface_width) {
  const double below = 1.0 - height_over_depth;
  return surface_width * std::sqrt(1.0 - below * below);
}

SplitBottom split_bottom(const RheologyTable& table, const SplitBottomCase& cell, int rows) {
  validate(table);
  check(cell);
  if (rows < 2) throw std::invalid_argument("at least 2 rows are needed");
  const auto* law = std::get_if<MuPhi>(&table.law);
  if (law == nullptr)
    throw TableError(
        "a generalised Bagnold law holds at its own tilt only: a ring cell needs a table of mu(I) "
        "and phi(I)");
  const double ratio = cell.depth / cell.split_radius;
  const double d = cell.grains.diameter;
  SplitBottomCase complete = cell;
  if (!cell.surface_width) complete.surface_width = d * std::cbrt(cell.depth / d * cell.depth / d);
  SplitBottom result;
  result.surface_width = *complete.surface_width;
  result.measured_radius = cell.split_radius * std::max(0.0, measured_surface_radius(ratio));
  const BandPaths paths = least_torque_paths(ratio);
  if (paths.surface_radius.size() != 1) {
    result.answer.text = no_single_path(ratio, paths);
    return result;
  }
  result.path_radius = cell.split_radius * paths.surface_radius.front();
  result.rows.resize(static_cast<std::size_t>(rows));
  const GrainProperties grains = dimensionless_grains(cell);
  result.torque = fill_rows(*law, grains, complete, result.path_radius / d, result.rows);
  if (no_friction_left(*law, grains, result.rows.front())) {
    result.rows.clear();
    result.torque = 0.0;
    result.answer = {.outcome = Outcome::no_steady,
                     .text =
                         "softness takes all friction, f_p <= 0, at the bottom of this filling, "
                         "where the law has no answer"};
    return result;
  }
  result.answer = {
      .outcome = Outcome::steady,
      .text = fmt::format("geometry, not a solution of the flow: the band ends at R_c / R_s = "
                          "{:.5g} on the path of least torque, {:.5g} by experiments; error "
                          "function across it",
                          paths.surface_radius.front(),
                          measured_surface_radius(ratio)),
      .out_of_domain = filling_flags(*law, grains, table, cell.depth / d, result.rows)};
  to_case_units(cell, result);
  return result;
}

}  // namespace grainlaw::continuum
