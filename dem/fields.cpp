#include "dem/fields.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/local_data.h"

namespace grainlaw::dem {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
using Symmetric = std::array<double, 6>;  // xx yy zz xy xz yz
constexpr std::array<std::array<std::size_t, 2>, 6> axes_of{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

/// Fine bins, those around them that fields reach, and how sources are shared.
class Smoother {
 public:
  Smoother(const ProfileFrames& grid, const Kernel& kernel, std::size_t bins, bool radial)
      : grid_(grid),
        bins_(static_cast<std::ptrdiff_t>(bins)),
        margin_(static_cast<std::ptrdiff_t>(margin_rows(grid, kernel) * grid.bins_per_row)),
        shares_(homogeneous() ? std::vector{1.0} : bin_shares(kernel, grid.bin_width)),
        radial_(radial) {}

  bool homogeneous() const { return grid_.periodic && bins_ == 1; }
  std::size_t size() const { return static_cast<std::size_t>(bins_ + 2 * margin_); }
  std::size_t size_inside() const { return static_cast<std::size_t>(bins_); }
  std::size_t place(std::size_t bin) const { return bin + static_cast<std::size_t>(margin_); }

  /// Volume of a place against others.
  double weight(std::size_t place) const {
    if (!radial_) return 1.0;
    const double bin = static_cast<double>(static_cast<std::ptrdiff_t>(place) - margin_);
    return std::max(0.0, grid_.z_begin + (bin + 0.5) * grid_.bin_width);
  }

  /// Calls add(source bin, its distance, its share) for every bin that a place gets a share of;
  /// bins outside are asked for where `outside`.
  template <class Add>
  void gather(std::size_t place, bool outside, Add&& add) const {
    const auto reach = static_cast<std::ptrdiff_t>(shares_.size() / 2);
    for (std::ptrdiff_t m = -reach; m <= reach; ++m) {
      std::ptrdiff_t bin = static_cast<std::ptrdiff_t>(place) - margin_ + m;
      if (grid_.periodic) bin = (bin % bins_ + bins_) % bins_;
      if (!outside && (bin < 0 || bin >= bins_)) continue;
      add(bin,
          static_cast<double>(m) * grid_.bin_width,
          shares_[static_cast<std::size_t>(m + reach)]);
    }
  }

  /// The field of additive sums: add(sum, source, distance, share).
  template <class T, class Add>
  std::vector<T> smooth(const std::vector<T>& sources, Add&& add) const {
    std::vector<T> field(sources.empty() ? 0 : size());
    for (std::size_t i = 0; i < field.size(); ++i) {
      const double here = weight(i);
      if (here == 0.0) continue;
      gather(i, false, [&](std::ptrdiff_t bin, double distance, double share) {
        const auto source = static_cast<std::size_t>(bin);
        add(field[i], sources[source], distance, share * weight(place(source)) / here);
      });
    }
    return field;
  }

 private:
  const ProfileFrames& grid_;
  std::ptrdiff_t bins_;
  std::ptrdiff_t margin_;
  std::vector<double> shares_;
  bool radial_;
};

/// Velocity around the centre of a bin.
struct VelocityLine {
  std::array<double, 3> value{};  ///< at the centre
  std::array<double, 3> slope{};
};

VelocityLine velocity_line(const BinMoments& bin, double width, bool homogeneous) {
  constexpr double least_spread = 1e-10;  // of positions, in bin widths squared: rounding below
  VelocityLine line;
  if (!(bin.mass > 0.0)) return {{nan, nan, nan}, {nan, nan, nan}};
  const double offset = bin.mass_offset / bin.mass;
  const double variance = bin.mass_offset_squared / bin.mass - offset * offset;
  const bool sloping = !homogeneous && variance > least_spread * width * width;
  for (std::size_t a = 0; a < 3; ++a) {
    const double mean = bin.momentum[a] / bin.mass;
    const double covariance = bin.momentum_offset[a] / bin.mass - offset * mean;
    line.slope[a] = sloping ? covariance / variance : 0.0;
    line.value[a] = mean - line.slope[a] * offset;
  }
  return line;
}

/// sum m v' v' / V with v' = v - (value + slope * offset) of each grain.
Symmetric flux_about(const VelocityLine& line, const BinMoments& bin) {
  Symmetric flux{};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto [a, b] = axes_of[k];
    flux[k] = bin.momentum_flux[k] - line.value[a] * bin.momentum[b] -
              bin.momentum[a] * line.value[b] + bin.mass * line.value[a] * line.value[b] -
              line.slope[a] * bin.momentum_offset[b] - bin.momentum_offset[a] * line.slope[b] +
              bin.mass_offset * (line.value[a] * line.slope[b] + line.slope[a] * line.value[b]) +
              bin.mass_offset_squared * line.slope[a] * line.slope[b];
  }
  return flux;
}

void add_flux(Symmetric& sum, const Symmetric& flux, double factor) {
  for (std::size_t k = 0; k < 6; ++k) sum[k] += factor * flux[k];
}

/// What lies above a height per area, of a density, averaged over each bin: what carries the stress
/// there, exactly.
class Above {
 public:
  explicit Above(double total) : total_(total) {}

