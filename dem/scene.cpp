#include "dem/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace grainlaw::dem {
namespace {

constexpr double default_steps_per_contact = 50.0;
constexpr double least_steps_per_contact = 15.0;

/// Where scene files state a number.
struct Place {
  std::string_view section;
  std::string_view key;
};

template <class... Parts>
void refuse_unless(bool good,
                   const Place& at,
                   fmt::format_string<Parts...> message,
                   Parts&&... parts) {
  if (good) return;
  throw SceneError(fmt::format(message, std::forward<Parts>(parts)...), at.section, at.key);
}

void positive(double value, const Place& at, std::string_view what) {
  refuse_unless(
      value > 0.0 && std::isfinite(value), at, "{} = {}: must be positive and finite", what, value);
}

void check_grains(const Grains& grains) {
  positive(grains.diameter, {"grains", "diameter"}, "grain diameter");
  positive(grains.mass, {"grains", "density"}, "grain mass");
}

void check(const Hooke& law, const Grains& grains) {
  positive(law.stiffness, {"contact.normal", "stiffness"}, "normal stiffness");
  // A grain on a frozen one has the larger reduced mass, m, and is damped critically first.
  const double critical = 2.0 * std::sqrt(law.stiffness / grains.mass);
  refuse_unless(law.damping >= 0.0 && law.damping < critical,
                {"contact.normal", ""},
                "normal damping = {}: must lie in [0, {:.6g}); at {:.6g} = 2 sqrt(k/m) a grain no "
                "longer bounces off the base: lower the damping or raise the stiffness",
                law.damping,
                critical,
                critical);
}

void check(const Frictionless&, const Grains&) {}

void check(const Sliding& law, const Grains&) {
  constexpr std::string_view section = "contact.friction";
  refuse_unless(law.coefficient >= 0.0 && std::isfinite(law.coefficient),
                {section, "coefficient"},
                "friction coefficient = {}: must be 0 or positive",
                law.coefficient);
  refuse_unless(
      law.coefficient > 0.0,
      {section, "coefficient"},
      "friction coefficient = {}: leave the friction law out instead, then grains need no "
      "rotation and contacts no history",
      law.coefficient);
  positive(law.stiffness, {section, "stiffness"}, "tangential stiffness");
  refuse_unless(law.damping >= 0.0 && std::isfinite(law.damping),
                {section, "damping_rate"},
                "tangential damping = {}: must be 0 or positive",
                law.damping);
}

void check_inclination(double inclination) {
  const double degrees = inclination * 180.0 / std::numbers::pi;
  refuse_unless(degrees >= 0.0 && degrees < 90.0,
                {"geometry", "inclination"},
                "inclination = {:.6g} degrees: must lie in [0, 90){}",
                degrees,
                degrees < 0.0 ? "; a negative tilt flows in -x, where velocity, shear rate and "
                                "shear stress change sign: mirror the scene"
                              : "");
}

void check_period(std::string_view name, double period, const Grains& grains) {
  const double least = limits::least_period * grains.diameter;
  refuse_unless(
      period >= least && std::isfinite(period),
      {"geometry", name},
      "{} = {}: the period must be at least {:.6g} ({} d), else a grain meets its own image",
      name,
      period,
      least,
      limits::least_period);
}

void check(const BumpyBase& base) {
  const auto inside = [](double value, const limits::Interval& interval) {
    return value >= interval.least && value <= interval.most;
  };
  refuse_unless(inside(base.thickness, limits::base_thickness),
                {"geometry.base", "thickness"},
                "base thickness = {} d: must lie in [{}, {}]; thinner ones have holes",
                base.thickness,
                limits::base_thickness.least,
                limits::base_thickness.most);
  refuse_unless(inside(base.packing_fraction, limits::base_packing_fraction),
                {"geometry.base", "packing_fraction"},
                "base packing_fraction = {}: must lie in [{}, {}]; looser has holes, denser does "
                "not come apart from random positions",
                base.packing_fraction,
                limits::base_packing_fraction.least,
                limits::base_packing_fraction.most);
}

/// Grains packed to cut the base and a margin from, beside those that flow (pack_chute).
double grains_for_base(const Chute& chute, const Grains& grains) {
  const double slab = (chute.base.thickness + 2.0) * grains.diameter * chute.length * chute.width;
  return chute.base.packing_fraction * slab * grains.density() / grains.mass;
}

void check(const Chute& chute, const Grains& grains) {
  check_inclination(chute.inclination);
  positive(chute.gravity, {"geometry", "gravity"}, "gravity");
  refuse_unless(
      chute.grains >= 1, {"geometry", "grains"}, "grains = {}: at least 1 must flow", chute.grains);
  refuse_unless(chute.grains <= limits::grains,
                {"geometry", "grains"},
                "grains = {}: at most {}",
                chute.grains,
                limits::grains);
  check_period("length", chute.length, grains);
  check_period("width", chute.width, grains);
  check(chute.base);
  const double base = grains_for_base(chute, grains);
  refuse_unless(chute.grains + base <= limits::grains,
                {"geometry", "length"},
                "length x width = {:.6g} x {:.6g}: {} flowing grains and {:.0f} to cut the base "
                "from, together at most {}; take a smaller base",
                chute.length,
                chute.width,
                chute.grains,
                base,
                limits::grains);
}

void check_bins(double width, const Scene& scene) {
  constexpr Place at{"measurement", "bin_width"};
  const double least = limits::least_bin_width * scene.grains.diameter;
  const double depth = nominal_depth(scene);
  positive(width, at, "bin_width");
  refuse_unless(width >= least,
                at,
                "bin_width = {}: must be at least {:.6g} ({} d)",
                width,
                least,
                limits::least_bin_width);
  refuse_unless(width <= depth / limits::least_bins,
                at,
                "bin_width = {}: at most {:.4g}, a third of the nominal depth {:.4g} of {} grains: "
                "the shear rate of a bin needs a neighbour on both sides; narrow the bins or "
                "deepen the layer",
                width,
                depth / limits::least_bins,
                depth,
                scene.geometry.grains);
}

void check_times(const Measurement& m, double step) {
  constexpr std::string_view section = "measurement";
  positive(m.sample_interval, {section, "sample_interval"}, "sample_interval");
  refuse_unless(m.sample_interval >= step,
                {section, "sample_interval"},
                "sample_interval = {}: must be at least one time step ({:.4g})",
                m.sample_interval,
                step);
  refuse_unless(m.frame_interval >= m.sample_interval && std::isfinite(m.frame_interval),
                {section, "frame_interval"},
                "frame_interval = {}: must be at least sample_interval = {}",
                m.frame_interval,
                m.sample_interval);
  refuse_unless(m.averaging_time >= 4.0 * m.frame_interval && std::isfinite(m.averaging_time),
                {section, "averaging_time"},
                "averaging_time = {}: must be at least 4 frames of {}, else no error can be given",
                m.averaging_time,
                m.frame_interval);
  refuse_unless(m.time_limit >= m.averaging_time && std::isfinite(m.time_limit),
                {section, "time_limit"},
                "time_limit = {}: must be at least averaging_time = {}",
                m.time_limit,
                m.averaging_time);
}

void check_number_of_steps(const Scene& scene) {
  const double step = time_step(scene);
  const double limit = scene.measurement.time_limit;
  refuse_unless(limit / step <= limits::steps,
                {"time", "step"},
                "time step = {:.3g}: {:.3g} steps until time_limit = {}, at most {:.0e}; lengthen "
                "the step or shorten the run",
                step,
                limit / step,
                limit,
                limits::steps);
}

void check_step(const Scene& scene) {
  constexpr Place at{"time", "step"};
  refuse_unless(scene.time_step >= 0.0 && std::isfinite(scene.time_step),
                at,
                "time_step = {}: must be positive, or 0 for the default",
                scene.time_step);
  const double contact = shortest_contact_time(scene);
  const double largest = contact / least_steps_per_contact;
  if (scene.allow_unstable_step || scene.time_step <= largest) return;
  const double stiffness = std::visit([](const auto& law) { return law.stiffness; }, scene.normal);
  throw StepRefused(
      fmt::format("time_step = {:.3g} exceeds 1/15 of the shortest contact time ({:.3g} for "
                  "stiffness = {:.6g}): "
                  "at most {:.3g}; the default would be {:.3g}",
                  scene.time_step,
                  contact,
                  stiffness,
                  largest,
                  contact / default_steps_per_contact),
      at.section,
      at.key);
}

double tangential_contact_time(const Frictionless&, double) {
  return std::numeric_limits<double>::infinity();
}
double tangential_contact_time(const Sliding& law, double mass) {
  return law.contact_time(mass);
}

void describe(const Hooke& law, SceneSummary& summary) {
  summary.used.push_back(fmt::format(
      "normal: spring and dashpot, stiffness {:.6g}, damping {:.6g}", law.stiffness, law.damping));
}
void describe(const Cohesionless&, SceneSummary& summary) {
  summary.left_out.emplace_back(
      "no cohesion: no force beyond contact, list reach = contact + skin");
}
void describe(const Frictionless&, SceneSummary& summary) {
  summary.left_out.emplace_back("no friction: no rotation, no history, no tangential force");
}
void describe(const Sliding& law, SceneSummary& summary) {
  summary.used.push_back(
      fmt::format("friction: coefficient {:.6g}, tangential stiffness {:.6g}; rotation, one spring "
                  "per contact",
                  law.coefficient,
                  law.stiffness));
  if (law.damping > 0.0) {
    summary.used.push_back(fmt::format("tangential dashpot {:.6g}", law.damping));
  } else {
    summary.left_out.emplace_back("no tangential damping");
  }
}

}  // namespace

