#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dem/box.h"
#include "dem/carried_pairs.h"
#include "dem/checkpoint.h"
#include "dem/contact_loops.h"
#include "dem/drive.h"
#include "dem/energy_ledger.h"
#include "dem/initial_state.h"
#include "dem/integrator.h"
#include "dem/neighbour_list.h"
#include "dem/particles.h"
#include "dem/stand_ins.h"
#include "dem/thread_team.h"
#include "dem/walls.h"

namespace grainlaw::dem {

/// What a simulation needs beside its law and its grains.
struct SimulationSetup {
  Dynamics dynamics;                             ///< time step and field
  double density = 0.0;                          ///< of the grains [mass/length^3]
  Drive drive;                                   ///< what moves the boundaries
  std::vector<Wall> walls;                       ///< flat and round ones
  double max_overlap = 0.3;                      ///< stop above this fraction of the smaller radius
  double skin = 0.35;                            ///< of the neighbour list [mean diameter]
  Vec3 lowest{-infinity, -infinity, -infinity};  ///< a grain beyond is lost [length]
  Vec3 highest{infinity, infinity, infinity};
  int threads = 1;  ///< does not change any number

  static constexpr double infinity = std::numeric_limits<double>::infinity();
};

/// Sum of m x of the mobile grains [mass length].
Vec3 mass_moment(const Particles& particles);

/// Throws RunError with the grain at fault.
[[noreturn]] void report_lost_grain(const Particles& particles,
                                    const SimulationSetup& setup,
                                    long step);

/// Throws RunError with the contact at fault.
[[noreturn]] void report_overlap(const Particles& particles,
                                 const ContactSetting& contacts,
                                 const std::vector<Strip>& strips,
                                 const SimulationSetup& setup,
                                 long step);

/// The part of a simulation that does not depend on the law.
class SimulationBase {
 public:
  SimulationBase(const SimulationSetup& setup, const InitialState& initial, bool rotates);

  long steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * setup_.dynamics.time_step; }
  const SimulationSetup& setup() const { return setup_; }
  const Box& box() const { return box_; }
  const Particles& particles() const { return particles_; }
  const NeighbourList& neighbours() const { return list_; }
  const std::vector<Strip>& strips() const { return strips_; }
  const PairMemory& memory() const { return memory_; }
  long rebuilds() const { return rebuilds_; }
  /// How far two surfaces may have approached since then, at most [length].
  double closed_since_rebuild() const { return closed_since_rebuild_; }
  /// Velocity and R omega of mobile grain i at the time of its position [length/time].
  Vec3 velocity(std::size_t i) const { return dem::velocity(particles_, i, setup_.dynamics); }
  Vec3 spin(std::size_t i) const { return dem::spin(particles_, i, setup_.dynamics); }
  double kinetic_energy() const { return dem::kinetic_energy(particles_, setup_.dynamics); }
  /// Of acting pairs: touching, or within the range of the attraction.
  std::size_t acting_pairs() const;
  double largest_overlap() const { return largest_overlap_; }  ///< since the ledger [radius]
  /// sigma_yy of a box whose height is driven, contact and kinetic, at the last step [stress].
  double stress_yy() const { return stress_yy_; }

 protected:
  void advance_grains();
  void move_boundaries();
  bool must_rebuild() const;
  bool must_search() const;
  void place_grains(std::vector<double>* turns);
  void cut_into_strips();
  void start_search();
  void gather_loads();
  void watch(const ContactSums& sums);
  void control_boundaries(const ContactSums& sums);
  void book(const ContactSums& sums);
  void save_base(Checkpoint& to);
  void restore_base(const Checkpoint& from);
  void restore_pairs(const Checkpoint& from);
  template <class Visit>
  void for_scalars(Visit&& visit);
  double field_work() const;
  double boundary_power() const;
  double boundary_approach() const;
  ContactSums sums_of_strips() const;

