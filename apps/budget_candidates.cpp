#include "apps/budget_candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/io/scene_text.h"
#include "apps/scene_run.h"
#include "dem/flow_setup.h"

namespace grainlaw {
namespace {

/// Part of a run over warm-up and averaging: the steady-state detector may cut more than expected.
constexpr double detector_reserve = 0.25;

/// Of the frames that are averaged; with fewer, blocks of them say nothing of an error.
constexpr double least_frames = 16.0;

/// Of the averaging time of the scene, which is what a person thought right for one run.
constexpr double least_share = 1.0 / 16.0;

std::vector<double> place_of(const dem::Scene& scene) {
  if (const auto* chute = std::get_if<dem::Chute>(&scene.geometry)) return {chute->inclination};
  const io::BoxState state = io::box_state(scene);
  return {std::log(state.inertial_number), std::log(state.softness), state.bond_number};
}

/// Wall time of a step of one grain [s].
double grain_step_seconds(const dem::Scene& scene) {
  const double steps = scene.measurement.time_limit / dem::time_step(scene);
  return run_time(scene).most / steps / dem::grains(scene);
}

/// Boxes forget their packing within a strain of 1; of a chute the scene says how long its start
/// may take, until the first runs have shown it.
double start_up(const dem::Scene& scene) {
  const double known = dem::steady_criteria(scene).start_up;
  if (known > 0.0) return known;
  return scene.measurement.time_limit - scene.measurement.averaging_time;
}

BudgetCandidate candidate_of(const io::PlannedRun& planned, double grain_step) {
  const dem::Scene& scene = planned.file.scene;
  const dem::Measurement& measurement = scene.measurement;
  BudgetCandidate candidate{.planned = planned, .place = place_of(scene)};
  candidate.unit = dem::unit_time(scene);
  candidate.seconds_per_unit =
      grain_step * dem::grains(scene) * candidate.unit / dem::time_step(scene);
  candidate.warm_up = std::max(0.0, start_up(scene)) / candidate.unit;
  candidate.usable = least_frames * measurement.frame_interval / candidate.unit;
  candidate.least =
      std::max(candidate.usable, least_share * measurement.averaging_time / candidate.unit);
  candidate.most = std::max(candidate.least, measurement.averaging_time / candidate.unit);
  return candidate;
}

}  // namespace

double BudgetCandidate::seconds(double averaging) const {
  return seconds_per_unit * (warm_up + (1.0 + detector_reserve) * averaging);
}

double BudgetCandidate::averaging(double seconds) const {
  return (seconds / seconds_per_unit - warm_up) / (1.0 + detector_reserve);
}

int BudgetCandidate::tries() const {
  return runs + std::max(0, unsteady - 1);
}

double BudgetCandidate::steady_share() const {
  return (runs + 1.0) / (runs + unsteady + 1.0);
}

void BudgetCandidate::count_unsteady(double warm_up_of_run, bool may_be_start) {
  ++unsteady;
  if (!may_be_start || unsteady <= runs) return;
  warm_up = std::max(warm_up, std::min(2.0 * warm_up_of_run, most));
}

std::vector<BudgetCandidate> budget_candidates(const std::vector<io::PlannedRun>& planned) {
  std::vector<BudgetCandidate> candidates;
  double grain_step = 0.0;
  for (const io::PlannedRun& run : planned) {
    const auto same = [&](const BudgetCandidate& other) {
      return other.planned.condition == run.condition;
    };
    if (!run.fitted || std::ranges::any_of(candidates, same)) continue;
    if (grain_step == 0.0) grain_step = grain_step_seconds(run.file.scene);
    candidates.push_back(candidate_of(run, grain_step));
  }
  return candidates;
}

io::SceneFile budget_scene(const BudgetCandidate& candidate,
                           const std::string& name,
                           double averaging,
                           std::size_t seeds_on) {
  const io::SceneFile& file = candidate.planned.file;
  const double size = file.units[io::dimension::time].size * candidate.unit;
  const double limit = candidate.warm_up + (1.0 + detector_reserve) * averaging;
  const std::uint64_t seed = file.scene.seed + seeds_on;
  return io::parse_scene(
      io::with_values(file.text,
                      {{"", "name", fmt::format("\"{}\"", name)},
                       {"", "seed", fmt::format("{}", seed)},
                       {"measurement", "averaging_time", fmt::format("{:.6g}", size * averaging)},
                       {"measurement", "time_limit", fmt::format("{:.6g}", size * limit)}}),
      file.path);
}

}  // namespace grainlaw
