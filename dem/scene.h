#pragma once

#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
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

/// Volume fraction of a dense flow, to turn a depth into a number of grains and back.
inline constexpr double nominal_packing = 0.57;

/// Inclined layer with free surface, periodic in x (flow) and y (vorticity), z normal to the base
/// (Brewster et al. 2008, section II). Gravity is (g sin(theta), 0, -g cos(theta)).
struct Chute {
  double inclination = 0.0;  ///< theta [rad], in [0, pi/2): the layer flows in +x
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

/// What validate() accepts, for readers and documentation of scenes.
namespace limits {
struct Interval {
  double least;
  double most;
};
inline constexpr double least_period = 3.0;  ///< [d]; in a shorter one a grain meets its own image
inline constexpr Interval base_thickness{1.0, 10.0};        ///< [d]; thinner ones have holes
inline constexpr Interval base_packing_fraction{0.4, 0.6};  ///< looser: holes; denser: no packing
inline constexpr double overlap = 1.0;                      ///< max_overlap is below it
inline constexpr int grains = 1'000'000;                    ///< base included: days on one thread
inline constexpr double least_bin_width = 0.1;              ///< [d]
inline constexpr double least_bins = 3.0;  ///< of the nominal depth: a bin and both neighbours,
                                           ///< from which its shear rate is taken
inline constexpr double steps = 1e12;      ///< of a run: years on one thread
}  // namespace limits

/// A scene that contradicts itself; the message says what, which value, which bound and the remedy.
/// Lengths, masses and times in it are in the units of the scene.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
  /// `section` and `key` as scene files name them.
  SceneError(const std::string& message, std::string_view in_section, std::string_view about_key)
      : std::runtime_error(message), section(in_section), key(about_key) {}

  std::string section;  ///< "geometry.base"; empty: top level, or the scene as a whole
  std::string key;      ///< "thickness"; empty: the section as a whole
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

/// Depth of the flowing grains at nominal_packing [length].
double nominal_depth(const Scene& scene);

/// Flowing mass per unit area of the base, N m / (length width) [mass/length^2].
double mass_per_area(const Scene& scene);

/// What a run uses and what is left out because the scene does not ask for it, a line each.
struct SceneSummary {
  std::vector<std::string> used;
  std::vector<std::string> left_out;
};
SceneSummary summarise(const Scene& scene);

}  // namespace grainlaw::dem
