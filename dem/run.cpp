#include "dem/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "dem/binary_collision.h"
#include "dem/chute.h"
#include "dem/contact_law.h"

namespace grainlaw::dem {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

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

InitialState at_rest(const ChuteGrains& grains) {
  return {.position = grains.column, .velocity = {}, .spin = {}, .frozen = grains.base};
}

/// One chute from packing to local data.
template <class Law>
class ChuteRun {
 public:
  ChuteRun(const Scene& scene, const Law& law, const Observer& observer)
      : scene_(scene),
        observer_(observer),
        grains_(pack_chute(scene)),
        simulation_(law, chute_setup(scene, grains_), at_rest(grains_)),
        sampler_(chute_bins(scene)),
        criteria_(steady_criteria(scene)) {
    const Measurement& m = scene.measurement;
    steps_per_sample_ = std::max(1L, std::lround(m.sample_interval / time_step(scene)));
    samples_per_frame_ = std::max(1L, std::lround(m.frame_interval / m.sample_interval));
    data_.name = scene.name;
    data_.conditions = conditions(scene);
    data_.frames.z_begin = chute_bins(scene).z_begin;
    data_.frames.bin_width = m.bin_width;
    data_.summary.time_step = time_step(scene);
    data_.summary.contact_time = shortest_contact_time(scene);
    data_.summary.restitution = mean_restitution(
        law, {.mass = scene.grains.mass, .diameter = scene.grains.diameter}, time_step(scene));
  }

  LocalData run() {
    bool go_on = settle();
    simulation_.set_gravity(gravity(scene_.geometry.gravity, scene_.geometry.inclination));
    simulation_.open_ledger();
    Assessment assessment{.reason = "short: stopped before the flow started"};
    while (go_on) {
      add_frame();
      assessment = assess(data_.frames.frames, criteria_);
      go_on = !assessment.certain && simulation_.time() < scene_.measurement.time_limit;
      go_on = report(assessment) && go_on;
    }
    data_.window = steady_window(assessment, data_.frames.frames);
    data_.rows = average(data_.frames, data_.conditions, data_.window);
    summarise();
    return std::move(data_);
  }

 private:
  /// Lets the column come to rest on the flat base, with all its forces. False: told to stop.
  bool settle() {
    constexpr double longest = 60.0;      // [sqrt(d/g)]
    constexpr double slow_energy = 1e-4;  // per grain [m g d]
    const double d = scene_.grains.diameter;
    const double g = scene_.geometry.gravity;
    const double unit_time = std::sqrt(d / g);
    const double slow = slow_energy * scene_.grains.mass * g * d * scene_.geometry.grains;
    const long chunk = std::max(1L, std::lround(unit_time / time_step(scene_)));
    do {
      for (long k = 0; k < chunk; ++k) simulation_.step();
      if (observer_ && !observer_(progress(true))) return false;
    } while (simulation_.kinetic_energy() > slow && simulation_.time() < longest * unit_time);
    return true;
  }

  void add_frame() {
    const double begin = simulation_.time();
    for (long sample = 0; sample < samples_per_frame_; ++sample) {
      for (long k = 1; k < steps_per_sample_; ++k) simulation_.step();
      take_sample();
    }
    ProfileFrame frame = sampler_.finish();
    frame.begin = begin;
    frame.end = simulation_.time();
    data_.frames.frames.push_back(std::move(frame));
    wall_at_frame_.push_back(seconds_since(start_));
  }

  void take_sample() {
    contacts_.clear();
    simulation_.step([&](std::uint32_t i, std::uint32_t j, const Vec3& branch, const Vec3& force) {
      contacts_.push_back({i, j, branch, force});
    });
    sampler_.sample(simulation_.particles(), simulation_.setup().dynamics, contacts_);
    constexpr double deep = 0.1;  // [radius]
    const double near = scene_.grains.diameter * (1.0 - 0.5 * deep);
    for (const ContactSample& contact : contacts_) {
      deep_contacts_ += square(contact.branch) < near * near;
    }
    sampled_contacts_ += static_cast<long>(contacts_.size());
  }

