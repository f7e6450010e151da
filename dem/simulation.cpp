#include "dem/simulation.h"

#include <algorithm>
#include <cmath>

#include "dem/run_error.h"

namespace grainlaw::dem {
namespace {

constexpr double steps_per_search = 16.0;  // a search costs as much as about three steps' tests
constexpr std::size_t grains_per_strip = 2000;
constexpr std::size_t most_strips = 8;

/// The straight line v_x(z), or v_x(y), through the mobile grains.
Frame mean_flow(const Particles& particles, bool along_y) {
  double n = 0.0, s = 0.0, ss = 0.0, v = 0.0, sv = 0.0;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const GrainState& grain = particles.state[i];
    const double at = along_y ? grain.position.y : grain.position.z;
    n += 1.0, s += at, ss += at * at, v += grain.velocity.x, sv += at * grain.velocity.x;
  }
  const double spread = n * ss - s * s;
  if (!(spread > 1e-12 * n * ss)) return {};
  const double gradient = (n * sv - s * v) / spread;
  return {(v - gradient * s) / n, gradient, along_y};
}

double fastest_frozen(const Particles& particles, const Frame& frame) {
  double fastest2 = 0.0;
  for (std::size_t i = particles.mobile; i < particles.real; ++i) {
    const GrainState& grain = particles.state[i];
    Vec3 velocity = grain.velocity;
    const double at = frame.along_y ? grain.position.y : grain.position.z;
    velocity.x -= frame.velocity + frame.gradient * at;
    fastest2 = std::max(fastest2, square(velocity));
  }
  return std::sqrt(fastest2);
}

double mean_diameter(const Particles& particles) {
  if (particles.real == 0) return 1.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < particles.real; ++i) sum += 2.0 * particles.state[i].radius;
  return sum / static_cast<double>(particles.real);
}

std::pair<double, double> radius_range(const Particles& particles) {
  double least = INFINITY, most = 0.0;
  for (std::size_t i = 0; i < particles.real; ++i) {
    least = std::min(least, particles.state[i].radius);
    most = std::max(most, particles.state[i].radius);
  }
  return {least, most};
}

}  // namespace

ContactSums& ContactSums::operator+=(const ContactSums& b) {
  tangential_energy += b.tangential_energy;
  normal_dashpot += b.normal_dashpot;
  tangential_dashpot += b.tangential_dashpot;
  slip += b.slip;
  spring_lost += b.spring_lost;
  prefactor_work += b.prefactor_work;
  bridge_lost += b.bridge_lost;
  virial_yy += b.virial_yy;
  largest_overlap = std::max(largest_overlap, b.largest_overlap);
  return *this;
}

Vec3 mass_moment(const Particles& particles) {
  Vec3 sum;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    sum += 1.0 / particles.state[i].inverse_mass * particles.state[i].position;
  }
  return sum;
}

SimulationBase::SimulationBase(const SimulationSetup& setup,
                               const InitialState& initial,
                               bool rotates)
    : setup_(setup),
      box_(initial.box),
      particles_(make_particles(initial, setup.density, rotates)),
      list_(0.0, 0.0),
      team_(std::make_unique<ThreadTeam>(setup.threads)),
      mean_diameter_(mean_diameter(particles_)) {
  const auto [least, most] = radius_range(particles_);
  contacts_.time_step = setup.dynamics.time_step;
  contacts_.equal_sizes = least == most;
  contacts_.smallest_radius = particles_.real > 0 ? least : 0.5;
  contacts_.moving_images = std::holds_alternative<BoxDrive>(setup.drive);
  const std::size_t strips =
      std::clamp(particles_.mobile / grains_per_strip, std::size_t{1}, most_strips);
  strips_.resize(strips);
}

std::size_t SimulationBase::acting_pairs() const {
  std::size_t count = 0;
  for (const Strip& strip : strips_) count += strip.acting.count;
  return count;
}