void validate(const Scene& scene) {
  check_grains(scene.grains);
  std::visit([&](const auto& law) { check(law, scene.grains); }, scene.normal);
  std::visit([&](const auto& law) { check(law, scene.grains); }, scene.friction);
  check(scene.geometry, scene.grains);
  refuse_unless(scene.max_overlap > 0.0 && scene.max_overlap < limits::overlap,
                {"", "max_overlap"},
                "max_overlap = {}: must lie in (0, {}), a fraction of the radius",
                scene.max_overlap,
                limits::overlap);
  check_step(scene);
  check_bins(scene.measurement.bin_width, scene);
  check_times(scene.measurement, time_step(scene));
  check_number_of_steps(scene);
}

double shortest_contact_time(const Scene& scene) {
  const double mass = scene.grains.mass;
  const double normal =
      std::visit([&](const auto& law) { return law.contact_time(0.5 * mass); }, scene.normal);
  const double tangential = std::visit(
      [&](const auto& law) { return tangential_contact_time(law, mass); }, scene.friction);
  return std::min(normal, tangential);
}

double time_step(const Scene& scene) {
  if (scene.time_step > 0.0) return scene.time_step;
  return shortest_contact_time(scene) / default_steps_per_contact;
}

double nominal_depth(const Scene& scene) {
  return mass_per_area(scene) / (nominal_packing * scene.grains.density());
}

