#include "apps/io/scene_lifetimes.h"

namespace grainlaw::io {

std::optional<dem::Lifetimes> read_lifetime_keys(InputFile& in, const Units& units) {
  Section section = in.optional_section(
      "lifetimes",
      "Lifetimes of contacts (Brewster et al. 2008, section IV): of those that begin in a slice of "
      "a chute or plane shear, or anywhere in a simple shear; without this section contacts are "
      "not followed");
  if (!section.given()) return std::nullopt;
  dem::Lifetimes lifetimes;
  const dem::limits::Interval& allowed = dem::limits::contact_distance;
  lifetimes.contact_distances =
      section
          .find<std::vector<double>>({"contact_distances",
                                      "grains are in contact while their centres are closer (of "
                                      "unequal grains: the surfaces closer than this - 1)",
                                      {"d"},
                                      from_to(allowed.least, allowed.most)},
                                     "[1, 1.001, 1.01, 1.02]")
          .value_or(lifetimes.contact_distances);
  lifetimes.effective_distance = section.read_or<bool>(
      {"effective_distance",
       "d_eff as well, where a Gaussian well still pulls with the weight of a grain (eq. 12)"},
      false);
  const Unit length = units[dimension::length];
  lifetimes.slice_centre =
      section.find<double>({"slice_centre", "z of the middle of the slice", length, positive},
                           "half the nominal depth, or distance of walls");
  lifetimes.slice_half_width = section.find<double>(
      {"slice_half_width", "of the slice", length, positive}, "a tenth of that depth");
  return lifetimes;
}

}  // namespace grainlaw::io
