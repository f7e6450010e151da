#include "dem/contact_lifetimes.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace grainlaw::dem {
namespace {

constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

std::vector<std::uint32_t> places(const Particles& particles) {
  std::vector<std::uint32_t> place(particles.real, nowhere);
  for (std::uint32_t i = 0; i < particles.real; ++i) place[particles.id[i]] = i;
  return place;
}

/// z of the middle between the centres of a pair [length].
double middle_height(const Particles& particles,
                     const std::array<ImageShift, 27>& shifts,
                     std::uint32_t first,
                     Partner partner) {
  return 0.5 * (particles.state[first].position.z + particles.state[partner.grain()].position.z +
                shifts[partner.image()].position.z);
}

/// Where the centres of a pair are now, and how far apart they were some steps before: leapfrog
/// moves by the velocity at the half step.
struct Passage {
  double distance;         ///< [length]
  double distance_before;  ///< [length]
  double radius_sum;       ///< [length]
};

Passage passage(const SimulationBase& simulation,
                const std::array<ImageShift, 27>& shifts,
                std::uint32_t first,
                Partner partner,
                std::int64_t steps) {
  const Particles& particles = simulation.particles();
  const GrainState& a = particles.state[first];
  const GrainState& b = particles.state[partner.grain()];
  const ImageShift& shift = shifts[partner.image()];
  const Vec3 branch = a.position - b.position - shift.position;
  const Vec3 velocity =
      particles.half[first].velocity - particles.half[partner.grain()].velocity - shift.velocity;
  const double time = static_cast<double>(steps) * simulation.setup().dynamics.time_step;
  return {.distance = length(branch),
          .distance_before = length(branch - time * velocity),
          .radius_sum = a.radius + b.radius};
}

/// The place in the list of a pair given by numbers.
std::optional<std::uint32_t> listed(const Particles& particles,
                                    const NeighbourList& list,
                                    const std::vector<std::uint32_t>& place,
                                    std::uint32_t first_id,
                                    std::uint32_t second_id) {
  for (const auto& [row_id, partner_id] :
       {std::pair{first_id, second_id}, std::pair{second_id, first_id}}) {
    const std::uint32_t row = place[row_id];
    if (row >= particles.mobile) continue;
    for (auto pair = list.row_begin(row); pair < list.row_begin(row + 1); ++pair) {
      if (particles.id[list.partners()[pair].grain()] == partner_id) return pair;
    }
  }
  return std::nullopt;
}

template <class Track>
void add_loads(LifetimeCounts& bin, const Track& contact) {
  bin.touches += contact.touches;
  bin.slides += contact.slides;
  bin.shear += contact.shear;
  bin.normal += contact.normal;
}

}  // namespace

ContactLifetimes::ContactLifetimes(const Scene& scene)
    : gaps_(contact_gaps(scene)),
      slice_(lifetime_slice(scene)),
      axis_{shortest_contact_time(scene)},
      diameter_(scene.grains.diameter),
      gradient_along_y_(std::holds_alternative<SimpleShear>(scene.geometry)) {
  constexpr double blocks_per_window = 40.0;
  const Measurement& m = scene.measurement;
  frames_per_block_ =
      std::max(1L, std::lround(m.averaging_time / m.frame_interval / blocks_per_window));
  constexpr double looks_per_contact = 25.0, rounding = 1e-6;
  const double steps = shortest_contact_time(scene) / time_step(scene);
  steps_per_look_ = std::max(1L, static_cast<long>(steps / looks_per_contact + rounding));
  blocks_.push_back(new_block(0.0));
}

void ContactLifetimes::follow(const SimulationBase& simulation) {
  if (simulation.steps() % steps_per_look_ == 0) look(simulation);
}

