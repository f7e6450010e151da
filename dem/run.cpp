#include "dem/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "dem/binary_collision.h"
#include "dem/contact_law.h"
#include "dem/flow_run.h"
#include "dem/flow_setup.h"
#include "dem/packing.h"

namespace grainlaw::dem {
namespace {

/// Calls use(law) with the law of the scene as one type: the only place where laws are chosen.
template <class Use>
auto with_law(const Scene& scene, Use&& use) {
  return std::visit(
      [&](auto normal, auto cohesion, auto friction) {
        return use(ContactLaw{normal, cohesion, friction});
      },
      scene.normal,
      scene.cohesion,
      scene.friction);
}

double surface_tension_attraction(const Scene& scene) {
  return std::visit(
      [&](const auto& law) {
        if constexpr (std::decay_t<decltype(law)>::attracts) {
          return law.largest_attraction(0.5 * scene.grains.diameter);
        } else {
          return 0.0;
        }
      },
      scene.cohesion);
}

}  // namespace

ChuteConditions conditions(const Scene& scene) {
  ChuteConditions c{.geometry = std::string(kind(scene.geometry)),
                    .grain_diameter = scene.grains.diameter,
                    .grain_density = scene.grains.density(),
                    .stiffness =
                        std::visit([](const auto& law) { return law.stiffness; }, scene.normal),
                    .contact_friction = contact_friction(scene)};
  if (const auto* chute = std::get_if<Chute>(&scene.geometry)) {
    c.inclination = chute->inclination;
    c.gravity = chute->gravity;
    c.mass_per_area = mass_per_area(scene.grains, *chute);
    c.base = recipe(chute->base);
  } else if (const auto* box = std::get_if<SimpleShear>(&scene.geometry)) {
    c.shear_rate = box->shear_rate;
  }
  return c;
}

LocalData run(const Scene& scene, const RunOptions& options) {
  validate(scene);
  return with_law(scene, [&](const auto& law) { return FlowRun{scene, law, options}.run(); });
}

}  // namespace grainlaw::dem
