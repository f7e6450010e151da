#include "dem/coarse_graining.h"

namespace grainlaw::dem {
namespace {

constexpr double spin_inertia = 0.4;  // I / (m R^2) of a solid sphere

void add_dyad(std::array<double, 6>& sum, const Vec3& a, const Vec3& b, double factor) {
  sum[0] += factor * a.x * b.x;
  sum[1] += factor * a.y * b.y;
  sum[2] += factor * a.z * b.z;
  sum[3] += factor * a.x * b.y;
  sum[4] += factor * a.x * b.z;
  sum[5] += factor * a.y * b.z;
}

}  // namespace

FrameSampler::FrameSampler(const Bins& bins) : bins_(bins) {
  frame_.bins.resize(bins.count);
}

void FrameSampler::sample(const Particles& particles,
                          const Dynamics& dynamics,
                          const std::vector<ContactSample>& contacts) {
  double height = 0.0;
  double energy = 0.0;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const Vec3 position = particles.state[i].position;
    const Vec3 v = velocity(particles, i, dynamics);
    add_grain(position, v, dynamics.mass);
    height += position.z;
    energy += 0.5 * dynamics.mass * square(v);
    if (!particles.half_spin.empty()) {
      energy += 0.5 * spin_inertia * dynamics.mass * square(spin(particles, i, dynamics));
    }
  }
  const auto grains = static_cast<double>(particles.mobile);
  frame_.centre_of_mass += height / grains;
  frame_.kinetic_energy += energy / grains;
  for (const ContactSample& contact : contacts) add_contact(particles, contact);
  ++frame_.samples;
}

void FrameSampler::add_grain(const Vec3& position, const Vec3& v, double mass) {
  share_stretch(bins_, position.z, position.z, [&](std::size_t k, double) {
    BinMoments& bin = frame_.bins[k];
    const double offset = position.z - bins_.centre(k);
    bin.mass += mass;
    bin.momentum[0] += mass * v.x;
    bin.momentum[1] += mass * v.y;
    bin.momentum[2] += mass * v.z;
    add_dyad(bin.momentum_flux, v, v, mass);
    bin.mass_offset += mass * offset;
    bin.mass_offset_squared += mass * offset * offset;
    bin.momentum_offset += mass * offset * v.x;
  });
}

void FrameSampler::add_contact(const Particles& particles, const ContactSample& contact) {
  const bool frozen = contact.second >= particles.mobile;
  const Vec3 branch = frozen ? 0.5 * contact.branch : contact.branch;
  const double z1 = particles.state[contact.first].position.z;
  const double z2 = z1 - branch.z;
  share_stretch(bins_, z1, z2, [&](std::size_t k, double share) {
    add_dyad(frame_.bins[k].contact_stress, contact.force, branch, share);
  });
  const auto count = [&](std::size_t k, double) { frame_.bins[k].contacts += 1.0; };
  share_stretch(bins_, z1, z1, count);
  if (!frozen) share_stretch(bins_, z2, z2, count);
}

ProfileFrame FrameSampler::finish() {
  const double per_sample = 1.0 / std::max(1, frame_.samples);
  ProfileFrame frame{.samples = frame_.samples,
                     .centre_of_mass = frame_.centre_of_mass * per_sample,
                     .kinetic_energy = frame_.kinetic_energy * per_sample,
                     .bins = std::vector<BinMoments>(bins_.count)};
  for (std::size_t k = 0; k < bins_.count; ++k) {
    add_scaled(frame.bins[k], frame_.bins[k], per_sample / bins_.volume());
  }
  frame_ = {.bins = std::vector<BinMoments>(bins_.count)};
  return frame;
}

}  // namespace grainlaw::dem