void ContactLifetimes::look(const SimulationBase& simulation) {
  way_ = last_look_ < 0 ? 1 : simulation.steps() - last_look_;
  last_look_ = simulation.steps();
  first_look_ = simulation.rebuilds() != rebuilds_;
  shifts_ = simulation.box().image_shifts();
  if (first_look_ || choose_anew_) {
    choose_candidates(simulation);
    choose_near(simulation);
  } else if (simulation.closed_since_rebuild() - closed_at_near_ > near_skin_) {
    choose_near(simulation);
  }
  for (std::size_t pack = 0; pack * pack_width < near_.pair.size(); ++pack) {
    compare(simulation, pack);
  }
}

/// Pairs that may begin a contact in the slice before the list is made anew, and those in contact.
void ContactLifetimes::choose_candidates(const SimulationBase& simulation) {
  const Particles& particles = simulation.particles();
  const NeighbourList& list = simulation.neighbours();
  const std::vector<Kept> kept = in_contact();
  const std::vector<std::uint32_t> place = places(particles);
  std::vector<const Kept*> kept_at(list.pairs(), nullptr);
  for (const Kept& pair : kept) {
    const auto at = listed(particles, list, place, pair.ids.first, pair.ids.second);
    if (at) kept_at[*at] = &pair;
  }
  first_.clear(), partner_.clear(), ids_.clear(), within_.clear(), tracks_.clear();
  const Slice around{slice_.begin - list.skin(), slice_.end + list.skin()};
  for (std::uint32_t p = 0; p < list.pairs(); ++p) {
    const std::uint32_t first = list.first()[p];
    const Partner partner = list.partners()[p];
    if (partner.grain() >= particles.mobile) continue;
    const double middle = middle_height(particles, shifts_, first, partner);
    if (!around.contains(middle) && !kept_at[p]) continue;
    first_.push_back(first);
    partner_.push_back(partner);
    add_candidate({particles.id[first], particles.id[partner.grain()]}, kept_at[p]);
  }
  first_.resize(pairs() + pack_width, 0u);
  partner_.resize(pairs() + pack_width, Partner::of(0, own_image));
  rebuilds_ = simulation.rebuilds();
  choose_anew_ = false;
}

void ContactLifetimes::add_candidate(Ids ids, const Kept* kept) {
  ids_.push_back(ids);
  within_.push_back(kept ? kept->within : 0u);
  if (kept) {
    tracks_.insert(tracks_.end(), kept->tracks.begin(), kept->tracks.end());
  } else {
    tracks_.resize(pairs() * kinds());
  }
}

std::vector<ContactLifetimes::Kept> ContactLifetimes::in_contact() const {
  std::vector<Kept> kept;
  for (std::size_t pair = 0; pair < pairs(); ++pair) {
    if (within_[pair] == 0) continue;
    const auto tracks = tracks_.begin() + static_cast<std::ptrdiff_t>(pair * kinds());
    kept.push_back({.ids = ids_[pair],
                    .within = within_[pair],
                    .tracks = {tracks, tracks + static_cast<std::ptrdiff_t>(kinds())}});
  }
  return kept;
}

void ContactLifetimes::choose_near(const SimulationBase& simulation) {
  constexpr double share_of_skin = 1.0 / 16.0;  // a look at all costs as much as several steps
  near_skin_ = share_of_skin * simulation.neighbours().skin();
  closed_at_near_ = simulation.closed_since_rebuild();
  near_.pair.clear(), near_.first.clear(), near_.partner.clear();
  const Slice around{slice_.begin - near_skin_, slice_.end + near_skin_};
  const Particles& particles = simulation.particles();
  std::uint32_t close = 0;  // bits of a pack
  for (std::uint32_t pair = 0; pair < pairs(); ++pair) {
    if (pair % pack_width == 0) {
      close = separations(shifts_.data(), particles.state.data(), &first_[pair], &partner_[pair])
                  .closer_than(gaps_.back() + near_skin_);
    }
    const auto near_slice = [&] {
      return around.contains(middle_height(particles, shifts_, first_[pair], partner_[pair]));
    };
    const bool is_close = close >> pair % pack_width & 1u;
    if (within_[pair] == 0 && !(is_close && near_slice())) continue;
    near_.pair.push_back(pair);
    near_.first.push_back(first_[pair]);
    near_.partner.push_back(partner_[pair]);
  }
  const std::size_t packs = near_.pair.size() / pack_width + 1;
  near_.first.resize(packs * pack_width, 0u);
  near_.partner.resize(packs * pack_width, Partner::of(0, own_image));
  near_.within.assign(packs * kinds(), 0u);
  for (std::size_t k = 0; k < near_.pair.size(); ++k) {
    for (std::size_t kind = 0; kind < kinds(); ++kind) {
      near_.within[k / pack_width * kinds() + kind] |= std::uint32_t{within(near_.pair[k], kind)}
                                                       << k % pack_width;
    }
  }
}

