#include "dem/ring_sampler.h"

namespace grainlaw::dem {
namespace {

std::size_t margin_rows(const RingBins& bins) {
  const std::size_t reach = bin_shares(bins.kernel, bins.radial.width).size() / 2;
  return (reach + bins.bins_per_row - 1) / bins.bins_per_row;
}

RingGrid grid_of(const RingBins& bins) {
  const std::size_t margin = margin_rows(bins);
  const double width = bins.radial.width * static_cast<double>(bins.bins_per_row);
  const double reach = static_cast<double>(margin) * width;
  return {.wedge = bins.wedge,
          .r_begin = bins.radial.begin - reach,
          .z_begin = bins.axial.begin - reach,
          .width = width,
          .columns = bins.radial.count / bins.bins_per_row + 2 * margin,
          .rows = bins.axial.count / bins.bins_per_row + 2 * margin,
          .kernel = bins.kernel};
}

/// Calls add(bin of r, bin of z, share) for every fine bin that the way from one place (r, z) to
/// another meets. The way is straight in r and z.
template <class Add>
void share_way(const RingBins& bins, double r1, double z1, double r2, double z2, Add&& add) {
  const auto radius_at = [&](double z) {
    return z2 == z1 ? r1 : r1 + (r2 - r1) * (z - z1) / (z2 - z1);
  };
  const double low = std::min(z1, z2), high = std::max(z1, z2);
  share_stretch(bins.axial, z1, z2, [&](std::size_t k, double axial_share) {
    const double begin = bins.axial.begin + static_cast<double>(k) * bins.axial.width;
    const double a = radius_at(std::clamp(begin, low, high));
    const double b = z2 == z1 ? r2 : radius_at(std::clamp(begin + bins.axial.width, low, high));
    share_stretch(bins.radial, a, b, [&](std::size_t i, double radial_share) {
      add(i, k, axial_share * radial_share);
    });
  });
}

double radius(const Vec3& place) {
  return std::sqrt(place.x * place.x + place.y * place.y);  // hypot is slow
}

}  // namespace

RingSampler::RingSampler(const RingBins& bins)
    : bins_(bins),
      grid_(grid_of(bins)),
      radial_shares_(shares(bins.radial)),
      axial_shares_(shares(bins.axial)),
      fine_(bins.radial.count * bins.axial.count) {}

std::vector<std::vector<RingSampler::Share>> RingSampler::shares(const Bins& bins) const {
  const std::vector<double> kernel = bin_shares(bins_.kernel, bins.width);
  const std::size_t per_row = bins_.bins_per_row;
  const std::size_t first = margin_rows(bins_) * per_row - kernel.size() / 2;
  std::vector<std::vector<Share>> all(bins.count);
  for (std::size_t bin = 0; bin < bins.count; ++bin) {
    for (std::size_t m = 0; m < kernel.size(); ++m) {
      const std::size_t row = (first + bin + m) / per_row;
      if (all[bin].empty() || all[bin].back().row != row) {
        const double rows = static_cast<double>(row) - static_cast<double>(margin_rows(bins_));
        const double centre = bins.begin + (rows + 0.5) * grid_.width;
        all[bin].push_back({row, 0.0, bins.centre(bin) - centre});
      }
      all[bin].back().share += kernel[m];
    }
  }
  return all;
}

void RingSampler::sample(const Particles& particles,
                         const Dynamics& dynamics,
                         const std::vector<ContactSample>& contacts) {
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const Vec3& place = particles.state[i].position;
    const Vec3 v = cylindrical(place, velocity(particles, i, dynamics));
    add_grain(place, v, 1.0 / particles.state[i].inverse_mass);
  }
  for (const ContactSample& contact : contacts) add_contact(particles, contact);
  ++samples_;
}

void RingSampler::add_grain(const Vec3& position, const Vec3& v, double mass) {
  const double r = radius(position);
  share_way(bins_, r, position.z, r, position.z, [&](std::size_t i, std::size_t k, double) {
    CellMoments& cell = fine_[k * bins_.radial.count + i];
    const double offset_r = r - bins_.radial.centre(i);
    const double offset_z = position.z - bins_.axial.centre(k);
    cell.mass += mass;
    cell.grains += 1.0;
    add_vector(cell.momentum, v, mass);
    add_dyad(cell.momentum_flux, v, v, mass);
    cell.mass_offset[0] += mass * offset_r;
    cell.mass_offset[1] += mass * offset_z;
    cell.mass_offset_square[0] += mass * offset_r * offset_r;
    cell.mass_offset_square[1] += mass * offset_z * offset_z;
    cell.mass_offset_square[2] += mass * offset_r * offset_z;
    add_vector(cell.momentum_offset_r, v, mass * offset_r);
    add_vector(cell.momentum_offset_z, v, mass * offset_z);
  });
}

void RingSampler::add_contact(const Particles& particles, const ContactSample& contact) {
  const GrainState& first = particles.state[contact.first];
  const bool frozen = particles.state[contact.second].inverse_mass == 0.0;
  const double radius_sum = first.radius + particles.state[contact.second].radius;
  const Vec3 arm = (frozen ? first.radius / radius_sum : 1.0) * contact.branch;
  const Vec3 end = first.position - arm;
  const Vec3 middle = 0.5 * (first.position + end);
  const Vec3 force_seen = cylindrical(middle, contact.force);
  const Vec3 arm_seen = cylindrical(middle, arm);
  const double r1 = radius(first.position), z1 = first.position.z;
  const double r2 = radius(end), z2 = end.z;
  share_way(bins_, r1, z1, r2, z2, [&](std::size_t i, std::size_t k, double share) {
    add_tensor(fine_[k * bins_.radial.count + i].contact_stress, force_seen, arm_seen, share);
  });
  if (square(contact.branch) >= radius_sum * radius_sum) return;  // a pull across a gap
  const auto count = [&](std::size_t i, std::size_t k, double) {
    fine_[k * bins_.radial.count + i].contacts += 1.0;
  };
  share_way(bins_, r1, z1, r1, z1, count);
  if (!frozen) share_way(bins_, r2, z2, r2, z2, count);
}

void RingSampler::spread(std::size_t radial,
                         std::size_t axial,
                         std::vector<CellMoments>& cells) const {
  const CellMoments& bin = fine_[axial * bins_.radial.count + radial];
  for (const Share& z : axial_shares_[axial]) {
    for (const Share& r : radial_shares_[radial]) {
      const double share = r.share * z.share / std::max(1, samples_);
      add_cell(cells[grid_.index(r.row, z.row)], bin, r.shift, z.shift, share);
    }
  }
}

RingFrame RingSampler::finish() {
  RingFrame frame{.samples = samples_, .cells = std::vector<CellMoments>(grid_.size())};
  for (std::size_t k = 0; k < bins_.axial.count; ++k) {
    for (std::size_t i = 0; i < bins_.radial.count; ++i) spread(i, k, frame.cells);
  }
  fine_.assign(fine_.size(), {});
  samples_ = 0;
  return frame;
}

}  // namespace grainlaw::dem
