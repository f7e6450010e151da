#pragma once

#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "dem/cohesion_laws.h"
#include "dem/friction_laws.h"
#include "dem/normal_laws.h"

namespace grainlaw::dem {

/// Monodisperse spheres. All numbers of a scene are in one consistent set of units; inside
/// grainlaw that is the set "grain", in which mass, diameter and gravity are 1.
struct Grains {
  double diameter = 1.0;  ///< d [length]
  double mass = 1.0;      ///< m [mass]

  double density() const {  ///< rho_p = 6 m / (pi d^3) [mass/length^3]
    return 6.0 * mass / (std::numbers::pi * diameter * diameter * diameter);
  }
};

/// Frozen slab cut from a random packing: every grain whose centre lies in a layer of the given
/// thickness is glued. z = 0 of the chute is the plane of the highest glued centre + d/2.
struct BumpyBase {
  double thickness = 1.5;           ///< of the layer of centres [d]
  double packing_fraction = 0.585;  ///< of the packing it is cut from
};

/// The base in words, equal for equal recipes.
std::string recipe(const BumpyBase& base);

/// Inclined layer with free surface, periodic in x (flow) and y (vorticity), z normal to the base
/// (Brewster et al. 2008, section II). Gravity is (g sin(theta), 0, -g cos(theta)).
struct Chute {
  double inclination = 0.0;  ///< theta [rad]
  double gravity = 1.0;      ///< g [length/time^2]
  double length = 8.0;       ///< period in x [length]
  double width = 8.0;        ///< period in y [length]
  int grains = 0;            ///< number of flowing grains
  BumpyBase base;
};

/// What is averaged and for how long. Times in units of the scene.
struct Measurement {
  double bin_width = 1.0;         ///< in z [length]
  double sample_interval = 0.1;   ///< between two samples of the fields [time]
  double frame_interval = 2.0;    ///< samples are summed over frames of this length [time]
  double averaging_time = 200.0;  ///< wanted length of the steady window [time]
  double time_limit = 1000.0;     ///< the run ends here even if it is not steady [time]
};

/// Everything that shapes a DEM run. Plain values; valid after validate().
struct Scene {
  std::string name;  ///< of the run, for messages and reports
  Grains grains;
  std::variant<Hooke> normal = Hooke{};
  std::variant<Cohesionless> cohesion = Cohesionless{};
  std::variant<Frictionless, Sliding> friction = Frictionless{};
  Chute geometry;
  Measurement measurement;
  double time_step = 0.0;            ///< [time]; 0: shortest contact time / 50
  bool allow_unstable_step = false;  ///< accept a step above shortest contact time / 15
  double max_overlap = 0.3;          ///< stop when an overlap exceeds this fraction of the radius
  std::uint64_t seed = 1;
};

/// A scene that contradicts itself; the message says what, which value, which bound and the remedy.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A time step that would be unstable (above shortest contact time / 15).
struct StepRefused : SceneError {
  using SceneError::SceneError;
};

/// Checks the scene as a whole. Throws SceneError or StepRefused.
void validate(const Scene& scene);

/// Shortest contact time over the stiffnesses present, normal and tangential, of an undamped pair:
/// pi sqrt(m_eff / k) with m_eff the effective mass of that mode [time].
double shortest_contact_time(const Scene& scene);

/// The step a run of this scene takes: its own, or the default [time].
double time_step(const Scene& scene);

/// Flowing mass per unit area of the base, N m / (length width) [mass/length^2].
double mass_per_area(const Scene& scene);

/// What a run uses and what is left out because the scene does not ask for it, a line each.
struct SceneSummary {
  std::vector<std::string> used;
  std::vector<std::string> left_out;
};
SceneSummary summarise(const Scene& scene);

}  // namespace grainlaw::dem
