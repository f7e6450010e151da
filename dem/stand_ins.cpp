#include "dem/stand_ins.h"

#include <algorithm>
#include <cmath>

namespace grainlaw::dem {
namespace {

/// Distances of a point from the faces at angle 0 and at angle `wedge`.
double above_first_face(const Vec3& p) {
  return p.y;
}
double below_last_face(const Vec3& p, double wedge) {
  return std::sin(wedge) * p.x - std::cos(wedge) * p.y;
}

/// About z by one angle after the other, which are all that of the wedge, either way: its sine and
/// cosine are taken once.
class Turn {
 public:
  Vec3 operator()(const Vec3& v, double angle) {
    if (std::abs(angle) != size_) {
      size_ = std::abs(angle);
      cosine_ = std::cos(size_);
      sine_ = std::sin(size_);
    }
    return turned(v, cosine_, angle < 0.0 ? -sine_ : sine_);
  }

 private:
  double size_ = 0.0;
  double cosine_ = 1.0;
  double sine_ = 0.0;
};

}  // namespace

void StandIns::list(Particles& particles,
                    const Box& box,
                    const std::vector<Wall>& walls,
                    double reach) {
  image_of.clear(), image_angle.clear(), foot_of.clear(), foot_on.clear();
  double largest = 0.0;
  for (std::size_t i = 0; i < particles.real; ++i) {
    largest = std::max(largest, particles.state[i].radius);
  }
  // A pair across a face is listed once, as a grain at the first face and an image of its partner
  // at the last; a frozen partner has no row of its own and needs an image on both sides.
  for (std::uint32_t i = 0; box.wedge > 0.0 && i < particles.real; ++i) {
    const GrainState& grain = particles.state[i];
    const double near = grain.radius + largest + reach;
    const auto add = [&](double angle) {
      image_of.push_back(i);
      image_angle.push_back(angle);
    };
    if (below_last_face(grain.position, box.wedge) < near) add(-box.wedge);
    if (i >= particles.mobile && above_first_face(grain.position) < near) add(box.wedge);
  }
  for (std::uint32_t i = 0; !walls.empty() && i < particles.mobile; ++i) {
    const GrainState& grain = particles.state[i];
    for (std::uint32_t w = 0; w < walls.size(); ++w) {
      if (walls[w].distance(grain.position) >= grain.radius + reach) continue;
      foot_of.push_back(i);
      foot_on.push_back(w);
    }
  }
}

void StandIns::append(Particles& particles, const std::vector<Wall>& walls) const {
  const std::size_t all = particles.real + size();
  particles.state.resize(all);
  particles.id.resize(all);
  if (particles.rotates()) particles.spin.resize(all);
  std::size_t at = particles.real;
  for (const std::uint32_t owner : image_of) {
    particles.state[at].radius = particles.state[owner].radius;
    particles.state[at].inverse_mass = particles.state[owner].inverse_mass;
    particles.id[at++] = particles.id[owner];
  }
  for (const std::uint32_t wall : foot_on) {
    particles.state[at] = {};
    if (particles.rotates()) {
      particles.spin[at] = {.velocity = {}, .grip = walls[wall].frictional ? 0.5 : -0.5};
    }
    particles.id[at++] = first_wall_id + wall;
  }
  update(particles, walls);
}

void StandIns::update(Particles& particles, const std::vector<Wall>& walls) const {
  Turn turn;
  std::size_t at = particles.real;
  for (std::size_t k = 0; k < image_of.size(); ++k, ++at) {
    const std::uint32_t owner = image_of[k];
    const GrainState& grain = particles.state[owner];
    particles.state[at].position = turn(grain.position, image_angle[k]);
    particles.state[at].velocity = turn(grain.velocity, image_angle[k]);
    if (!particles.rotates()) continue;
    particles.spin[at] = particles.spin[owner];
    particles.spin[at].velocity = turn(particles.spin[owner].velocity, image_angle[k]);
  }
  for (std::size_t k = 0; k < foot_of.size(); ++k, ++at) {
    const Wall& wall = walls[foot_on[k]];
    particles.state[at].position = wall.foot(particles.state[foot_of[k]].position);
    particles.state[at].velocity = wall.velocity(particles.state[at].position);
  }
}

void StandIns::return_loads(Particles& particles) const {
  Turn turn;
  std::size_t at = particles.real;
  for (std::size_t k = 0; k < image_of.size(); ++k, ++at) {
    GrainLoad& own = particles.load[image_of[k]];
    own.force += turn(particles.load[at].force, -image_angle[k]);
    own.torque += turn(particles.load[at].torque, -image_angle[k]);
    particles.load[at] = {};
  }
}

}  // namespace grainlaw::dem
