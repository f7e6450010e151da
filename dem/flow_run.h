#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "dem/binary_collision.h"
#include "dem/contact_lifetimes.h"
#include "dem/flow_record.h"
#include "dem/flow_setup.h"
#include "dem/packing.h"
#include "dem/run.h"

namespace grainlaw::dem {

/// The grains as they are now, in the order of their numbers, spins left out.
InitialState present_state(const SimulationBase& simulation);

/// The same with spins, velocities as of the time of the positions.
Snapshot snapshot(const SimulationBase& simulation);

/// A packing that has come to rest without cohesion, which would keep it as loose as it was made.
/// Friction stays: without it a layer settles so densely (0.64) that it does not start to flow at
/// tilts at which it could go on flowing. Throws PackingStopped.
template <class Law>
InitialState settled(const Scene& scene,
                     const Law& law,
                     const InitialState& packing,
                     int threads,
                     const KeepGoing& keep_going) {
  constexpr double longest = 60.0;      // [unit times]
  constexpr double slow_energy = 1e-4;  // per grain [m g d]
  std::optional<SimulationSetup> setup = settling_setup(scene, packing);
  if (!setup) return packing;
  setup->threads = threads;
  Simulation simulation(ContactLaw{law.normal, Cohesionless{}, law.friction}, *setup, packing);
  const double unit = unit_time(scene);
  const double speed2 = scene.grains.diameter * scene.grains.diameter / (unit * unit);
  const double slow = slow_energy * scene.grains.mass * speed2 * grains(scene);
  const long chunk = std::max(1L, std::lround(unit / time_step(scene)));
  do {
    for (long k = 0; k < chunk; ++k) {
      stop_unless(keep_going);
      simulation.step();
    }
  } while (simulation.kinetic_energy() > slow && simulation.time() < longest * unit);
  return present_state(simulation);
}

/// One scene from packing, or checkpoint, to local data.
template <class Law>
class FlowRun {
 public:
  FlowRun(const Scene& scene, const Law& law, const RunOptions& options)
      : scene_(scene),
        options_(options),
        start_(start(scene, law, options)),
        law_(law),
        simulation_(law, setup(scene, start_, options), start_),
        record_(scene, start_.box),
        field_changes_(field_changes(scene)) {
    if (scene.lifetimes) lifetimes_.emplace(scene);
    const double speed = scene.grains.diameter / unit_time(scene);
    record_.summary().restitution =
        mean_restitution(ContactLaw{law.normal, Cohesionless{}, Frictionless{}},
                         {.mass = scene.grains.mass, .diameter = scene.grains.diameter},
                         speed,
                         time_step(scene));
    if (!goes_on(options)) {
      take_snapshot();
      return;
    }
    simulation_.restore(*options.resume);
    record_.restore(*options.resume);
    if (lifetimes_) lifetimes_->restore(*options.resume);
    const auto passed = [&](const FieldChange& c) { return c.step < simulation_.steps(); };
    next_change_ = static_cast<std::size_t>(std::ranges::count_if(field_changes_, passed));
    snapshots_ = due_snapshots();
  }

  LocalData run() {
    for (bool go_on = true; go_on;) {
      const Stopwatch stepping;
      add_frame();
      record_.summary().stepping_seconds += stepping.seconds();
      const Assessment& now = record_.assess();
      const bool done = now.certain || simulation_.time() >= scene_.measurement.time_limit;
      const bool asked_to_stop = !report();
      go_on = !done && !asked_to_stop;
      const bool due = since_save_.seconds() >= options_.checkpoint_interval;
      if (options_.save && !done && (due || asked_to_stop)) save();
    }
    LocalData data =
        record_.finish(simulation_, simulation_.ledger(), simulation_.mechanical_energy());
    if (lifetimes_) data.lifetimes = lifetimes_->finish(data);
    return data;
  }

 private:
  static bool goes_on(const RunOptions& options) {
    return options.resume && *options.resume != Checkpoint{};
  }

  InitialState start(const Scene& scene, const Law& law, const RunOptions& options) {
    const KeepGoing keep_going = [this] { return report_packing(); };
    const InitialState packing = initial_state(scene, keep_going);
    if (goes_on(options)) return packing;  // what it holds is replaced
    return moving(settled(scene, law, packing, options.threads, keep_going), scene.start_profile);
  }