  SimulationSetup setup_;
  Box box_;
  ContactSetting contacts_;
  Particles particles_;
  NeighbourList list_;
  StandIns stand_ins_;
  PairMemory memory_;
  std::vector<Strip> strips_;
  std::vector<std::uint32_t> load_of_pair_;  ///< where each listed pair adds the partner's force
  struct Remote {
    std::uint32_t grain;
    std::uint32_t load;
  };
  std::vector<std::vector<Remote>> remote_;  ///< by strip of the grain, then by strip that adds
  std::unique_ptr<ThreadTeam> team_;
  ContactSums sums_;
  EnergyLedger ledger_;
  Motion motion_;
  Frame frame_;
  double mean_diameter_ = 1.0;
  bool searching_ = false;             ///< pairs near each other are to be found anew
  double range_ = 0.0;                 ///< of the attraction [length]
  double search_skin_ = 0.0;           ///< of the present search [length]
  double closed_since_rebuild_ = 0.0;  ///< bound on how far surfaces have approached [length]
  double closed_since_search_ = 0.0;
  double closing_rate_ = 0.0;    ///< in the last step [length]
  double fastest_frozen_ = 0.0;  ///< relative to the frame [length/time]
  double stress_yy_ = 0.0;
  double largest_overlap_ = 0.0;
  double boundary_power_ = 0.0;  ///< at the last step [energy/time]
  Vec3 first_moment_;            ///< sum of m x when the ledger was opened [mass length]
  Vec3 wrapped_;                 ///< of it, by wrapping
  long steps_ = 0;
  long rebuilds_ = 0;
};

/// Grains under one contact law. The law is a type: what it does not need is neither stored nor
/// computed.
template <class Law>
class Simulation : public SimulationBase {
 public:
  Simulation(const Law& law, const SimulationSetup& setup, const InitialState& initial)
      : SimulationBase(setup, initial, Law::rotates), law_(law) {
    range_ = law.range();
    list_ = NeighbourList(range_, setup.skin * mean_diameter_);
    start_boundaries(setup_.drive, box_, particles_);
    rebuild();
    add_forces(NoRecord{});
    balance(setup_.dynamics, particles_);
    restart_half_step(particles_, setup_.dynamics);
    open_ledger();
  }

  void step() { step(NoRecord{}); }

  /// One time step; record(i, j, branch, force_on_i[, loss]) sees every acting pair at its end.
  template <class Record>
  void step(Record&& record) {
    advance_grains();
    move_boundaries();
    update_neighbours();
    add_forces(record);
    control_boundaries(sums_);
    balance(setup_.dynamics, particles_);
    book(sums_);
  }

  /// Changes field or drive; velocities, and what the ledger has booked, stay.
  void set_field(const std::variant<Uniform, Sine, Affine>& field) {
    ledger_.field_work += field_work();
    first_moment_ = mass_moment(particles_);
    wrapped_ = {};
    for (std::size_t i = 0; i < particles_.mobile; ++i) {
      particles_.state[i].velocity = velocity(i);
      if constexpr (Law::rotates) particles_.spin[i].velocity = spin(i);
    }
    setup_.dynamics.field = field;
    balance(setup_.dynamics, particles_);
    restart_half_step(particles_, setup_.dynamics);
  }
  void set_drive(const Drive& drive) {
    setup_.drive = drive;
    start_boundaries(setup_.drive, box_, particles_);
    closed_since_rebuild_ = SimulationSetup::infinity;  // the list was made for other velocities
  }

  /// Starts the bookkeeping of energy, time and steps afresh.
  void open_ledger() {
    first_moment_ = {};
    wrapped_ = {};
    ledger_ = {};
    ledger_.initial_energy = mechanical_energy();
    boundary_power_ = boundary_power();
    first_moment_ = mass_moment(particles_);
    steps_ = 0;
    largest_overlap_ = sums_.largest_overlap;
  }

  /// Kinetic and elastic (with cohesion), without gravity [energy].
  double mechanical_energy() const { return kinetic_energy() + elastic_energy(); }
  double elastic_energy() const;
  EnergyLedger ledger() const {
    EnergyLedger ledger = ledger_;
    ledger.field_work += field_work();
    return ledger;
  }