void SimulationBase::advance_grains() {
  team_->run(strips_.size(), [&](std::size_t s) {
    strips_[s].motion =
        advance(particles_, setup_.dynamics, frame_, strips_[s].begin, strips_[s].end);
  });
  motion_ = strips_.front().motion;
  for (std::size_t s = 1; s < strips_.size(); ++s) motion_ += strips_[s].motion;
  for (std::size_t i = particles_.mobile; i < particles_.size(); ++i) particles_.load[i] = {};
  ++steps_;
  const double dt = setup_.dynamics.time_step;
  const double speed = length(motion_.fastest);
  // Two surfaces approach by at most the ways of both grains in the frame, and by what the frame
  // shears them.
  const double reach = 2.0 * (list_.skin() + range_ + 2.0 * mean_diameter_);
  closing_rate_ = dt * (2.0 * std::max(speed, fastest_frozen_) + std::abs(frame_.gradient) * reach);
  closed_since_rebuild_ += closing_rate_;
  closed_since_search_ += closing_rate_;
  const auto inside = [&](double low, double high, double least, double most) {
    return particles_.mobile == 0 || (low >= least && high <= most);
  };
  const bool kept =
      inside(motion_.lowest.x, motion_.highest.x, setup_.lowest.x, setup_.highest.x) &&
      inside(motion_.lowest.y, motion_.highest.y, setup_.lowest.y, setup_.highest.y) &&
      inside(motion_.lowest.z, motion_.highest.z, setup_.lowest.z, setup_.highest.z);
  if (!motion_.finite || !(speed * dt < contacts_.smallest_radius) || !kept) {
    report_lost_grain(particles_, setup_, steps_);
  }
}

void SimulationBase::move_boundaries() {
  dem::move_boundaries(setup_.drive, setup_.dynamics.time_step, box_, particles_);
  if (contacts_.moving_images) contacts_.shifts = box_.image_shifts();
  stand_ins_.update(particles_, setup_.walls);
  const double way = setup_.dynamics.time_step * boundary_approach();
  closing_rate_ += way;
  closed_since_rebuild_ += way;
  closed_since_search_ += way;
}

/// How fast images and walls may approach grains at most, beyond what frame and fastest_frozen_
/// tell: images that do not follow the mean flow, as at a start from rest, and a wall that has
/// begun to move since the list was built [length/time].
double SimulationBase::boundary_approach() const {
  if (contacts_.moving_images) {
    const Vec3 mean{frame_.gradient * box_.period.y, 0.0, 0.0};
    return length(box_.top_velocity - mean);
  }
  const auto* wall = std::get_if<WallDrive>(&setup_.drive);
  return wall ? std::abs(wall->rise) : 0.0;
}

bool SimulationBase::must_rebuild() const {
  return closed_since_rebuild_ > list_.skin();
}
bool SimulationBase::must_search() const {
  return closed_since_search_ > search_skin_;
}

void SimulationBase::start_search() {
  search_skin_ = std::min(list_.skin(), steps_per_search * closing_rate_);
  closed_since_search_ = 0.0;
  searching_ = true;
}

void SimulationBase::place_grains(std::vector<double>* turns) {
  particles_.state.resize(particles_.real);
  particles_.id.resize(particles_.real);
  if (particles_.rotates()) particles_.spin.resize(particles_.real);
  if (box_.period.x > 0.0) {
    box_.offset -= box_.period.x * std::round(box_.offset / box_.period.x);
  }
  const Wrapping wrapping = wrap(particles_, box_, turns);
  wrapped_ += wrapping.displacement;
  ledger_.boundary_work += wrapping.kinetic_energy;
  contacts_.shifts = box_.image_shifts();
  const auto order = list_.cell_order(particles_, box_);
  reorder(particles_, order);
  if (turns) {
    const std::vector<double> old = *turns;
    for (std::size_t i = 0; i < old.size(); ++i) (*turns)[i] = old[order[i]];
  }
  const double reach = range_ + list_.skin();
  stand_ins_.list(particles_, box_, setup_.walls, reach);
  stand_ins_.append(particles_, setup_.walls);
  list_.build(particles_, box_, stand_ins_.foot_of);
  const bool flows_along_x = box_.wedge == 0.0;
  frame_ = flows_along_x ? mean_flow(particles_, contacts_.moving_images) : Frame{};
  fastest_frozen_ = fastest_frozen(particles_, frame_);
  closed_since_rebuild_ = 0.0;
  ++rebuilds_;
  cut_into_strips();
}