  static SimulationSetup setup(const Scene& scene,
                               const InitialState& initial,
                               const RunOptions& options) {
    SimulationSetup setup = flow_setup(scene, initial);
    setup.threads = options.threads;
    return setup;
  }

  void add_frame() {
    const double begin = simulation_.time();
    for (long sample = 0; sample < record_.samples_per_frame(); ++sample) {
      for (long k = 1; k < record_.steps_per_sample(); ++k) {
        change_field();
        simulation_.step();
        if (lifetimes_) lifetimes_->follow(simulation_);
      }
      contacts_.clear();
      change_field();
      simulation_.step([&](std::uint32_t i,
                           std::uint32_t j,
                           const Vec3& branch,
                           const Vec3& force,
                           const ContactLoss& loss) {
        const double rate = 1.0 / simulation_.setup().dynamics.time_step;
        contacts_.push_back({i, j, branch, force, rate * loss.all, rate * loss.sliding});
      });
      record_.sample(simulation_, contacts_);
      if (lifetimes_) sample_lifetimes();
      if (due_snapshots() > snapshots_) take_snapshot();
    }
    record_.close_frame(begin, simulation_);
    if (lifetimes_) lifetimes_->end_frame(simulation_.time());
  }

  /// Before a step.
  void change_field() {
    for (; next_change_ < field_changes_.size() &&
           field_changes_[next_change_].step <= simulation_.steps();
         ++next_change_) {
      simulation_.set_field(field_changes_[next_change_].field);
    }
  }

  void sample_lifetimes() {
    lifetimes_->follow(simulation_);
    lifetimes_->sample(simulation_, contacts_, [&](const ContactSample& contact) {
      return slips(law_, simulation_.particles(), contact);
    });
  }

  /// How many have fallen due since the start of the flow, which counts as one.
  long due_snapshots() const {
    if (!options_.snapshot) return 0;
    return 1 + static_cast<long>(simulation_.time() / options_.snapshot_interval);
  }
  void take_snapshot() {
    snapshots_ = due_snapshots();
    if (options_.snapshot) options_.snapshot(snapshot(simulation_));
  }

  /// Before the flow, where a step or a sweep may take no time, or seconds: told now and then.
  /// False: the observer wants the run to stop.
  bool report_packing() {
    constexpr double interval = 0.1;  // [s]
    if (!options_.observer || clock_.seconds() < next_report_) return true;
    next_report_ = clock_.seconds() + interval;
    return options_.observer({.wall_seconds = clock_.seconds(), .settling = true});
  }

  /// False: the observer wants the run to stop.
  bool report() const {
    if (!options_.observer) return true;
    const auto& frames = record_.frames();
    const Measurement& m = scene_.measurement;
    const double begin = frames[record_.assessment().first_frame].begin;
    const double wanted = std::max(begin, record_.last_change()) + m.averaging_time;
    return options_.observer(
        {.time = simulation_.time(),
         .expected_end = std::min(std::max(simulation_.time(), wanted), m.time_limit),
         .steps = simulation_.steps(),
         .wall_seconds = clock_.seconds(),
         .mean_velocity = mean_velocity(frames.back())});
  }

  void save() {
    Checkpoint checkpoint;
    simulation_.save(checkpoint);
    record_.save(checkpoint);
    if (lifetimes_) lifetimes_->save(checkpoint);
    options_.save(checkpoint);
    since_save_ = {};
  }

  const Scene& scene_;
  const RunOptions& options_;
  Stopwatch clock_;
  Stopwatch since_save_;
  double next_report_ = 0.0;  ///< [s]
  long snapshots_ = 0;
  InitialState start_;
  Law law_;
  Simulation<Law> simulation_;
  FlowRecord record_;
  std::vector<FieldChange> field_changes_;
  std::size_t next_change_ = 0;
  std::optional<ContactLifetimes> lifetimes_;
  std::vector<ContactSample> contacts_;
};
template <class Law>
FlowRun(const Scene&, const Law&, const RunOptions&) -> FlowRun<Law>;

}  // namespace grainlaw::dem