  /// The next bin upwards.
  void add(double density, double offset, double width) {
    above_.push_back(total_ - below_ - (0.5 * density * width - offset));
    below_ += density * width;
  }
  double operator()(std::ptrdiff_t bin) const {
    if (bin < 0) return total_;
    const auto k = static_cast<std::size_t>(bin);
    return k < above_.size() ? above_[k] : total_ - below_;  // beyond all bins
  }

 private:
  std::vector<double> above_;
  double total_;
  double below_ = 0.0;
};

using FourAbove = std::array<Above, 4>;  // mass, wall force x y z

FourAbove everything_above(const std::vector<BinMoments>& bins, double width, double mass) {
  std::array<double, 3> force{};
  for (const BinMoments& bin : bins) {
    for (std::size_t a = 0; a < 3; ++a) force[a] += bin.wall_force[a] * width;
  }
  FourAbove above{Above(mass), Above(force[0]), Above(force[1]), Above(force[2])};
  for (const BinMoments& bin : bins) {
    above[0].add(bin.mass, bin.mass_offset, width);
    for (std::size_t a = 0; a < 3; ++a) {
      above[a + 1].add(bin.wall_force[a], bin.wall_force_offset[a], width);
    }
  }
  return above;
}

/// Everything smoothed, in fine bins.
struct Smoothed {
  std::vector<BinMoments> moments;
  std::vector<SlidingMoments> sliding;
  std::vector<Symmetric> kinetic_stress;
  std::vector<std::array<double, 4>> above;  ///< mass, wall force x y z
};

std::vector<Symmetric> kinetic_stress(const Smoother& smoother,
                                      const std::vector<BinMoments>& bins,
                                      const std::vector<BinMoments>& smooth,
                                      double width) {
  std::vector<Symmetric> flux(bins.size());
  for (std::size_t k = 0; k < bins.size(); ++k) {
    if (!(bins[k].mass > 0.0)) continue;
    const BinMoments& around = smooth[smoother.place(k)];
    flux[k] = flux_about(velocity_line(around, width, smoother.homogeneous()), bins[k]);
  }
  return smoother.smooth(flux, [](Symmetric& sum, const Symmetric& f, double, double share) {
    add_flux(sum, f, share);
  });
}

Smoothed smoothed(const Smoother& smoother,
                  const FrameMoments& moments,
                  const ProfileFrames& grid,
                  double total_mass) {
  Smoothed result;
  result.moments = smoother.smooth(moments.bins, add_shifted);
  result.sliding = smoother.smooth(
      moments.sliding, [](SlidingMoments& sum, const SlidingMoments& s, double, double share) {
        add_scaled(sum, s, share);
      });
  result.kinetic_stress = kinetic_stress(smoother, moments.bins, result.moments, grid.bin_width);
  const FourAbove above = everything_above(moments.bins, grid.bin_width, total_mass);
  result.above.resize(smoother.size());
  for (std::size_t i = 0; i < smoother.size(); ++i) {
    smoother.gather(i, true, [&](std::ptrdiff_t bin, double, double share) {
      for (std::size_t a = 0; a < 4; ++a) result.above[i][a] += share * above[a](bin);
    });
  }
  return result;
}

/// The bins of one row together.
struct Row {
  BinMoments moments;
  SlidingMoments sliding;
  Symmetric kinetic_stress{};
  std::array<double, 4> above{};
};

Row row_of(const Smoother& smoother,
           const Smoothed& fields,
           const ProfileFrames& grid,
           std::size_t row) {
  const std::size_t n = grid.bins_per_row;
  double whole = 0.0;
  for (std::size_t q = 0; q < n; ++q) whole += smoother.weight(row * n + q);
  Row sum;
  for (std::size_t q = 0; q < n && whole > 0.0; ++q) {
    const std::size_t i = row * n + q;
    const double share = smoother.weight(i) / whole;
    const double shift =
        (static_cast<double>(q) + 0.5 - 0.5 * static_cast<double>(n)) * grid.bin_width;
    add_shifted(sum.moments, fields.moments[i], shift, share);
    add_flux(sum.kinetic_stress, fields.kinetic_stress[i], share);
    if (!fields.sliding.empty()) add_scaled(sum.sliding, fields.sliding[i], share);
    for (std::size_t a = 0; a < 4; ++a) {
      sum.above[a] += fields.above[i][a] / static_cast<double>(n);
    }
  }
  return sum;
}

/// Components of stress in the order xx yy zz xy xz yz, of which a flow makes its friction.
struct Components {
  std::size_t normal, shear, gradient;
};
Components components(const ChuteConditions& conditions) {
  const bool box = conditions.geometry == "simple_shear" || conditions.geometry == "body_force_box";
  return box ? Components{1, 3, 1} : Components{2, 4, 2};
}

void add_stresses(FieldRow& field, const Row& row, const ChuteConditions& c) {
  const auto total = [&](std::size_t k) {
    return row.moments.contact_stress[k] + row.kinetic_stress[k];
  };
  const Components at = components(c);
  field.contact_stress = row.moments.contact_stress;
  field.kinetic_stress = row.kinetic_stress;
  field.shear_stress = -total(at.shear);
  field.normal_stress = total(at.normal);
  field.pressure = (total(0) + total(1) + total(2)) / 3.0;
  field.temperature = (row.kinetic_stress[0] + row.kinetic_stress[1] + row.kinetic_stress[2]) /
                      (3.0 * row.moments.mass);
  field.inertial_number =
      field.shear_rate * c.grain_diameter * std::sqrt(c.grain_density / field.normal_stress);
  field.softness = field.normal_stress * c.grain_diameter / c.stiffness;
  field.friction = field.shear_stress / field.normal_stress;
}

void add_contacts(FieldRow& field, const Row& row, bool slides) {
  const BinMoments& bin = row.moments;
  field.coordination = bin.contacts / bin.grains;
  field.dissipation = bin.dissipation / bin.contact_points;
  field.sliding_share = slides ? row.sliding.contact_points / bin.contact_points : nan;
  field.sliding_dissipation = slides ? row.sliding.dissipation / bin.dissipation : nan;
  for (std::size_t k = 0; k < 6; ++k) field.fabric[k] = bin.fabric[k] / bin.contacts;
}

FieldRow field_row(const Row& row,
                   const ProfileFrames& grid,
                   bool homogeneous,
                   bool slides,
                   const ChuteConditions& c) {
  const VelocityLine line = velocity_line(row.moments, grid.bin_width, homogeneous);
  FieldRow field;
  field.velocity = line.value[0];
  field.shear_rate = c.shear_rate != 0.0 ? c.shear_rate : line.slope[0];
  field.volume_fraction = row.moments.mass / c.grain_density;
  field.mass_above = row.above[0];
  for (std::size_t a = 0; a < 3; ++a) field.wall_force_above[a] = row.above[a + 1];
  field.density = row.moments.mass;
  field.momentum = row.moments.momentum;
  field.velocity_gradient = line.slope;
  if (c.shear_rate != 0.0) field.velocity_gradient[0] = c.shear_rate;
  field.wall_force = row.moments.wall_force;
  add_stresses(field, row, c);
  add_contacts(field, row, slides);
  return field;
}

}  // namespace