/// Strips of equal numbers of grains. A partner in another strip, or none, gets its force through a
/// place of its own behind all grains, so that no two threads ever add to the same place and the
/// order of sums is fixed.
void SimulationBase::cut_into_strips() {
  const std::size_t count = strips_.size();
  for (std::size_t s = 0; s < count; ++s) {
    strips_[s].begin = particles_.mobile * s / count;
    strips_[s].end = particles_.mobile * (s + 1) / count;
  }
  const Partner* partners = list_.partners();
  load_of_pair_.resize(list_.pairs() + pack_width);
  remote_.assign(count + 1, {});
  std::size_t places = particles_.size();
  std::vector<std::uint32_t> place_of(particles_.size());
  for (std::size_t s = 0; s < count; ++s) {
    std::fill(place_of.begin(), place_of.end(), 0u);
    const Strip& strip = strips_[s];
    for (auto pair = list_.row_begin(strip.begin); pair < list_.row_begin(strip.end); ++pair) {
      const std::uint32_t j = partners[pair].grain();
      const bool own = count == 1 || (j >= strip.begin && j < strip.end);
      if (own) {
        load_of_pair_[pair] = j;
        continue;
      }
      if (place_of[j] == 0) {
        place_of[j] = static_cast<std::uint32_t>(places++);
        const std::size_t home = j >= particles_.mobile
                                     ? count
                                     : std::upper_bound(strips_.begin(),
                                                        strips_.end(),
                                                        j,
                                                        [](std::uint32_t grain, const Strip& b) {
                                                          return grain < b.end;
                                                        }) -
                                           strips_.begin();
        remote_[home].push_back({j, place_of[j]});
      }
      load_of_pair_[pair] = place_of[j];
    }
  }
  particles_.load.resize(places);
  std::fill(particles_.load.begin() + static_cast<std::ptrdiff_t>(particles_.real),
            particles_.load.end(),
            GrainLoad{});
}

/// Adds to every grain what other strips have for it, strip by strip, then what its images have.
void SimulationBase::gather_loads() {
  if (strips_.size() > 1) {
    team_->run(remote_.size(), [&](std::size_t home) {
      for (const Remote& remote : remote_[home]) {
        GrainLoad& load = particles_.load[remote.grain];
        load.force += particles_.load[remote.load].force;
        load.torque += particles_.load[remote.load].torque;
        particles_.load[remote.load] = {};
      }
    });
  }
  stand_ins_.return_loads(particles_);
}

ContactSums SimulationBase::sums_of_strips() const {
  ContactSums sums;
  for (const Strip& strip : strips_) sums += strip.sums;
  return sums;
}

void SimulationBase::watch(const ContactSums& sums) {
  largest_overlap_ = std::max(largest_overlap_, sums.largest_overlap);
  if (sums.largest_overlap > setup_.max_overlap) {
    report_overlap(particles_, contacts_, strips_, setup_, steps_);
  }
}

void SimulationBase::control_boundaries(const ContactSums& sums) {
  if (std::holds_alternative<Still>(setup_.drive)) return;
  if (contacts_.moving_images) {
    stress_yy_ = (sums.virial_yy + motion_.kinetic_yy) / box_.volume();
  }
  control(setup_.drive, setup_.dynamics.time_step, stress_yy_, box_, particles_, setup_.dynamics);
}

void SimulationBase::book(const ContactSums& sums) {
  const double dt = setup_.dynamics.time_step;
  ledger_.normal_dashpot += sums.normal_dashpot;
  ledger_.tangential_dashpot += sums.tangential_dashpot;
  ledger_.slip += sums.slip;
  ledger_.spring_lost += sums.spring_lost;
  ledger_.prefactor_work += sums.prefactor_work;
  ledger_.bridge_lost += sums.bridge_lost;
  ledger_.field_work += motion_.field_work;
  const double power = boundary_power();
  ledger_.boundary_work += 0.5 * dt * (boundary_power_ + power);
  boundary_power_ = power;
}

/// What moving walls and moving images hand to the grains now.
double SimulationBase::boundary_power() const {
  if (std::holds_alternative<Still>(setup_.drive)) return 0.0;
  double power = dem::boundary_power(particles_);
  if (!contacts_.moving_images) return power;
  for (const Strip& strip : strips_) {
    for (std::size_t image = 0; image < strip.image_load.size(); ++image) {
      alignas(64) double load[8];
      strip.image_load[image].store(load);
      power += dot(Vec3{load[0], load[1], load[2]}, contacts_.shifts[image].velocity);
    }
  }
  return power;
}

/// Of gravity, from the way of all grains.
double SimulationBase::field_work() const {
  const auto* uniform = std::get_if<Uniform>(&setup_.dynamics.field);
  if (!uniform) return 0.0;
  const Vec3 way = mass_moment(particles_) - first_moment_ - wrapped_;
  return dot(uniform->acceleration, way);
}

}  // namespace grainlaw::dem
