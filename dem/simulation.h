#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "dem/box.h"
#include "dem/contact_forces.h"
#include "dem/energy_ledger.h"
#include "dem/integrator.h"
#include "dem/neighbour_list.h"
#include "dem/particles.h"

namespace grainlaw::dem {

/// What a simulation needs beside its law and its grains.
struct SimulationSetup {
  Box box;
  double diameter = 1.0;     ///< of all grains [length]
  Dynamics dynamics;         ///< grain mass, gravity, time step
  double max_overlap = 0.3;  ///< stop above this fraction of the radius
  double lowest_height =
      -std::numeric_limits<double>::infinity();  ///< a grain below is lost [length]
  double skin = 0.25;                            ///< of the neighbour list [diameter]
};

/// Grains as they are handed in; numbered mobile first, in the order given.
struct InitialState {
  std::vector<Vec3> position;  ///< of mobile grains [length]
  std::vector<Vec3> velocity;  ///< empty: at rest [length/time]
  std::vector<Vec3> spin;      ///< R omega, empty: none [length/time]
  std::vector<Vec3> frozen;    ///< positions of grains that never move [length]
};

/// Throws RunError with the grain or contact at fault. Kept out of the template: rarely run.
[[noreturn]] void report_lost_grain(const Particles& particles,
                                    const SimulationSetup& setup,
                                    const Motion& motion,
                                    long step);
[[noreturn]] void report_overlap(const Particles& particles,
                                 const SimulationSetup& setup,
                                 const NeighbourList& list,
                                 long step);

/// The grains of an initial state, at rest in their half steps.
Particles make_particles(const InitialState& initial, bool rotates);

/// Moves the mobile grains to the order given (new place -> old place).
void reorder(Particles& particles, const std::vector<std::uint32_t>& order);

/// Brings all mobile grains into the box; returns the sum of the displacements.
Vec3 wrap(Particles& particles, const Box& box);

/// A velocity in the middle of those of all grains, frozen ones included.
Vec3 middle_velocity(const Particles& particles);

/// Sum of the positions of the mobile grains.
Vec3 position_sum(const Particles& particles);

/// The histories of touching pairs by grain numbers, while the list is rebuilt. The only place
/// where a history changes sides: springs are stored as seen from the grain with the lower number.
template <class Law>
class CarriedHistories {
 public:
  CarriedHistories(const Particles& particles,
                   const NeighbourList& list,
                   const ContactTable<Law>& table) {
    for (std::size_t k = 0; k < table.count; ++k) {
      const auto [i, pair] = table.touching[k];
      const std::uint32_t a = particles.id[i];
      const std::uint32_t b = particles.id[list.partners()[pair].grain()];
      entries_.push_back({key(a, b), oriented(table.history[pair], a < b)});
    }
    std::sort(entries_.begin(), entries_.end(), [](auto& a, auto& b) { return a.key < b.key; });
  }

  void restore(const Particles& particles,
               const NeighbourList& list,
               ContactTable<Law>& table) const {
    for (std::size_t i = 0; i < particles.mobile; ++i) {
      for (auto pair = list.row_begin(i); pair < list.row_begin(i + 1); ++pair) {
        const std::uint32_t a = particles.id[i];
        const std::uint32_t b = particles.id[list.partners()[pair].grain()];
        const auto found = std::lower_bound(
            entries_.begin(), entries_.end(), key(a, b), [](auto& entry, auto wanted) {
              return entry.key < wanted;
            });
        if (found == entries_.end() || found->key != key(a, b)) continue;
        table.history[pair] = oriented(found->history, a < b);
        table.remembers[pair] = 1;
      }
    }
  }

 private:
  struct Entry {
    std::uint64_t key;
    typename Law::History history;
  };
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }
  static typename Law::History oriented(typename Law::History history, bool as_is) {
    if (!as_is) history.friction.spring = -history.friction.spring;
    return history;
  }
  std::vector<Entry> entries_;
};

/// Grains under one contact law, gravity and periodic walls. The law is a type: what it does not
/// need is neither stored nor computed.
template <class Law>
class Simulation {
 public:
  Simulation(const Law& law, const SimulationSetup& setup, const InitialState& initial)
      : law_(law),
        setup_(setup),
        contacts_{.diameter = setup.diameter,
                  .mass = setup.dynamics.mass,
                  .time_step = setup.dynamics.time_step,
                  .shifts = setup.box.image_shifts()},
        particles_(make_particles(initial, Law::rotates)),
        list_(setup.box, setup.diameter, setup.skin * setup.diameter) {
    rebuild();
    add_forces(no_record);
    restart_half_step(particles_, setup_.dynamics);
    open_ledger();
  }

  void step() { step(no_record); }