FrameMoments mean_moments(std::span<const ProfileFrame> frames) {
  if (frames.empty()) return {};
  FrameMoments mean;
  mean.bins.resize(frames.front().bins.size());
  mean.sliding.resize(frames.front().sliding.size());
  double samples = 0.0;
  for (const ProfileFrame& frame : frames) samples += frame.samples;
  for (const ProfileFrame& frame : frames) {
    const double share = frame.samples / samples;
    for (std::size_t k = 0; k < mean.bins.size(); ++k) {
      add_scaled(mean.bins[k], frame.bins[k], share);
    }
    for (std::size_t k = 0; k < mean.sliding.size(); ++k) {
      add_scaled(mean.sliding[k], frame.sliding[k], share);
    }
  }
  return mean;
}

std::size_t margin_rows(const ProfileFrames& grid, const Kernel& kernel) {
  if (grid.periodic) return 0;
  const std::size_t reach = bin_shares(kernel, grid.bin_width).size() / 2;
  return (reach + grid.bins_per_row - 1) / grid.bins_per_row;
}

std::vector<FieldRow> coarse_grain(const FrameMoments& moments,
                                   const ProfileFrames& grid,
                                   const Kernel& kernel,
                                   const ChuteConditions& conditions) {
  const bool radial = conditions.geometry == "split_bottom";
  const Smoother smoother(grid, kernel, moments.bins.size(), radial);
  const Smoothed fields = smoothed(smoother, moments, grid, conditions.mass_per_area);
  std::vector<FieldRow> rows;
  for (std::size_t k = 0; (k + 1) * grid.bins_per_row <= smoother.size(); ++k) {
    rows.push_back(field_row(row_of(smoother, fields, grid, k),
                             grid,
                             smoother.homogeneous(),
                             !moments.sliding.empty(),
                             conditions));
  }
  return rows;
}

}  // namespace grainlaw::dem