/// Sees which contacts of a pack of pairs have begun or ended.
void ContactLifetimes::compare(const SimulationBase& simulation, std::size_t pack) {
  const std::size_t k = pack * pack_width;
  const std::uint32_t lanes = (1u << std::min(pack_width, near_.pair.size() - k)) - 1u;
  const Separations apart = separations(
      shifts_.data(), simulation.particles().state.data(), &near_.first[k], &near_.partner[k]);
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    std::uint32_t& within = near_.within[pack * kinds() + kind];
    const std::uint32_t now = apart.closer_than(gaps_[kind]) & lanes;
    for (std::uint32_t changed = now ^ within; changed != 0; changed &= changed - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(changed));
      const std::uint32_t pair = near_.pair[k + lane];
      within_[pair] ^= 1u << kind;
      change(simulation, pair, kind, now >> lane & 1u);
    }
    within = now;
  }
}

void ContactLifetimes::change(const SimulationBase& simulation,
                              std::size_t pair,
                              std::size_t kind,
                              bool begins) {
  Track& contact = track(pair, kind);
  if (!begins && std::isnan(contact.begin)) return;
  const Passage passed = passage(simulation, shifts_, first_[pair], partner_[pair], way_);
  const double limit = passed.radius_sum + gaps_[kind];
  const double way = passed.distance - passed.distance_before;
  const double since = std::clamp((passed.distance - limit) / way, 0.0, 1.0);
  const double steps = since * static_cast<double>(way_);
  const double time = simulation.time() - steps * simulation.setup().dynamics.time_step;
  LifetimeTally& tally = blocks_.back().distances[kind];
  if (begins) {
    contact = {};
    const double height =
        middle_height(simulation.particles(), shifts_, first_[pair], partner_[pair]);
    if (!slice_.contains(height)) return;
    const bool unknown = first_look_ && passed.distance_before < limit;
    (unknown ? tally.unknown : tally.begun) += 1.0;
    if (!unknown) contact.begin = time;
    return;
  }
  const double age = time - contact.begin;
  LifetimeCounts& bin = tally.bins[axis_.bin(age)];
  bin.ended += 1.0;
  bin.lifetime += age;
  add_loads(bin, contact);
  contact = {};
}

void ContactLifetimes::sample(const SimulationBase& simulation,
                              const std::vector<ContactSample>& contacts,
                              const std::function<bool(const ContactSample&)>& slips) {
  if (simulation.steps() != last_look_) look(simulation);
  const Particles& particles = simulation.particles();
  LifetimeBlock& block = blocks_.back();
  block.samples += 1.0;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    block.grains += slice_.contains(particles.state[i].position.z);
  }
  std::size_t row = 0;  // both lists are sorted by the first grain
  for (const ContactSample& contact : contacts) {
    while (row < pairs() && first_[row] < contact.first) ++row;
    std::size_t pair = row;
    while (pair < pairs() && first_[pair] == contact.first &&
           partner_[pair].grain() != contact.second) {
      ++pair;
    }
    if (pair == pairs() || first_[pair] != contact.first) continue;
    const double near =
        particles.state[contact.first].radius + particles.state[contact.second].radius;
    const bool touches = square(contact.branch) < near * near;
    add_sample(pair, contact, touches, touches && slips(contact));
  }
}

