#include <fmt/format.h>

#include "dem/scene.h"

namespace grainlaw::dem {
namespace {

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

std::string words(const BumpyBase& base) {
  return fmt::format("glued random layer, {:.6g} d of centres at packing fraction {:.6g}",
                     base.thickness,
                     base.packing_fraction);
}
std::string words(const LatticeBase& base) {
  return fmt::format("glued triangular lattice, spacing {:.6g} d", base.spacing);
}
std::string words(const FlatBase& base) {
  return base.frictional ? "flat, frictional" : "flat, smooth";
}

template <class Law>
std::string damping_in_words(const Law& law) {
  if constexpr (std::is_same_v<Law, Hooke>) {
    constexpr double any_mass = 1.0;
    if (law.root_damping > 0.0) {
      return fmt::format("restitution {:.6g} of all pairs", law.restitution(any_mass));
    }
  }
  if (law.dashpot > 0.0) return fmt::format("dashpot {:.6g} of all pairs", law.dashpot);
  return fmt::format("damping rate {:.6g}", law.damping);
}

template <class Law>
void describe_normal(const Law& law, std::string_view words, SceneSummary& summary) {
  summary.used.push_back(
      fmt::format("normal: {}, stiffness {:.6g}, {}{}",
                  words,
                  law.stiffness,
                  damping_in_words(law),
                  law.clip_attraction ? ", never negative between touching grains" : ""));
}
void describe(const Hooke& law, SceneSummary& summary) {
  describe_normal(law, "spring and dashpot", summary);
}
void describe(const Hertz& law, SceneSummary& summary) {
  describe_normal(law, "Hertz, spring and dashpot times sqrt(overlap)", summary);
}

std::string_view words(CoulombReference reference) {
  return reference == CoulombReference::total ? "the total normal force"
                                              : "the contact force without cohesion";
}
template <class Law>
void describe_cohesion(const Law& law, const std::string& words_of_law, SceneSummary& summary) {
  summary.used.push_back(
      fmt::format("cohesion: {}, reaches {:.6g} beyond contact; friction is "
                  "bounded by {}",
                  words_of_law,
                  law.range(),
                  words(law.reference)));
}

void describe(const Cohesionless&, SceneSummary& summary) {
  summary.left_out.emplace_back(
      "no cohesion: no force beyond contact, list reach = contact + skin");
}
void describe(const GaussianWell& law, SceneSummary& summary) {
  describe_cohesion(
      law,
      fmt::format("Gaussian well, strength {:.6g}, width {:.6g}", law.strength, law.width),
      summary);
}
void describe(const ReversibleAdhesion& law, SceneSummary& summary) {
  describe_cohesion(
      law,
      fmt::format(
          "reversible adhesion, largest force {:.6g}, slope {:.6g}", law.largest_force, law.slope),
      summary);
}
void describe(const LiquidBridge& law, SceneSummary& summary) {
  describe_cohesion(law,
                    fmt::format("liquid bridges, surface tension {:.6g}, contact angle {:.6g} "
                                "degrees, volume {:.6g}",
                                law.surface_tension,
                                degrees(law.contact_angle),
                                law.volume),
                    summary);
}

template <class Law>
void describe_friction(const Law& law, const std::string& coefficients, SceneSummary& summary) {
  summary.used.push_back(
      fmt::format("friction: {}, tangential stiffness {:.6g}; rotation, one "
                  "spring per contact",
                  coefficients,
                  law.stiffness));
  if (law.damping > 0.0) {
    summary.used.push_back(fmt::format("tangential damping rate {:.6g}", law.damping));
  } else if (law.dashpot > 0.0) {
    summary.used.push_back(fmt::format("tangential dashpot {:.6g} of all pairs", law.dashpot));
  } else {
    summary.left_out.emplace_back("no tangential damping");
  }
  summary.left_out.emplace_back("no rolling or torsion resistance");
}
void describe(const Frictionless&, SceneSummary& summary) {
  summary.left_out.emplace_back("no friction: no rotation, no history, no tangential force");
}
void describe(const Sliding& law, SceneSummary& summary) {
  describe_friction(law, fmt::format("coefficient {:.6g}", law.coefficient), summary);
}
void describe(const StickSlip& law, SceneSummary& summary) {
  describe_friction(
      law,
      fmt::format(
          "coefficients {:.6g} static, {:.6g} dynamic", law.static_coefficient, law.coefficient),
      summary);
}

void describe(const Grains& grains, SceneSummary& summary) {
  if (grains.size_ratio == 1.0) {
    summary.left_out.emplace_back("equal grains: no radius or mass per grain");
  } else {
    summary.used.push_back(fmt::format("sizes: diameters spread uniformly from {:.6g} to {:.6g}",
                                       grains.smallest(),
                                       grains.largest()));
  }
}

void describe(const Chute& chute, const Scene& scene, SceneSummary& summary) {
  const bool own_base = scene.start.empty() || std::holds_alternative<FlatBase>(chute.base);
  summary.used.push_back(
      fmt::format("chute: {} grains on {:.6g} x {:.6g} at {:.6g} degrees, base {}",
                  grains(scene),
                  chute.length,
                  chute.width,
                  degrees(chute.inclination),
                  own_base ? recipe(chute.base) : "of the start"));
  for (const TiltStep& tilt : chute.tilts) {
    summary.used.push_back(fmt::format(
        "tilt: {:.6g} degrees from t = {:.6g} on", degrees(tilt.inclination), tilt.time));
  }
  if (chute.sidewalls) {
    summary.used.push_back(
        fmt::format("side walls: flat, {}", chute.sidewalls->frictional ? "frictional" : "smooth"));
  } else {
    summary.left_out.emplace_back("no side walls: periodic along and across the flow");
  }
  if (!scene.start_profile.empty()) {
    summary.used.push_back(
        fmt::format("start: settled, then moving as a profile, {:.6g} at z = {:.6g}",
                    scene.start_profile.back().velocity,
                    scene.start_profile.back().z));
  }
}
void describe(const SimpleShear& shear, const Scene& scene, SceneSummary& summary) {
  const Vec3 size = start_size(scene.grains, shear);
  summary.used.push_back(fmt::format(
      "simple shear: {} grains in {:.6g} x {:.6g} x {:.6g} at the rate {:.6g}, {}",
      grains(scene),
      size.x,
      size.y,
      size.z,
      shear.shear_rate,
      shear.pressure ? fmt::format("sigma_yy held at {:.6g}", *shear.pressure) : "fixed volume"));
  summary.left_out.emplace_back("no gravity, no walls: periodic, sheared by its boundaries");
}
void describe(const PlaneShear& shear, const Scene& scene, SceneSummary& summary) {
  summary.used.push_back(fmt::format(
      "plane shear: {} grains on {:.6g} x {:.6g}, upper wall moving at {:.6g}, {}; walls {}",
      grains(scene),
      shear.length,
      shear.width,
      shear.velocity,
      shear.load ? fmt::format("loaded by {:.6g}", *shear.load) : "fixed distance",
      scene.start.empty() ? recipe(shear.wall) : "of the start"));
  if (shear.gravity > 0.0) {
    summary.used.push_back(fmt::format("gravity {:.6g}", shear.gravity));
  } else {
    summary.left_out.emplace_back("no gravity");
  }
}
void describe(const BodyForceBox& box, const Scene& scene, SceneSummary& summary) {
  summary.used.push_back(fmt::format(
      "body force: {} grains on {:.6g} x {:.6g}, {:.6g} high at the start, amplitude {:.6g}, "
      "sigma_yy held at {:.6g}",
      grains(scene),
      box.length,
      box.width,
      start_height(scene.grains, box),
      box.amplitude,
      box.pressure));
  summary.left_out.emplace_back("no gravity, no walls: periodic in all directions");
}
void describe(const SplitBottom& cell, const Scene& scene, SceneSummary& summary) {
  summary.used.push_back(fmt::format(
      "split bottom: {} grains in a wedge of {:.6g} degrees, radii {:.6g}, {:.6g} (split), {:.6g}, "
      "{:.4g} deep, turning at {:.6g}",
      grains(scene),
      degrees(cell.wedge),
      cell.inner_radius,
      cell.split_radius,
      cell.outer_radius,
      nominal_depth(scene.grains, cell),
      cell.rotation_rate));
  summary.left_out.emplace_back(fmt::format("{:.0f} of {:.0f} wedges: periodic around the axis",
                                            2.0 * std::numbers::pi / cell.wedge - 1.0,
                                            2.0 * std::numbers::pi / cell.wedge));
}

std::string_view word(const Chute&) {
  return "chute";
}
std::string_view word(const SimpleShear&) {
  return "simple_shear";
}
std::string_view word(const PlaneShear&) {
  return "plane_shear";
}
std::string_view word(const BodyForceBox&) {
  return "body_force_box";
}
std::string_view word(const SplitBottom&) {
  return "split_bottom";
}

}  // namespace

std::string_view kind(const Geometry& geometry) {
  return std::visit([](const auto& shape) { return word(shape); }, geometry);
}

std::string recipe(const Base& base) {
  return std::visit([](const auto& made) { return words(made); }, base);
}

SceneSummary summarise(const Scene& scene) {
  SceneSummary summary;
  const auto law = [&](const auto& part) { describe(part, summary); };
  std::visit(law, scene.normal);
  std::visit(law, scene.friction);
  std::visit(law, scene.cohesion);
  describe(scene.grains, summary);
  std::visit([&](const auto& shape) { describe(shape, scene, summary); }, scene.geometry);
  if (!scene.start.empty()) {
    summary.used.push_back(
        fmt::format("start: {} grains as given, no packing made", scene.start.size()));
  }
  if (scene.lifetimes) {
    summary.used.push_back(
        fmt::format("contact lifetimes for {} contact distances", contact_gaps(scene).size()));
  }
  const double step = time_step(scene);
  const double shortest = shortest_contact_time(scene);
  summary.used.push_back(fmt::format("time step {:.4g}, {:.1f} per shortest contact time ({:.4g})",
                                     step,
                                     shortest / step,
                                     shortest));
  return summary;
}

}  // namespace grainlaw::dem
