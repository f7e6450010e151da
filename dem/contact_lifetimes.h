#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "dem/checkpoint.h"
#include "dem/coarse_graining.h"
#include "dem/contact_law.h"
#include "dem/lifetime_statistics.h"
#include "dem/local_data.h"
#include "dem/pair_search.h"
#include "dem/scene.h"
#include "dem/simulation.h"

namespace grainlaw::dem {

/// Follows contacts of mobile grains from their begin to their end, for several d_c at once, and
/// counts them by age. It looks at positions 25 times per shortest contact time (every other step
/// by default) and changes nothing. Begin and end are taken from the approach at the look that sees
/// them, straight since the look before: good to 1e-4 of a contact time. What begins and ends
/// between two looks is not seen: in a chute 4e-4 of the contacts with d_c = d. Contacts are those
/// that begin in the slice, wherever they go; what has begun when it is first met is of unknown age
/// and left out.
///
/// Candidates are pairs of the neighbour list around the slice. The list is complete for gaps up to
/// the range of the attraction; for wider d_c it may miss a pair during the last part (gap / skin)
/// of its life, when both grains moved about as fast as the fastest one: such a contact then counts
/// as of unknown age.
class ContactLifetimes {
 public:
  explicit ContactLifetimes(const Scene& scene);

  /// After every step; looks where one is due.
  void follow(const SimulationBase& simulation);
  /// Takes the acting pairs of this step; does one slip?
  void sample(const SimulationBase& simulation,
              const std::vector<ContactSample>& contacts,
              const std::function<bool(const ContactSample&)>& slips);
  void end_frame(double time);

  /// Over the blocks inside the steady window; the shear rate is that of the rows in the slice.
  LifetimeStatistics finish(const LocalData& data);

  void save(Checkpoint& to) const;
  void restore(const Checkpoint& from);

 private:
  static constexpr double not_followed = std::numeric_limits<double>::quiet_NaN();

  /// A contact of one pair for one d_c.
  struct Track {
    double begin = not_followed;  ///< [time]
    double touches = 0.0;         ///< as in LifetimeCounts
    double slides = 0.0;
    double shear = 0.0;
    double normal = 0.0;
  };
  struct Ids {
    std::uint32_t first;
    std::uint32_t second;
  };
  /// What is known of a pair in contact while candidates are chosen anew.
  struct Kept {
    Ids ids;
    std::uint32_t within;       ///< a bit per kind
    std::vector<Track> tracks;  ///< [kind]
  };
  /// Candidates that may change before the next look at all of them, packed for comparison.
  struct Near {
    std::vector<std::uint32_t> pair;
    std::vector<std::uint32_t> first;  ///< the last pack is filled up
    std::vector<Partner> partner;
    std::vector<std::uint32_t> within;  ///< [pack][kind], a bit per pair
  };

  std::size_t kinds() const { return gaps_.size(); }  ///< number of d_c
  std::size_t pairs() const { return ids_.size(); }
  Track& track(std::size_t pair, std::size_t kind) { return tracks_[pair * kinds() + kind]; }
  bool within(std::size_t pair, std::size_t kind) const { return within_[pair] >> kind & 1u; }
  void look(const SimulationBase& simulation);
  void choose_candidates(const SimulationBase& simulation);
  void add_candidate(Ids ids, const Kept* kept);
  void choose_near(const SimulationBase& simulation);
  std::vector<Kept> in_contact() const;
  void compare(const SimulationBase& simulation, std::size_t pack);
  void change(const SimulationBase& simulation, std::size_t pair, std::size_t kind, bool begins);
  void add_sample(std::size_t pair, const ContactSample& contact, bool touches, bool slides);
  LifetimeBlock new_block(double begin) const {
    return {.begin = begin, .distances = std::vector<LifetimeTally>(kinds())};
  }
  void end_block(double time);
  void book_unfinished_loads();
  double shear_rate(const LocalData& data) const;

  std::vector<double> gaps_;  ///< below which a pair is in contact, of every d_c [length]
  Slice slice_;
  LifetimeAxis axis_;
  double diameter_;
  bool gradient_along_y_;  ///< else along z
  long frames_per_block_;
  long steps_per_look_;

  std::vector<std::uint32_t> first_;  ///< candidates, in the order of the neighbour list; the last
                                      ///< pack is filled up
  std::vector<Partner> partner_;
  std::vector<Ids> ids_;
  std::vector<std::uint32_t> within_;  ///< a bit per kind: in contact at the last step
  std::vector<Track> tracks_;          ///< [pair][kind]
  Near near_;
  double near_skin_ = 0.0;       ///< [length]
  double closed_at_near_ = 0.0;  ///< of the list, when near pairs were chosen [length]
  std::array<ImageShift, 27> shifts_;
  std::int64_t rebuilds_ = -1;   ///< of the list when candidates were chosen
  bool choose_anew_ = true;      ///< candidates are those of a checkpoint
  bool first_look_ = true;       ///< the look before was not at all candidates
  std::int64_t last_look_ = -1;  ///< step of it
  std::int64_t way_ = 1;         ///< since the look before [steps]

  std::vector<LifetimeBlock> blocks_;  ///< the last one is not complete
  std::int64_t frames_ = 0;            ///< in it
  double time_ = 0.0;                  ///< end of the last frame [time]
};

/// Does a contact slip: is its tangential force at the (dynamic) limit of friction?
template <class Law>
bool slips(const Law& law, const Particles& particles, const ContactSample& sample) {
  if constexpr (!Law::rotates) {
    return false;
  } else {
    const double a = particles.state[sample.first].radius;
    const double b = particles.state[sample.second].radius;
    Contact contact;
    contact.radius_sum = a + b;
    contact.distance = length(sample.branch);
    contact.overlap = contact.radius_sum - contact.distance;
    contact.harmonic_radius = harmonic_radius(a, b);
    const Vec3 direction = 1.0 / contact.distance * sample.branch;
    const double normal = dot(sample.force, direction);
    double reference = std::abs(normal);
    if constexpr (Law::attracts) {
      const double pull = law.cohesion.force(contact, true);
      reference = coulomb_reference(law.cohesion.reference, normal - pull, pull);
    }
    constexpr double rounding = 1e-6;
    const double limit = law.friction.coefficient * reference;
    const double tangential = length(sample.force - normal * direction);
    return std::abs(tangential - limit) <= rounding * limit;
  }
}

}  // namespace grainlaw::dem
