#include "dem/reduced_data.h"

#include <algorithm>
#include <array>
#include <bit>

namespace grainlaw::dem {
namespace {

using Frames = std::span<const ProfileFrame>;

/// One frame over the time of several that follow each other.
ProfileFrame joined(Frames frames) {
  ProfileFrame sum{.begin = frames.front().begin, .end = frames.back().end, .bins = {}};
  for (const ProfileFrame& frame : frames) sum.samples += frame.samples;
  for (const ProfileFrame& frame : frames) {
    const double share = static_cast<double>(frame.samples) / sum.samples;
    sum.centre_of_mass += share * frame.centre_of_mass;
    sum.kinetic_energy += share * frame.kinetic_energy;
  }
  FrameMoments mean = mean_moments(frames);
  sum.bins = std::move(mean.bins);
  sum.sliding = std::move(mean.sliding);
  return sum;
}

/// `bins`: of a frame in the end.
void append_joined(std::vector<ProfileFrame>& to, Frames frames, std::size_t bins) {
  constexpr std::size_t enough_frames = 32;  // for blocks and their covariances
  constexpr std::size_t enough_bins = 2048;  // in all: 0.3 MB
  const std::size_t most = std::max(enough_frames, enough_bins / std::max<std::size_t>(1, bins));
  const std::size_t count = std::min(most, frames.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = k * frames.size() / count;
    const std::size_t end = (k + 1) * frames.size() / count;
    to.push_back(joined(frames.subspan(begin, end - begin)));
  }
}

/// As many bins as make one: whole ones in a row, not wider than half the kernel.
std::size_t bins_to_join(const ProfileFrames& grid) {
  const double widest = (0.5 + 1e-9) * grid.kernel.width;
  std::size_t most = 1;
  for (std::size_t n = 2; static_cast<double>(n) * grid.bin_width <= widest; ++n) {
    if (grid.bins_per_row % n == 0) most = n;
  }
  return most;
}

/// Joins every n bins of a frame, each with its share of the volume; shells have more of it the
/// farther out they are.
void join_bins(ProfileFrame& frame, const ProfileFrames& grid, std::size_t n, bool radial) {
  const auto volume = [&](std::size_t k) {
    return radial ? std::max(0.0, grid.bin_centre(k)) : 1.0;
  };
  std::vector<BinMoments> bins((frame.bins.size() + n - 1) / n);
  std::vector<SlidingMoments> sliding((frame.sliding.size() + n - 1) / n);
  for (std::size_t k = 0; k < frame.bins.size(); ++k) {
    const std::size_t first = k / n * n;
    double whole = 0.0;
    for (std::size_t j = first; j < first + n; ++j) whole += volume(j);
    if (whole == 0.0) continue;
    const double place = static_cast<double>(k - first) + 0.5 - 0.5 * static_cast<double>(n);
    const double share = volume(k) / whole;
    add_shifted(bins[k / n], frame.bins[k], place * grid.bin_width, share);
    if (!sliding.empty()) add_scaled(sliding[k / n], frame.sliding[k], share);
  }
  frame.bins = std::move(bins);
  frame.sliding = std::move(sliding);
}

template <class Moments>
void round_to_single(std::vector<Moments>& list) {
  for (Moments& moments : list) {
    auto numbers = std::bit_cast<std::array<double, sizeof(Moments) / sizeof(double)>>(moments);
    for (double& number : numbers) number = static_cast<double>(static_cast<float>(number));
    moments = std::bit_cast<Moments>(numbers);
  }
}

}  // namespace

LocalData reduced(LocalData data) {
  ProfileFrames& grid = data.frames;
  const Frames all = grid.frames;
  const Frames inside = frames_inside(grid, data.window);
  const auto before = static_cast<std::size_t>(inside.data() - all.data());
  const std::size_t n = bins_to_join(grid);
  const std::size_t bins = all.empty() ? 0 : all.front().bins.size() / n;
  std::vector<ProfileFrame> frames;
  append_joined(frames, all.first(before), bins);
  append_joined(frames, inside, bins);
  append_joined(frames, all.subspan(before + inside.size()), bins);
  for (ProfileFrame& frame : frames) {
    join_bins(frame, grid, n, data.conditions.geometry == "split_bottom");
    round_to_single(frame.bins);
    round_to_single(frame.sliding);
  }
  grid.frames = std::move(frames);
  grid.bin_width *= static_cast<double>(n);
  grid.bins_per_row /= n;
  return data;
}

}  // namespace grainlaw::dem
