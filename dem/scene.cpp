#include "dem/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::dem {
namespace {

constexpr double default_steps_per_contact = 50.0;
constexpr double least_steps_per_contact = 15.0;

template <class... Parts>
void refuse_unless(bool good, fmt::format_string<Parts...> message, Parts&&... parts) {
  if (!good) throw SceneError(fmt::format(message, std::forward<Parts>(parts)...));
}

void positive(double value, std::string_view what) {
  refuse_unless(
      value > 0.0 && std::isfinite(value), "{} = {}: must be positive and finite", what, value);
}

void check_grains(const Grains& grains) {
  positive(grains.diameter, "grain diameter");
  positive(grains.mass, "grain mass");
}

void check(const Hooke& law, const Grains& grains) {
  positive(law.stiffness, "normal stiffness");
  // A grain on a frozen one has the larger reduced mass, m, and is damped critically first.
  const double critical = 2.0 * std::sqrt(law.stiffness / grains.mass);
  refuse_unless(law.damping >= 0.0 && law.damping < critical,
                "normal damping = {}: must lie in [0, {:.6g}); at {:.6g} = 2 sqrt(k/m) a grain no "
                "longer bounces off the base: lower the damping or raise the stiffness",
                law.damping,
                critical,
                critical);
}

void check(const Frictionless&, const Grains&) {}

void check(const Sliding& law, const Grains&) {
  refuse_unless(law.coefficient >= 0.0 && std::isfinite(law.coefficient),
                "friction coefficient = {}: must be 0 or positive",
                law.coefficient);
  refuse_unless(
      law.coefficient > 0.0,
      "friction coefficient = {}: leave the friction law out instead, then grains need no "
      "rotation and contacts no history",
      law.coefficient);
  positive(law.stiffness, "tangential stiffness");
  refuse_unless(law.damping >= 0.0 && std::isfinite(law.damping),
                "tangential damping = {}: must be 0 or positive",
                law.damping);
}

void check(const Chute& chute, const Grains& grains) {
  const double degrees = chute.inclination * 180.0 / std::numbers::pi;
  refuse_unless(
      std::abs(degrees) < 90.0, "inclination = {:.6g} degrees: must lie inside (-90, 90)", degrees);
  positive(chute.gravity, "gravity");
  refuse_unless(chute.grains >= 1, "grains = {}: at least 1 must flow", chute.grains);
  refuse_unless(chute.grains <= 10'000'000, "grains = {}: at most 1e7", chute.grains);
  const double least = 3.0 * grains.diameter;
  for (const auto& [what, period] :
       {std::pair{"length", chute.length}, std::pair{"width", chute.width}}) {
    refuse_unless(
        period >= least && std::isfinite(period),
        "{} = {}: the period must be at least {:.6g} (3 d), else a grain meets its own image",
        what,
        period,
        least);
  }
  refuse_unless(chute.base.thickness >= 1.0 && chute.base.thickness <= 10.0,
                "base thickness = {} d: must lie in [1, 10]; thinner ones have holes",
                chute.base.thickness);
  refuse_unless(chute.base.packing_fraction >= 0.4 && chute.base.packing_fraction <= 0.6,
                "base packing_fraction = {}: must lie in [0.4, 0.6]; looser has holes, denser does "
                "not come apart from random positions",
                chute.base.packing_fraction);
}

void check(const Measurement& m, const Grains& grains, double step) {
  positive(m.bin_width, "bin_width");
  refuse_unless(m.bin_width >= 0.1 * grains.diameter,
                "bin_width = {}: must be at least {:.6g} (0.1 d)",
                m.bin_width,
                0.1 * grains.diameter);
  positive(m.sample_interval, "sample_interval");
  refuse_unless(m.sample_interval >= step,
                "sample_interval = {}: must be at least one time step ({:.4g})",
                m.sample_interval,
                step);
  refuse_unless(m.frame_interval >= m.sample_interval && std::isfinite(m.frame_interval),
                "frame_interval = {}: must be at least sample_interval = {}",
                m.frame_interval,
                m.sample_interval);
  refuse_unless(m.averaging_time >= 4.0 * m.frame_interval && std::isfinite(m.averaging_time),
                "averaging_time = {}: must be at least 4 frames of {}, else no error can be given",
                m.averaging_time,
                m.frame_interval);
  refuse_unless(m.time_limit >= m.averaging_time && std::isfinite(m.time_limit),
                "time_limit = {}: must be at least averaging_time = {}",
                m.time_limit,
                m.averaging_time);
}

void check_step(const Scene& scene) {
  refuse_unless(scene.time_step >= 0.0 && std::isfinite(scene.time_step),
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
                  contact / default_steps_per_contact));
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
  summary.left_out.push_back("no cohesion: no force beyond contact, list reach = contact + skin");
}
void describe(const Frictionless&, SceneSummary& summary) {
  summary.left_out.push_back("no friction: no rotation, no history, no tangential force");
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
    summary.left_out.push_back("no tangential damping");
  }
}

}  // namespace

void validate(const Scene& scene) {
  check_grains(scene.grains);
  std::visit([&](const auto& law) { check(law, scene.grains); }, scene.normal);
  std::visit([&](const auto& law) { check(law, scene.grains); }, scene.friction);
  check(scene.geometry, scene.grains);
  refuse_unless(scene.max_overlap > 0.0 && scene.max_overlap < 1.0,
                "max_overlap = {}: must lie in (0, 1), a fraction of the radius",
                scene.max_overlap);
  check_step(scene);
  check(scene.measurement, scene.grains, time_step(scene));
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
  summary.left_out.push_back("equal grains: no radius or mass per grain");
  summary.left_out.push_back("no side walls: periodic along and across the flow");
  return summary;
}

std::string recipe(const BumpyBase& base) {
  return fmt::format("glued random layer, {:.6g} d of centres at packing fraction {:.6g}",
                     base.thickness,
                     base.packing_fraction);
}

}  // namespace grainlaw::dem