  /// One time step; record(i, j, branch, force_on_i) sees every contact at its end.
  template <class Record>
  void step(Record&& record) {
    drift_and_kick();
    update_neighbours();
    add_forces(record);
    book();
  }

  /// Turns gravity; velocities stay.
  void set_gravity(const Vec3& gravity) {
    for (std::size_t i = 0; i < particles_.mobile; ++i) {
      particles_.state[i].velocity = velocity(i);
      if constexpr (Law::rotates) static_cast<Vec3&>(particles_.spin[i]) = spin(i);
    }
    setup_.dynamics.gravity = gravity;
    restart_half_step(particles_, setup_.dynamics);
  }

  /// Starts the bookkeeping of energy, time and steps afresh.
  void open_ledger() {
    ledger_ = {.initial_energy = mechanical_energy()};
    first_position_sum_ = position_sum(particles_);
    wrapped_ = {};
    steps_ = 0;
    largest_overlap_ = sums_.largest_overlap;
  }

  long steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * setup_.dynamics.time_step; }
  const SimulationSetup& setup() const { return setup_; }
  const Particles& particles() const { return particles_; }
  const NeighbourList& neighbours() const { return list_; }
  long rebuilds() const { return rebuilds_; }
  /// Velocity and R omega of grain i at the time of its position [length/time].
  Vec3 velocity(std::size_t i) const { return dem::velocity(particles_, i, setup_.dynamics); }
  Vec3 spin(std::size_t i) const { return dem::spin(particles_, i, setup_.dynamics); }

  double kinetic_energy() const { return dem::kinetic_energy(particles_, setup_.dynamics); }
  /// Kinetic and elastic, without gravity [energy].
  double mechanical_energy() const {
    return kinetic_energy() + sums_.elastic_energy + sums_.tangential.elastic_energy;
  }
  EnergyLedger ledger() const {
    EnergyLedger ledger = ledger_;
    const Vec3 way = position_sum(particles_) - first_position_sum_ - wrapped_;
    ledger.gravity_work = setup_.dynamics.mass * dot(setup_.dynamics.gravity, way);
    return ledger;
  }
  std::size_t touching_pairs() const { return table_.count; }
  double largest_overlap() const { return largest_overlap_; }  ///< since the ledger [length]

 private:
  static void no_record(std::uint32_t, std::uint32_t, const Vec3&, const Vec3&) {}

  void drift_and_kick() {
    const Motion motion = advance(particles_, setup_.dynamics, frame_velocity_);
    ++steps_;
    const double way = motion.fastest * setup_.dynamics.time_step;
    travelled_ += std::max(way, length(frame_velocity_) * setup_.dynamics.time_step);
    if (!(way < 0.5 * setup_.diameter && motion.lowest >= setup_.lowest_height)) {
      report_lost_grain(particles_, setup_, motion, steps_);
    }
  }

  // Two grains approach by at most twice the way of the fastest one in any common frame.
  void update_neighbours() {
    if (2.0 * travelled_ > list_.skin()) rebuild();
  }

  void rebuild() {
    if constexpr (Law::keeps_history) {
      const CarriedHistories<Law> histories(particles_, list_, table_);
      rebuild_list();
      histories.restore(particles_, list_, table_);
    } else {
      rebuild_list();
    }
  }

  void rebuild_list() {
    wrapped_ += wrap(particles_, setup_.box);
    reorder(particles_, list_.cell_order(particles_));
    list_.build(particles_);
    table_.resize(list_.pairs());
    frame_velocity_ = middle_velocity(particles_);
    travelled_ = 0.0;
    ++rebuilds_;
  }

  template <class Record>
  void add_forces(Record&& record) {
    sums_ = add_contact_forces(law_, contacts_, particles_, list_, table_, record);
    largest_overlap_ = std::max(largest_overlap_, sums_.largest_overlap);
    if (sums_.largest_overlap > 0.5 * setup_.max_overlap * setup_.diameter) {
      report_overlap(particles_, setup_, list_, steps_);
    }
  }

  void book() {
    ledger_.normal_dashpot += sums_.normal_dashpot;
    ledger_.tangential_dashpot += sums_.tangential.dashpot;
    ledger_.slip += sums_.tangential.slip;
    ledger_.spring_lost += sums_.spring_lost;
  }

  Law law_;
  SimulationSetup setup_;
  ContactSetting contacts_;
  Particles particles_;
  NeighbourList list_;
  ContactTable<Law> table_;
  ContactSums sums_;
  EnergyLedger ledger_;
  Vec3 first_position_sum_;
  Vec3 wrapped_;
  Vec3 frame_velocity_;
  double travelled_ = 0.0;
  double largest_overlap_ = 0.0;
  long steps_ = 0;
  long rebuilds_ = 0;
};

}  // namespace grainlaw::dem
