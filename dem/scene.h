#pragma once

#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dem/cohesion_laws.h"
#include "dem/friction_laws.h"
#include "dem/kernel.h"
#include "dem/normal_laws.h"
#include "dem/tilt_step.h"
#include "dem/vec3.h"

namespace grainlaw::dem {

/// Spheres of one density, with diameters spread uniformly (by number) between the smallest and the
/// largest. All numbers of a scene are in one consistent set of units; inside grainlaw that is the
/// set "grain", in which the mass of a grain of mean diameter, that diameter and gravity are 1.
struct Grains {
  double diameter = 1.0;    ///< d, number mean [length]
  double mass = 1.0;        ///< m of a grain of the mean diameter [mass]
  double size_ratio = 1.0;  ///< w, largest diameter over smallest (Shi et al. 2020); 1: equal

  double smallest() const { return 2.0 * diameter / (1.0 + size_ratio); }              ///< [length]
  double largest() const { return 2.0 * size_ratio * diameter / (1.0 + size_ratio); }  ///< [length]
  double density() const {  ///< rho_p = 6 m / (pi d^3) [mass/length^3]
    return 6.0 * mass / (std::numbers::pi * diameter * diameter * diameter);
  }
  double mass_of(double grain_diameter) const {  ///< [mass]
    const double ratio = grain_diameter / diameter;
    return mass * ratio * ratio * ratio;
  }
  /// Mean mass of a grain: <D^3> = d^3 (1 + ((w - 1)/(w + 1))^2) for uniform sizes [mass].
  double mean_mass() const {
    const double spread = (size_ratio - 1.0) / (size_ratio + 1.0);
    return mass * (1.0 + spread * spread);
  }
};

/// Frozen slab cut from a random packing: every grain whose centre lies in a layer of the given
/// thickness is glued, and one in every hole that lets a mean grain through. z = 0 of the chute is
/// the plane of the highest glued centre + d/2.
struct BumpyBase {
  double thickness = 1.5;           ///< of the layer of centres [d]
  double packing_fraction = 0.585;  ///< of the packing it is cut from
};

/// One layer of glued grains of the mean diameter on a triangular lattice, stretched a little to
/// fit the periods.
struct LatticeBase {
  double spacing = 1.0;  ///< of neighbouring centres [d]
};

/// A flat wall at z = 0.
struct FlatBase {
  bool frictional = true;  ///< false: smooth, no tangential force
};

using Base = std::variant<BumpyBase, LatticeBase, FlatBase>;

/// The base in words, equal for equal recipes.
std::string recipe(const Base& base);

/// Volume fraction of a dense flow, to turn a depth into a number of grains and back.
inline constexpr double nominal_packing = 0.57;

/// Flat walls at y = 0 and y = width in place of the periodic boundary.
struct Sidewalls {
  bool frictional = true;  ///< false: smooth
};

/// Inclined layer with free surface, periodic in x (flow) and y (vorticity), z normal to the base
/// (Brewster et al. 2008, section II). Gravity is (g sin(theta), 0, -g cos(theta)).
struct Chute {
  double inclination = 0.0;  ///< theta [rad], in [0, pi/2): the layer flows in +x
  double gravity = 1.0;      ///< g [length/time^2]
  double length = 8.0;       ///< period in x [length]
  double width = 8.0;        ///< period in y, or distance of the sidewalls [length]
  int grains = 0;            ///< number of flowing grains
  Base base = BumpyBase{};
  std::optional<Sidewalls> sidewalls{};
  std::vector<TiltStep> tilts{};  ///< tilts that follow the first, in order of time
};

/// The last of its tilts, by which its state at the end is judged [rad].
double last_inclination(const Chute& chute);

/// Homogeneous simple shear, v_x = shear_rate y: Lees-Edwards boundaries in x and y, plain periodic
/// z. sigma_yy is held by the height of the box (Shi et al. 2020, section 2.2), or the volume is.
struct SimpleShear {
  double shear_rate = 0.0;           ///< d v_x / d y [1/time]
  std::optional<double> pressure{};  ///< sigma_yy to hold, 0 allowed [stress]; absent: fixed volume
  int grains = 0;                    ///< number of grains
  double volume_fraction = 0.6;      ///< at the start, where no size is given
  Vec3 size{};                       ///< of the box at the start [length]; 0: a cube by the above
};

/// A dense layer between two rough walls parallel to x and y; the upper one moves along x.
struct PlaneShear {
  double velocity = 0.0;          ///< of the upper wall [length/time]
  std::optional<double> load{};   ///< normal stress on the upper wall [stress]; absent: fixed gap
  double gravity = 0.0;           ///< g along -z [length/time^2]
  double length = 8.0;            ///< period in x [length]
  double width = 8.0;             ///< period in y [length]
  int grains = 0;                 ///< number of grains between the walls
  double volume_fraction = 0.58;  ///< of the grains between the walls at the start
  Base wall = BumpyBase{};        ///< the upper one is its mirror image; not flat
};

/// A box periodic in all directions, driven along x by a force per mass F sin(2 pi y / L_y), with
/// sigma_yy held by the height of the box.
struct BodyForceBox {
  double amplitude = 0.0;  ///< F [length/time^2]
  double pressure = 0.0;   ///< sigma_yy to hold [stress]
  double length = 8.0;     ///< period in x [length]
  double width = 8.0;      ///< period in z [length]
  int grains = 0;
  double volume_fraction = 0.58;  ///< at the start; gives the height
};

/// A wedge of the ring cell with a split bottom (Shi et al. 2020, section 2.3): inner cylinder and
/// the rough bottom inside the split radius at rest, outer cylinder and the bottom outside it
/// rotating about z; free surface, gravity along -z, rotational periodic boundaries.
struct SplitBottom {
  double inner_radius = 6.68;  ///< R_i [length]
  double split_radius = 38.6;  ///< R_s [length]
  double outer_radius = 50.0;  ///< R_o [length]
  double wedge =
      std::numbers::pi / 6.0;            ///< angle of the section [rad]: 2 pi / integer, up to pi/2
  double rotation_rate = 0.0;            ///< Omega [rad/time]
  double gravity = 1.0;                  ///< g [length/time^2]
  int grains = 0;                        ///< number of flowing grains
  double base_packing_fraction = 0.585;  ///< of the packing the rough bottom is cut from
  double base_thickness = 1.2;           ///< of its layer of centres [d]
};

using Geometry = std::variant<Chute, SimpleShear, PlaneShear, BodyForceBox, SplitBottom>;

/// A grain of a given start.
struct StartGrain {
  Vec3 position{};        ///< [length]
  Vec3 velocity{};        ///< [length/time]
  Vec3 rotation{};        ///< omega [1/time]
  double diameter = 1.0;  ///< [length]
  bool frozen = false;    ///< part of the base or of a wall
};

/// A point of the velocity profile a chute starts with.
struct StartVelocity {
  double z = 0.0;         ///< [length]
  double velocity = 0.0;  ///< v_x [length/time]
};

/// What is averaged and for how long. Times in units of the scene.
struct Measurement {
  double bin_width = 1.0;                 ///< of a row of fields, in z [length]
  Kernel kernel{KernelShape::lucy, 1.0};  ///< that fields are smoothed with
  double sample_interval = 0.1;           ///< between two samples of the fields [time]
  double frame_interval = 2.0;            ///< samples are summed over frames of this length [time]
  double averaging_time = 200.0;          ///< wanted length of the steady window [time]
  double time_limit = 1000.0;             ///< the run ends here even if it is not steady [time]
};

/// Which contacts are followed from their begin to their end (Brewster et al. 2008, section IV).
struct Lifetimes {
  /// Two grains are in contact while their centres are closer than d_c, here in mean diameters;
  /// for grains of other sizes the gap counts, (x - 1) d.
  std::vector<double> contact_distances{1.0, 1.001, 1.01, 1.02};
  bool effective_distance = false;           ///< d_eff of eq. 12 there as well (GaussianWell)
  std::optional<double> slice_centre{};      ///< z [length]; absent: half the nominal depth
  std::optional<double> slice_half_width{};  ///< [length]; absent: a tenth of it
};

/// Everything that shapes a DEM run. Plain values; valid after validate().
struct Scene {
  std::string name;  ///< of the run, for messages and reports
  Grains grains;
  std::variant<Hooke, Hertz> normal = Hooke{};
  std::variant<Cohesionless, GaussianWell, ReversibleAdhesion, LiquidBridge> cohesion =
      Cohesionless{};
  std::variant<Frictionless, Sliding, StickSlip> friction = Frictionless{};
  Geometry geometry = Chute{};
  std::vector<StartGrain> start;             ///< empty: a packing made for the geometry
  std::vector<StartVelocity> start_profile;  ///< of a chute, upwards; empty: starts from rest
  Measurement measurement;
  std::optional<Lifetimes> lifetimes{};  ///< absent: contacts are not followed
  double time_step = 0.0;                ///< [time]; 0: shortest contact time / 50
  bool allow_unstable_step = false;      ///< accept a step above shortest contact time / 15
  double max_overlap = 0.3;  ///< stop when an overlap exceeds this fraction of the radius
  std::uint64_t seed = 1;
};

/// What validate() accepts, for readers and documentation of scenes.
namespace limits {
inline constexpr double least_steps_per_contact = 15.0;  ///< a longer time step is refused
struct Interval {
  double least;
  double most;
};
inline constexpr double least_period = 3.0;   ///< [largest d]; in a shorter one a grain meets its
                                              ///< own image
inline constexpr double least_reaches = 2.2;  ///< of a period, in reaches (contact and attraction)
                                              ///< of the largest pair: one image at a time
inline constexpr Interval size_ratio{1.0, 20.0};
inline constexpr double attraction_range = 0.5;       ///< at most, beyond contact [smallest d]
inline constexpr double contact_angle = 90.0;         ///< below it [degrees]; beyond, bridges repel
inline constexpr Interval lattice_spacing{0.5, 1.7};  ///< [d]; at sqrt(3) d a grain falls through
inline constexpr Interval volume_fraction{0.01, 0.65};  ///< denser: does not come apart
inline constexpr int least_wedges = 4;  ///< of a full turn: a section is at most 90 degrees
inline constexpr Interval base_thickness{1.0, 10.0};        ///< [d]; thinner ones have holes
inline constexpr Interval base_packing_fraction{0.4, 0.6};  ///< looser: holes; denser: no packing
inline constexpr double overlap = 1.0;                      ///< max_overlap is below it
inline constexpr int grains = 1'000'000;                    ///< base included: days on one thread
inline constexpr double start_distance = 1e6;               ///< [d] from the origin; farther, an
                                                            ///< overlap drowns in rounding
inline constexpr double least_bin_width = 0.1;              ///< [d]
inline constexpr Interval kernel_width{0.25, 5.0};          ///< [d]; narrower: layers of grains
                                                            ///< show, wider: walls all over
inline constexpr double least_bins = 3.0;  ///< of the nominal depth: a bin and both neighbours,
                                           ///< from which its shear rate is taken
inline constexpr double steps = 1e12;      ///< of a run: years on one thread
inline constexpr Interval contact_distance{1.0, 1.05};  ///< [d]; wider, pairs at rest never part
inline constexpr std::size_t contact_distances = 8;     ///< in one run, at most
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

/// Shortest contact time over the pairs and stiffnesses present (normal, tangential, slope of the
/// attraction) of an undamped pair: pi sqrt(m_eff / k) with m_eff the effective mass of that mode
/// for the smallest grains. Hertz: the tangent stiffness at max_overlap [time].
double shortest_contact_time(const Scene& scene);

/// The step a run of this scene takes: its own, or the default [time].
double time_step(const Scene& scene);

/// "chute", "simple_shear", "plane_shear", "body_force_box", "split_bottom".
std::string_view kind(const Geometry& geometry);

/// mu_p: the coefficient of sliding, dynamic; 0 without friction.
double contact_friction(const Scene& scene);

/// Number of mobile grains.
int grains(const Scene& scene);

/// Number of glued grains, those included that are packed only to cut base or walls from.
double glued_grains(const Scene& scene);

/// Depth of the flowing grains at nominal_packing [length].
double nominal_depth(const Grains& grains, const Chute& chute);
double nominal_depth(const Grains& grains, const SplitBottom& cell);

/// Area of the bottom of a wedge [length^2].
double floor_area(const SplitBottom& cell);

/// Size of the box at the start: as given, or the cube of its volume fraction [length].
Vec3 start_size(const Grains& grains, const SimpleShear& shear);

/// Distance of the walls, and height of the box, at the start [length].
double start_gap(const Grains& grains, const PlaneShear& shear);
double start_height(const Grains& grains, const BodyForceBox& box);

/// Gap up to which a pair of grains attracts; 0 without cohesion [length].
double attraction_range(const Scene& scene);

/// Gaps below which pairs are followed as contacts, ascending [length].
std::vector<double> contact_gaps(const Scene& scene);

/// Heights between which a contact has to begin to be followed.
struct Slice {
  double begin = -std::numeric_limits<double>::infinity();  ///< z [length]
  double end = std::numeric_limits<double>::infinity();     ///< [length]

  bool contains(double z) const { return z >= begin && z < end; }
};
Slice lifetime_slice(const Scene& scene);

/// Mean flowing mass per unit area of the base [mass/length^2].
double mass_per_area(const Grains& grains, const Chute& chute);

/// What a run uses and what is left out because the scene does not ask for it, a line each.
struct SceneSummary {
  std::vector<std::string> used;
  std::vector<std::string> left_out;
};
SceneSummary summarise(const Scene& scene);

}  // namespace grainlaw::dem