void ContactLifetimes::add_sample(std::size_t pair,
                                  const ContactSample& contact,
                                  bool touches,
                                  bool slides) {
  const double Vec3::*gradient = gradient_along_y_ ? &Vec3::y : &Vec3::z;
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    Track& sums = track(pair, kind);
    if (!within(pair, kind) || std::isnan(sums.begin)) continue;
    sums.touches += touches;
    sums.slides += slides;
    sums.shear += contact.force.x * contact.branch.*gradient;
    sums.normal += contact.force.*gradient * contact.branch.*gradient;
  }
}

void ContactLifetimes::end_frame(double time) {
  time_ = time;
  if (++frames_ == frames_per_block_) end_block(time);
}

/// Contacts that go on leave the observation of one block and enter that of the next.
void ContactLifetimes::end_block(double time) {
  blocks_.back().end = time;
  LifetimeBlock next = new_block(time);
  for (std::size_t pair = 0; pair < pairs(); ++pair) {
    for (std::size_t kind = 0; kind < kinds(); ++kind) {
      const double begin = track(pair, kind).begin;
      if (std::isnan(begin)) continue;
      const std::size_t bin = axis_.bin(time - begin);
      blocks_.back().distances[kind].bins[bin].entered -= 1.0;
      blocks_.back().distances[kind].unfinished += 1.0;
      next.distances[kind].bins[bin].entered += 1.0;
    }
  }
  blocks_.push_back(std::move(next));
  frames_ = 0;
}

double ContactLifetimes::shear_rate(const LocalData& data) const {
  const double half = 0.5 * data.frames.row_width();
  double sum = 0.0, weight = 0.0;
  for (const LocalRow& row : data.rows) {
    const double overlap =
        std::min(row.z + half, slice_.end) - std::max(row.z - half, slice_.begin);
    if (!(overlap > 0.0) || !std::isfinite(row.shear_rate.value)) continue;
    sum += overlap * row.shear_rate.value;
    weight += overlap;
  }
  return std::abs(sum / weight);
}

/// What contacts have carried that go on: at the age they have reached.
void ContactLifetimes::book_unfinished_loads() {
  if (blocks_.size() < 2) return;
  LifetimeBlock& last = blocks_[blocks_.size() - 2];
  for (std::size_t pair = 0; pair < pairs(); ++pair) {
    for (std::size_t kind = 0; kind < kinds(); ++kind) {
      const Track& contact = track(pair, kind);
      if (std::isnan(contact.begin)) continue;
      add_loads(last.distances[kind].bins[axis_.bin(time_ - contact.begin)], contact);
    }
  }
}

LifetimeStatistics ContactLifetimes::finish(const LocalData& data) {
  if (frames_ > 0) end_block(time_);
  book_unfinished_loads();
  LifetimeStatistics result;
  result.slice_begin = slice_.begin;
  result.slice_end = slice_.end;
  result.shear_rate = shear_rate(data);
  const auto inside = [&](const LifetimeBlock& block) { return block.begin >= data.window.begin; };
  const auto first = std::find_if(blocks_.begin(), blocks_.end() - 1, inside);
  const std::span<const LifetimeBlock> window(first, blocks_.end() - 1);
  double samples = 0.0;
  for (const LifetimeBlock& block : window) {
    result.grains += block.grains;
    samples += block.samples;
  }
  result.grains /= samples;
  result.begin = window.empty() ? data.window.end : window.front().begin;
  result.end = window.empty() ? data.window.end : window.back().end;
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    result.distances.push_back(lifetime_distribution(axis_, window, kind, result.shear_rate));
    result.distances.back().distance = diameter_ + gaps_[kind];
  }
  return result;
}

}  // namespace grainlaw::dem