double mass_per_area(const Scene& scene) {
  return scene.geometry.grains * scene.grains.mass / (scene.geometry.length * scene.geometry.width);
}

SceneSummary summarise(const Scene& scene) {
  SceneSummary summary;
  std::visit([&](const auto& law) { describe(law, summary); }, scene.normal);
  std::visit([&](const auto& law) { describe(law, summary); }, scene.friction);
  std::visit([&](const auto& law) { describe(law, summary); }, scene.cohesion);
  const Chute& chute = scene.geometry;
  summary.used.push_back(
      fmt::format("chute: {} grains on {:.6g} x {:.6g} at {:.6g} degrees, base {}",
                  chute.grains,
                  chute.length,
                  chute.width,
                  chute.inclination * 180.0 / std::numbers::pi,
                  recipe(chute.base)));
  const double step = time_step(scene);
  summary.used.push_back(fmt::format("time step {:.4g}, {:.1f} per shortest contact time ({:.4g})",
                                     step,
                                     shortest_contact_time(scene) / step,
                                     shortest_contact_time(scene)));
  summary.left_out.emplace_back("equal grains: no radius or mass per grain");
  summary.left_out.emplace_back("no side walls: periodic along and across the flow");
  return summary;
}

std::string recipe(const BumpyBase& base) {
  return fmt::format("glued random layer, {:.6g} d of centres at packing fraction {:.6g}",
                     base.thickness,
                     base.packing_fraction);
}

}  // namespace grainlaw::dem
