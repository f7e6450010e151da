#include "dem/coarse_graining.h"

namespace grainlaw::dem {
namespace {

constexpr double spin_inertia = 0.4;  // I / (m R^2) of a solid sphere

Vec3 mean_velocity(const Particles& particles, const Dynamics& dynamics) {
  double mass = 0.0;
  Vec3 momentum;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const double m = 1.0 / particles.state[i].inverse_mass;
    mass += m;
    momentum += m * velocity(particles, i, dynamics);
  }
  return mass > 0.0 ? 1.0 / mass * momentum : Vec3{};
}

/// The vector in the axes of the profile at a place.
Vec3 seen(const Bins& bins, const Vec3& place, const Vec3& v) {
  return bins.axis == ProfileAxis::radius ? cylindrical(place, v) : v;
}

}  // namespace

Vec3 cylindrical(const Vec3& place, const Vec3& v) {
  const double r = std::sqrt(place.x * place.x + place.y * place.y);  // hypot is slow
  const Vec3 radial{place.x / r, place.y / r, 0.0};
  const Vec3 azimuthal{-radial.y, radial.x, 0.0};
  return {dot(v, azimuthal), v.z, dot(v, radial)};
}

double Bins::coordinate(const Vec3& position) const {
  if (axis == ProfileAxis::z) return position.z;
  return axis == ProfileAxis::y ? position.y
                                : std::sqrt(position.x * position.x + position.y * position.y);
}

FrameSampler::FrameSampler(std::size_t bins, bool friction) {
  frame_.bins.resize(bins);
  if (friction) frame_.sliding.resize(bins);
}

void FrameSampler::sample(const Bins& bins,
                          const Particles& particles,
                          const Dynamics& dynamics,
                          const std::vector<ContactSample>& contacts) {
  const double extent = bins.width * static_cast<double>(bins.count);
  const double middle = bins.begin + 0.5 * extent;
  // A force that does not add up to zero over the grains makes a periodic box drift as a whole,
  // which nothing in it feels: velocities are those against its mean.
  const Vec3 drift = bins.periodic ? mean_velocity(particles, dynamics) : Vec3{};
  double place = 0.0;
  double energy = 0.0;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const GrainState& grain = particles.state[i];
    const double mass = 1.0 / grain.inverse_mass;
    Vec3 v = velocity(particles, i, dynamics) - drift;
    v.x -= bins.shear_rate * (grain.position.y - middle);
    add_grain(bins, grain.position, seen(bins, grain.position, v), mass);
    place += grain.position.z;
    energy += 0.5 * mass * square(v);
    if (particles.rotates()) {
      energy += 0.5 * spin_inertia * mass * square(spin(particles, i, dynamics));
    }
  }
  const auto grains = static_cast<double>(std::max<std::size_t>(1, particles.mobile));
  frame_.centre_of_mass += bins.periodic ? middle : place / grains;
  frame_.kinetic_energy += energy / grains;
  for (const ContactSample& contact : contacts) add_contact(bins, particles, contact);
  ++frame_.samples;
}

void FrameSampler::add_grain(const Bins& bins, const Vec3& position, const Vec3& v, double mass) {
  const double at = bins.coordinate(position);
  share_stretch(bins, at, at, [&](std::size_t k, double) {
    BinMoments& bin = frame_.bins[k];
    const double extent = bins.width * static_cast<double>(bins.count);
    double offset = at - bins.centre(k);
    if (bins.periodic) offset -= extent * std::round(offset / extent);
    const double density = mass / bins.volume(k);
    bin.mass += density;
    bin.grains += 1.0 / bins.volume(k);
    add_vector(bin.momentum, v, density);
    add_dyad(bin.momentum_flux, v, v, density);
    bin.mass_offset += density * offset;
    bin.mass_offset_squared += density * offset * offset;
    add_vector(bin.momentum_offset, v, density * offset);
  });
}

void FrameSampler::add_contact(const Bins& bins,
                               const Particles& particles,
                               const ContactSample& contact) {
  const bool frozen = particles.state[contact.second].inverse_mass == 0.0;
  const GrainState& first = particles.state[contact.first];
  const double radius_sum = first.radius + particles.state[contact.second].radius;
  const Vec3 point = first.position - first.radius / radius_sum * contact.branch;
  const Vec3 end = frozen ? point : first.position - contact.branch;
  const double s1 = bins.coordinate(first.position);
  const double s2 = bins.coordinate(end);
  const double at = bins.coordinate(point);
  const Vec3 middle = 0.5 * (first.position + end);
  const Vec3 force = seen(bins, middle, contact.force);
  const Vec3 arm = seen(bins, middle, first.position - end);
  share_stretch(bins, s1, s2, [&](std::size_t k, double share) {
    add_tensor(frame_.bins[k].contact_stress, force, arm, share / bins.volume(k));
  });
  if (frozen) {
    share_stretch(bins, at, at, [&](std::size_t k, double) {
      const double density = 1.0 / bins.volume(k);
      add_vector(frame_.bins[k].wall_force, force, density);
      add_vector(frame_.bins[k].wall_force_offset, force, density * (at - bins.centre(k)));
    });
  }
  if (square(contact.branch) >= radius_sum * radius_sum) return;  // a pull across a gap
  const double square_arm = square(arm);
  const auto count = [&](std::size_t k, double) {
    const double density = 1.0 / bins.volume(k);
    frame_.bins[k].contacts += density;
    add_dyad(frame_.bins[k].fabric, arm, arm, density / square_arm);
  };
  share_stretch(bins, s1, s1, count);
  if (!frozen) share_stretch(bins, s2, s2, count);
  count_contact(bins, at, contact);
}

void FrameSampler::count_contact(const Bins& bins, double point, const ContactSample& contact) {
  share_stretch(bins, point, point, [&](std::size_t k, double) {
    const double density = 1.0 / bins.volume(k);
    frame_.bins[k].contact_points += density;
    frame_.bins[k].dissipation += density * contact.dissipation;
    if (frame_.sliding.empty() || contact.sliding_dissipation == 0.0) return;
    frame_.sliding[k].contact_points += density;
    frame_.sliding[k].dissipation += density * contact.sliding_dissipation;
  });
}

ProfileFrame FrameSampler::finish() {
  const double per_sample = 1.0 / std::max(1, frame_.samples);
  const std::size_t count = frame_.bins.size();
  ProfileFrame frame{.samples = frame_.samples,
                     .centre_of_mass = frame_.centre_of_mass * per_sample,
                     .kinetic_energy = frame_.kinetic_energy * per_sample,
                     .bins = std::vector<BinMoments>(count),
                     .sliding = std::vector<SlidingMoments>(frame_.sliding.size())};
  for (std::size_t k = 0; k < count; ++k) add_scaled(frame.bins[k], frame_.bins[k], per_sample);
  for (std::size_t k = 0; k < frame.sliding.size(); ++k) {
    add_scaled(frame.sliding[k], frame_.sliding[k], per_sample);
  }
  frame_ = {.bins = std::vector<BinMoments>(count),
            .sliding = std::vector<SlidingMoments>(frame.sliding.size())};
  return frame;
}

}  // namespace grainlaw::dem
