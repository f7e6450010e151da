// Which contacts a scene has followed: what [lifetimes] asks for, checked and with its defaults.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem/scene.h"
#include "dem/scene_checks.h"

namespace grainlaw::dem {
namespace {

/// Of the layer in whose middle contacts are followed; 0: everywhere [length].
double layer_depth(const Chute& chute, const Grains& grains) {
  return nominal_depth(grains, chute);
}
double layer_depth(const PlaneShear& shear, const Grains& grains) {
  return start_gap(grains, shear);
}
double layer_depth(const SimpleShear&, const Grains&) {
  return 0.0;
}
double layer_depth(const BodyForceBox&, const Grains&) {
  refuse(
      {"lifetimes", ""},
      "contacts are followed in a chute, a plane shear or a simple shear: elsewhere no slice has "
      "one shear rate");
}
double layer_depth(const SplitBottom&, const Grains& grains) {
  return layer_depth(BodyForceBox{}, grains);
}

double layer_depth(const Scene& scene) {
  return std::visit([&](const auto& shape) { return layer_depth(shape, scene.grains); },
                    scene.geometry);
}

/// Beyond contact [length].
double effective_gap(const Scene& scene) {
  constexpr Place at{"lifetimes", "effective_distance"};
  const auto* well = std::get_if<GaussianWell>(&scene.cohesion);
  const auto* chute = std::get_if<Chute>(&scene.geometry);
  if (!well || !chute) {
    refuse(at,
           "effective_distance: where the pull of a Gaussian well is the weight of a grain, so it "
           "takes law = \"gaussian_well\" and kind = \"chute\"");
  }
  return well->effective_range(scene.grains.mass * chute->gravity);
}

void check_distances(const Lifetimes& lifetimes) {
  constexpr Place at{"lifetimes", "contact_distances"};
  const auto& [least, most] = limits::contact_distance;
  const std::size_t count = lifetimes.contact_distances.size();
  if (count == 0 || count > limits::contact_distances) {
    refuse(at,
           fmt::format("contact_distances: {} of them; 1 to {}", count, limits::contact_distances));
  }
  for (const double distance : lifetimes.contact_distances) {
    if (distance >= least && distance <= most) continue;
    refuse(
        at,
        fmt::format("contact_distances: {} d; must be between {} and {} d", distance, least, most));
  }
}

}  // namespace

std::vector<double> contact_gaps(const Scene& scene) {
  std::vector<double> gaps;
  for (const double distance : scene.lifetimes->contact_distances) {
    gaps.push_back((distance - 1.0) * scene.grains.diameter);
  }
  if (scene.lifetimes->effective_distance) gaps.push_back(effective_gap(scene));
  std::ranges::sort(gaps);
  gaps.erase(std::unique(gaps.begin(), gaps.end()), gaps.end());
  return gaps;
}

Slice lifetime_slice(const Scene& scene) {
  const double depth = layer_depth(scene);
  if (depth == 0.0) return {};
  const double centre = scene.lifetimes->slice_centre.value_or(0.5 * depth);
  const double half_width = scene.lifetimes->slice_half_width.value_or(0.1 * depth);
  return {centre - half_width, centre + half_width};
}

void check_lifetimes(const Scene& scene) {
  if (!scene.lifetimes) return;
  const Lifetimes& lifetimes = *scene.lifetimes;
  check_distances(lifetimes);
  contact_gaps(scene);
  if (layer_depth(scene) == 0.0 && (lifetimes.slice_centre || lifetimes.slice_half_width)) {
    refuse({"lifetimes", lifetimes.slice_centre ? "slice_centre" : "slice_half_width"},
           "a simple shear is the same everywhere: contacts are followed in the whole box");
  }
  if (lifetimes.slice_half_width) {
    require_positive(
        *lifetimes.slice_half_width, {"lifetimes", "slice_half_width"}, "slice_half_width");
  }
  if (lifetimes.slice_centre && !std::isfinite(*lifetimes.slice_centre)) {
    refuse({"lifetimes", "slice_centre"}, "slice_centre: must be finite");
  }
}

}  // namespace grainlaw::dem