  /// Everything that shapes the further path; restore() needs a simulation made from the same law,
  /// set-up and initial state.
  void save(Checkpoint& to) { save_base(to); }
  void restore(const Checkpoint& from) {
    restore_base(from);
    start_search();
  }

 private:
  void update_neighbours() {
    if (must_rebuild()) {
      rebuild();
    } else if (must_search()) {
      mark_active();
      start_search();
    }
  }

  void rebuild() {
    if constexpr (Law::keeps_history) {
      const CarriedPairs carried(particles_, list_, strips_, stand_ins_, memory_);
      std::vector<double> turns;
      place_grains(box_.wedge > 0.0 ? &turns : nullptr);
      memory_.reset<Law>(list_.pairs());
      carried.restore(particles_, list_, turns, memory_);
    } else {
      place_grains(nullptr);
      memory_.reset<Law>(list_.pairs());
    }
    start_search();
  }

  void mark_active() {
    if constexpr (Law::keeps_history) {
      std::fill(memory_.active.begin(), memory_.active.end(), std::uint8_t{0});
      for (const Strip& strip : strips_) {
        for (std::size_t k = 0; k < strip.acting.count; ++k) {
          memory_.active[strip.acting.pair[k]] = 1;
        }
      }
    }
  }

  /// A record need not ask what a pair dissipates.
  template <class Record>
  static PairRecord pair_record(Record& record) {
    if constexpr (std::is_constructible_v<PairRecord, Record&>) {
      return std::ref(record);
    } else {
      return [&record](std::uint32_t i,
                       std::uint32_t j,
                       const Vec3& branch,
                       const Vec3& force,
                       const ContactLoss&) { record(i, j, branch, force); };
    }
  }

  template <class Record>
  void add_forces(Record&& record) {
    using Loops = ContactLoops<Law>;
    constexpr bool unseen = std::is_same_v<std::decay_t<Record>, NoRecord>;
    const bool search = searching_;
    const auto work = [&](std::size_t s) {
      Strip& strip = strips_[s];
      if (search) {
        Loops::search(
            range_, search_skin_, contacts_, particles_, list_, load_of_pair_, memory_, strip);
      }
      if constexpr (unseen) {
        Loops::add_forces(law_, contacts_, particles_, memory_, strip);
      } else {
        Loops::add_forces(law_, contacts_, particles_, memory_, strip, pair_record(record));
      }
    };
    if constexpr (unseen) {
      team_->run(strips_.size(), work);
    } else {
      for (std::size_t s = 0; s < strips_.size(); ++s) work(s);  // records come in order
    }
    searching_ = false;
    gather_loads();
    sums_ = sums_of_strips();
    watch(sums_);
  }

  Law law_;
};

template <class Law>
double Simulation<Law>::elastic_energy() const {
  double energy = sums_.tangential_energy;
  for (const Strip& strip : strips_) {
    for (std::size_t k = 0; k < strip.acting.count; ++k) {
      const Partner partner{strip.acting.partner[k]};
      const GrainState& a = particles_.state[strip.acting.first[k]];
      const GrainState& b = particles_.state[partner.grain()];
      Contact contact;
      contact.radius_sum = a.radius + b.radius;
      contact.distance =
          length(a.position - (b.position + contacts_.shifts[partner.image()].position));
      contact.overlap = contact.radius_sum - contact.distance;
      contact.harmonic_radius = harmonic_radius(a.radius, b.radius);
      if (contact.overlap > 0.0) energy += law_.normal.elastic_energy(contact);
      if constexpr (Law::attracts) {
        bool bridged = false;
        if constexpr (Law::bridges) bridged = memory_.bridge[strip.acting.pair[k]] != 0;
        energy += law_.cohesion.energy(contact, bridged);
      }
    }
  }
  return energy;
}

}  // namespace grainlaw::dem