  Progress progress(bool settling) const {
    Progress progress{.time = settling ? 0.0 : simulation_.time(),
                      .expected_end = scene_.measurement.averaging_time,
                      .steps = simulation_.steps(),
                      .wall_seconds = seconds_since(start_),
                      .settling = settling};
    if (!data_.frames.frames.empty())
      progress.mean_velocity = mean_velocity(data_.frames.frames.back());
    return progress;
  }

  bool report(const Assessment& assessment) const {
    if (!observer_) return true;
    Progress now = progress(false);
    const double wanted =
        data_.frames.frames[assessment.first_frame].begin + scene_.measurement.averaging_time;
    now.expected_end = std::min(std::max(now.time, wanted), scene_.measurement.time_limit);
    return observer_(now);
  }

  void summarise() {
    RunSummary& summary = data_.summary;
    summary.steps = simulation_.steps();
    summary.flowing_grains = static_cast<int>(grains_.column.size());
    summary.base_grains = static_cast<int>(grains_.base.size());
    summary.wall_seconds = seconds_since(start_);
    summary.startup_wall_seconds = startup_wall_seconds();
    summary.largest_overlap = 2.0 * simulation_.largest_overlap() / scene_.grains.diameter;
    summary.deep_overlap_share =
        static_cast<double>(deep_contacts_) / static_cast<double>(std::max(1L, sampled_contacts_));
    const EnergyLedger ledger = simulation_.ledger();
    summary.energy_residual =
        std::abs(ledger.residual(simulation_.mechanical_energy())) / ledger.dissipated();
    summary.coordination = coordination();
  }

  double startup_wall_seconds() const {
    const auto& frames = data_.frames.frames;
    double seconds = 0.0;
    for (std::size_t k = 0; k < frames.size() && frames[k].end <= data_.window.begin; ++k) {
      seconds = wall_at_frame_[k];
    }
    return seconds;
  }

  double coordination() const {
    double contacts = 0.0, mass = 0.0;
    for (const ProfileFrame& frame : data_.frames.frames) {
      if (frame.begin < data_.window.begin) continue;
      for (const BinMoments& bin : frame.bins) {
        contacts += bin.contacts;
        mass += bin.mass;
      }
    }
    return contacts / mass * scene_.grains.mass;
  }

  const Scene& scene_;
  const Observer& observer_;
  Clock::time_point start_ = Clock::now();
  ChuteGrains grains_;
  Simulation<Law> simulation_;
  FrameSampler sampler_;
  SteadyCriteria criteria_;
  LocalData data_;
  std::vector<ContactSample> contacts_;
  std::vector<double> wall_at_frame_;
  long steps_per_sample_ = 1;
  long samples_per_frame_ = 1;
  long deep_contacts_ = 0;
  long sampled_contacts_ = 0;
};
template <class Law>
ChuteRun(const Scene&, const Law&, const Observer&) -> ChuteRun<Law>;

}  // namespace

ChuteConditions conditions(const Scene& scene) {
  const auto* sliding = std::get_if<Sliding>(&scene.friction);
  return {.inclination = scene.geometry.inclination,
          .gravity = scene.geometry.gravity,
          .grain_diameter = scene.grains.diameter,
          .grain_density = scene.grains.density(),
          .stiffness = std::visit([](const auto& law) { return law.stiffness; }, scene.normal),
          .contact_friction = sliding ? sliding->coefficient : 0.0,
          .mass_per_area = mass_per_area(scene),
          .base = recipe(scene.geometry.base)};
}

LocalData run(const Scene& scene, const Observer& observer) {
  validate(scene);
  return with_law(scene, [&](auto law) { return ChuteRun{scene, law, observer}.run(); });
}

double measure_step_seconds(const Scene& scene) {
  validate(scene);
  return with_law(scene, [&](auto law) {
    const ChuteGrains grains = pack_chute(scene);
    Simulation simulation{law, chute_setup(scene, grains), at_rest(grains)};
    const auto seconds_per_step = [&] {
      constexpr double shortest = 0.2;  // [s]
      const auto start = Clock::now();
      long steps = 0;
      for (; steps < 100 || seconds_since(start) < shortest; ++steps) simulation.step();
      return seconds_since(start) / static_cast<double>(steps);
    };
    seconds_per_step();  // the packing has hardly any contacts: let it fall together first
    return seconds_per_step();
  });
}

}  // namespace grainlaw::dem
