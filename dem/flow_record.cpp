#include "dem/flow_record.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "dem/flow_setup.h"
#include "dem/run.h"

namespace grainlaw::dem {
namespace {

constexpr std::size_t numbers_per_bin = sizeof(BinMoments) / sizeof(double);
constexpr std::size_t numbers_per_sliding = sizeof(SlidingMoments) / sizeof(double);

bool has_friction(const Scene& scene) {
  return !std::holds_alternative<Frictionless>(scene.friction);
}

template <class Moments>
void append(std::vector<double>& numbers, const std::vector<Moments>& moments) {
  const auto* first = reinterpret_cast<const double*>(moments.data());
  numbers.insert(numbers.end(), first, first + moments.size() * sizeof(Moments) / sizeof(double));
}

template <class Moments>
std::vector<Moments> taken(const double*& from, std::size_t count) {
  std::vector<Moments> moments(count);
  std::memcpy(static_cast<void*>(moments.data()), from, count * sizeof(Moments));
  from += count * sizeof(Moments) / sizeof(double);
  return moments;
}

/// Neither a start profile nor a given start that moves.
bool begins_at_rest(const Scene& scene) {
  return scene.start_profile.empty() &&
         std::ranges::all_of(scene.start,
                             [](const StartGrain& grain) { return grain.velocity == Vec3{}; });
}

double coordination(const ProfileFrames& frames, double begin, double mean_mass) {
  double contacts = 0.0, mass = 0.0;
  for (const ProfileFrame& frame : frames.frames) {
    if (frame.begin < begin) continue;
    for (const BinMoments& bin : frame.bins) {
      contacts += bin.contacts;
      mass += bin.mass;
    }
  }
  return mass > 0.0 ? contacts / mass * mean_mass : 0.0;
}

}  // namespace

FlowRecord::FlowRecord(const Scene& scene, const Box& box)
    : scene_(scene),
      sampler_(profile_bins(scene, box).count, has_friction(scene)),
      criteria_(steady_criteria(scene)) {
  const Measurement& m = scene.measurement;
  const Bins bins = profile_bins(scene, box);
  steps_per_sample_ = std::max(1L, std::lround(m.sample_interval / time_step(scene)));
  samples_per_frame_ = std::max(1L, std::lround(m.frame_interval / m.sample_interval));
  if (const auto ring = ring_bins(scene)) ring_.emplace(Ring{RingSampler(*ring)});
  data_.name = scene.name;
  data_.conditions = conditions(scene);
  data_.frames = {.z_begin = bins.begin,
                  .bin_width = bins.width,
                  .frames = {},
                  .bins_per_row = bins.count == 1 ? 1 : bins_per_row(m),
                  .periodic = bins.periodic,
                  .kernel = bins.count == 1 ? Kernel{} : m.kernel,
                  .from_rest = begins_at_rest(scene)};
  data_.summary.time_step = time_step(scene);
  data_.summary.contact_time = shortest_contact_time(scene);
}

void FlowRecord::sample(const SimulationBase& simulation,
                        const std::vector<ContactSample>& contacts) {
  const Particles& particles = simulation.particles();
  sampler_.sample(
      profile_bins(scene_, simulation.box()), particles, simulation.setup().dynamics, contacts);
  constexpr int stride = 5;
  if (ring_ && ring_->passed++ % stride == 0) {
    ring_->sampler.sample(particles, simulation.setup().dynamics, contacts);
  }
  constexpr double deep = 0.1;  // [smaller radius]
  for (const ContactSample& contact : contacts) {
    const double a = particles.state[contact.first].radius;
    const double b = particles.state[contact.second].radius;
    const double near = a + b - deep * (b > 0.0 ? std::min(a, b) : a);
    deep_contacts_ += square(contact.branch) < near * near;
    sampled_contacts_ += square(contact.branch) < (a + b) * (a + b);
  }
}

void FlowRecord::close_frame(double begin, const SimulationBase& simulation) {
  ProfileFrame frame = sampler_.finish();
  frame.begin = begin;
  frame.end = simulation.time();
  data_.frames.frames.push_back(std::move(frame));
  if (ring_) {
    ring_->frames.push_back(ring_->sampler.finish());
    ring_->passed = 0;
  }
  width_sum_ += profile_bins(scene_, simulation.box()).width;
  wall_at_frame_.push_back(wall_before_ + clock_.seconds());
}

const Assessment& FlowRecord::assess() {
  assessment_ = dem::assess(data_.frames.frames, criteria_);
  return assessment_;
}

LocalData FlowRecord::finish(const SimulationBase& simulation,
                             const EnergyLedger& ledger,
                             double energy) {
  const auto& frames = data_.frames.frames;
  if (!frames.empty()) {
    data_.frames.bin_width = width_sum_ / static_cast<double>(frames.size());
  }
  data_.window = steady_window(assessment_, frames);
  for (const TiltStep& tilt : data_.conditions.tilts) {
    if (tilt.time < simulation.time()) data_.conditions.inclination = tilt.inclination;
  }
  data_.rows = average(data_.frames, data_.conditions, data_.window);
  data_.fields = fields_at_widths(data_.frames, data_.conditions, data_.window);
  if (ring_) {
    const auto inside = frames_inside(data_.frames, data_.window);
    const std::span<const RingFrame> all = ring_->frames;
    const auto first = static_cast<std::size_t>(inside.data() - frames.data());
    const auto own = inside.empty() ? all.first(0) : all.subspan(first, inside.size());
    data_.ring = ring_fields(ring_->sampler.grid(), own, data_.conditions);
  }
  RunSummary& summary = data_.summary;
  const Particles& particles = simulation.particles();
  summary.steps = simulation.steps();
  summary.flowing_grains = static_cast<int>(particles.mobile);
  summary.base_grains = static_cast<int>(particles.real - particles.mobile);
  summary.wall_seconds = wall_before_ + clock_.seconds();
  for (std::size_t k = 0; k < frames.size() && frames[k].end <= data_.window.begin; ++k) {
    summary.startup_wall_seconds = wall_at_frame_[k];
  }
  summary.largest_overlap = simulation.largest_overlap();
  summary.deep_overlap_share = static_cast<double>(deep_contacts_) /
                               static_cast<double>(std::max<std::int64_t>(1, sampled_contacts_));
  const double dissipated = ledger.dissipated();
  summary.energy_residual =
      std::abs(ledger.residual(energy)) / (dissipated > 0.0 ? dissipated : ledger.initial_energy);
  summary.coordination = coordination(data_.frames, data_.window.begin, scene_.grains.mean_mass());
  return std::move(data_);
}

void FlowRecord::save(Checkpoint& to) const {
  std::vector<double> frames;
  for (const ProfileFrame& frame : data_.frames.frames) {
    frames.insert(frames.end(),
                  {frame.begin,
                   frame.end,
                   static_cast<double>(frame.samples),
                   frame.centre_of_mass,
                   frame.kinetic_energy});
    append(frames, frame.bins);
    append(frames, frame.sliding);
  }
  to.numbers["record/frames"] = std::move(frames);
  if (ring_) {
    std::vector<double>& cells = to.numbers["record/ring"];
    for (const RingFrame& frame : ring_->frames) append(cells, frame.cells);
  }
  to.numbers["record/sums"] = {width_sum_};
  to.integers["record/contacts"] = {deep_contacts_, sampled_contacts_};
  to.numbers["run/wall_seconds"] = {wall_before_ + clock_.seconds(),
                                    data_.summary.stepping_seconds};
  to.numbers["run/wall_at_frame"] = wall_at_frame_;
}

void FlowRecord::restore(const Checkpoint& from) {
  const std::vector<double>& frames = entry(from.numbers, "record/frames");
  const std::size_t bins = sampler_.bins();
  const std::size_t sliding = has_friction(scene_) ? bins : 0;
  const std::size_t stride = 5 + bins * numbers_per_bin + sliding * numbers_per_sliding;
  if (frames.size() % stride != 0) throw CheckpointError("the frames of another scene");
  for (std::size_t at = 0; at < frames.size(); at += stride) {
    const double* moments = &frames[at + 5];
    data_.frames.frames.push_back({.begin = frames[at],
                                   .end = frames[at + 1],
                                   .samples = static_cast<int>(frames[at + 2]),
                                   .centre_of_mass = frames[at + 3],
                                   .kinetic_energy = frames[at + 4],
                                   .bins = taken<BinMoments>(moments, bins),
                                   .sliding = taken<SlidingMoments>(moments, sliding)});
  }
  if (ring_) restore_ring(from);
  width_sum_ = entry(from.numbers, "record/sums", 1)[0];
  const auto& contacts = entry(from.integers, "record/contacts", 2);
  deep_contacts_ = contacts[0];
  sampled_contacts_ = contacts[1];
  const auto& wall = entry(from.numbers, "run/wall_seconds", 2);
  wall_before_ = wall[0];
  data_.summary.stepping_seconds = wall[1];
  wall_at_frame_ = entry(from.numbers, "run/wall_at_frame");
}

/// Ring frames are those of the profiles: as many, and all have equally many samples.
void FlowRecord::restore_ring(const Checkpoint& from) {
  constexpr std::size_t numbers_per_cell = sizeof(CellMoments) / sizeof(double);
  const std::size_t cells = ring_->sampler.grid().size();
  const std::size_t frames = data_.frames.frames.size();
  const double* at = entry(from.numbers, "record/ring", frames * cells * numbers_per_cell).data();
  for (const ProfileFrame& frame : data_.frames.frames) {
    ring_->frames.push_back({.samples = frame.samples, .cells = taken<CellMoments>(at, cells)});
  }
}

}  // namespace grainlaw::dem
