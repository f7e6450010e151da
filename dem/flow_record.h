#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "dem/checkpoint.h"
#include "dem/coarse_graining.h"
#include "dem/local_data.h"
#include "dem/ring_sampler.h"
#include "dem/scene.h"
#include "dem/simulation.h"
#include "dem/steady_state.h"

namespace grainlaw::dem {

/// Wall time since it was made [s].
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// What a run measures of its grains, frame by frame, up to local data. Independent of the law.
class FlowRecord {
 public:
  FlowRecord(const Scene& scene, const Box& box);

  long steps_per_sample() const { return steps_per_sample_; }
  long samples_per_frame() const { return samples_per_frame_; }

  /// Takes the acting pairs of a step.
  void sample(const SimulationBase& simulation, const std::vector<ContactSample>& contacts);
  /// Ends the frame that began at a time.
  void close_frame(double begin, const SimulationBase& simulation);

  /// Is the flow steady for long enough, arrested, or away?
  const Assessment& assess();
  const Assessment& assessment() const { return assessment_; }
  double last_change() const { return criteria_.last_change; }  ///< of the drive [time]
  const std::vector<ProfileFrame>& frames() const { return data_.frames.frames; }

  /// Averages over the steady window.
  LocalData finish(const SimulationBase& simulation, const EnergyLedger& ledger, double energy);

  void save(Checkpoint& to) const;
  void restore(const Checkpoint& from);

  RunSummary& summary() { return data_.summary; }

 private:
  /// Fields over radius and height. Samples follow each other so closely that every fifth says as
  /// much; all would cost a tenth of a run.
  struct Ring {
    RingSampler sampler;
    std::vector<RingFrame> frames{};
    int passed = 0;  ///< samples of the present frame
  };
  void restore_ring(const Checkpoint& from);

  const Scene& scene_;
  Stopwatch clock_;
  FrameSampler sampler_;
  std::optional<Ring> ring_;
  SteadyCriteria criteria_;
  Assessment assessment_;
  LocalData data_;
  std::vector<double> wall_at_frame_;
  double width_sum_ = 0.0;    ///< of the bins, over frames: those of a driven box breathe
  double wall_before_ = 0.0;  ///< of the runs that this one goes on from [s]
  long steps_per_sample_ = 1;
  long samples_per_frame_ = 1;
  std::int64_t deep_contacts_ = 0;
  std::int64_t sampled_contacts_ = 0;
};

}  // namespace grainlaw::dem
