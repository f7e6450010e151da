#include <cstring>

#include "dem/simulation.h"

namespace grainlaw::dem {
namespace {

template <class Record>
std::vector<double> numbers_of(const std::vector<Record>& records, std::size_t count) {
  static_assert(sizeof(Record) % sizeof(double) == 0);
  std::vector<double> numbers(count * sizeof(Record) / sizeof(double));
  if (count > 0) std::memcpy(numbers.data(), records.data(), count * sizeof(Record));
  return numbers;
}

template <class Record>
void restore_records(std::vector<Record>& records,
                     std::size_t count,
                     const Checkpoint& from,
                     const std::string& name) {
  const auto& numbers = entry(from.numbers, name, count * sizeof(Record) / sizeof(double));
  if (records.size() < count) records.resize(count);
  if (count > 0)
    std::memcpy(static_cast<void*>(records.data()), numbers.data(), count * sizeof(Record));
}

template <class Integer>
std::vector<std::int64_t> integers_of(const std::vector<Integer>& values) {
  return {values.begin(), values.end()};
}
template <class Integer>
std::vector<Integer> narrowed(const std::vector<std::int64_t>& values) {
  std::vector<Integer> result;
  for (const std::int64_t value : values) result.push_back(static_cast<Integer>(value));
  return result;
}

template <class V, class Visit>
void for_components(V& v, Visit&& visit) {
  visit(v.x), visit(v.y), visit(v.z);
}

/// The scalars of the moving boundaries and of the field that changes with them, one list for
/// writing and reading.
template <class Drive, class Field, class Visit>
void for_boundary_numbers(Drive& drive, Field& field, Visit&& visit) {
  if (auto* box = std::get_if<BoxDrive>(&drive)) {
    visit(box->height_rate), visit(box->height_acceleration);
  } else if (auto* wall = std::get_if<WallDrive>(&drive)) {
    visit(wall->rise), visit(wall->acceleration);
  }
  if (auto* uniform = std::get_if<Uniform>(&field)) {
    for_components(uniform->acceleration, visit);
  } else if (auto* sine = std::get_if<Sine>(&field)) {
    visit(sine->wave_number), visit(sine->mean), visit(sine->strain_rate);
    visit(sine->strain_rate_rate), visit(sine->middle);
  } else if (auto* affine = std::get_if<Affine>(&field)) {
    visit(affine->strain_rate), visit(affine->strain_rate_rate), visit(affine->middle);
  }
}

}  // namespace

template <class Visit>
void SimulationBase::for_scalars(Visit&& visit) {
  for_components(box_.period, visit);
  visit(box_.offset);
  for_components(box_.top_velocity, visit);
  for_boundary_numbers(setup_.drive, setup_.dynamics.field, visit);
  visit(frame_.velocity), visit(frame_.gradient), visit(fastest_frozen_);
  visit(closed_since_rebuild_), visit(closing_rate_), visit(stress_yy_), visit(largest_overlap_),
      visit(boundary_power_);
  for_components(first_moment_, visit);
  for_components(wrapped_, visit);
  visit(sums_.tangential_energy);
  visit(ledger_.initial_energy), visit(ledger_.normal_dashpot), visit(ledger_.tangential_dashpot);
  visit(ledger_.slip), visit(ledger_.spring_lost), visit(ledger_.prefactor_work);
  visit(ledger_.bridge_lost), visit(ledger_.field_work), visit(ledger_.boundary_work);
}

void SimulationBase::save_base(Checkpoint& to) {
  const std::size_t real = particles_.real;
  const std::size_t mobile = particles_.mobile;
  to.numbers["grains/state"] = numbers_of(particles_.state, real);
  to.numbers["grains/load"] = numbers_of(particles_.load, real);
  to.numbers["grains/half_step"] = numbers_of(particles_.half, mobile);
  if (particles_.rotates()) {
    to.numbers["grains/spin"] = numbers_of(particles_.spin, real);
    to.numbers["grains/half_spin"] = numbers_of(particles_.half_spin, mobile);
  }
  to.integers["grains/id"] = std::vector<std::int64_t>(
      particles_.id.begin(), particles_.id.begin() + static_cast<std::ptrdiff_t>(real));
  std::vector<std::int64_t> body;
  for (const Body b : particles_.body) body.push_back(static_cast<std::int64_t>(b));
  to.integers["grains/body"] = std::move(body);

  std::vector<std::int64_t> row_begin, partner, acting;
  for (std::size_t i = 0; i <= mobile; ++i) row_begin.push_back(list_.row_begin(i));
  for (std::size_t k = 0; k < list_.pairs(); ++k) partner.push_back(list_.partners()[k].bits);
  for (const Strip& strip : strips_) {
    acting.insert(acting.end(),
                  strip.acting.pair.begin(),
                  strip.acting.pair.begin() + static_cast<std::ptrdiff_t>(strip.acting.count));
  }
  to.integers["pairs/row_begin"] = std::move(row_begin);
  to.integers["pairs/partner"] = std::move(partner);
  to.integers["pairs/acting"] = std::move(acting);
  if (!memory_.spring.empty()) {
    to.numbers["pairs/spring"] = numbers_of(memory_.spring, list_.pairs());
  }
  if (!memory_.bridge.empty()) to.integers["pairs/bridge"] = integers_of(memory_.bridge);
  to.integers["stand_ins/image_of"] = integers_of(stand_ins_.image_of);
  to.numbers["stand_ins/image_angle"] = stand_ins_.image_angle;
  to.integers["stand_ins/foot_of"] = integers_of(stand_ins_.foot_of);
  to.integers["stand_ins/foot_on"] = integers_of(stand_ins_.foot_on);

  std::vector<double> scalars;
  for_scalars([&](double& value) { scalars.push_back(value); });
  to.numbers["scalars"] = std::move(scalars);
  to.integers["counters"] = {steps_, rebuilds_, frame_.along_y};
}

void SimulationBase::restore_base(const Checkpoint& from) {
  const std::size_t real = particles_.real;
  const std::size_t mobile = particles_.mobile;
  restore_records(particles_.state, real, from, "grains/state");
  restore_records(particles_.load, real, from, "grains/load");
  restore_records(particles_.half, mobile, from, "grains/half_step");
  if (particles_.rotates()) {
    restore_records(particles_.spin, real, from, "grains/spin");
    restore_records(particles_.half_spin, mobile, from, "grains/half_spin");
  }
  particles_.id = narrowed<std::uint32_t>(entry(from.integers, "grains/id", real));
  const auto& body = entry(from.integers, "grains/body", real);
  for (std::size_t i = 0; i < real; ++i) particles_.body[i] = static_cast<Body>(body[i]);

  auto scalars = entry(from.numbers, "scalars");
  std::size_t at = 0;
  for_scalars([&](double& value) {
    if (at == scalars.size()) throw CheckpointError("the checkpoint has too few scalars");
    value = scalars[at++];
  });
  const auto& counters = entry(from.integers, "counters", 3);
  steps_ = counters[0];
  rebuilds_ = counters[1];
  frame_.along_y = counters[2] != 0;
  contacts_.shifts = box_.image_shifts();

  particles_.state.resize(real);
  if (particles_.rotates()) particles_.spin.resize(real);
  stand_ins_.image_of = narrowed<std::uint32_t>(entry(from.integers, "stand_ins/image_of"));
  stand_ins_.image_angle = entry(from.numbers, "stand_ins/image_angle", stand_ins_.image_of.size());
  stand_ins_.foot_of = narrowed<std::uint32_t>(entry(from.integers, "stand_ins/foot_of"));
  stand_ins_.foot_on =
      narrowed<std::uint32_t>(entry(from.integers, "stand_ins/foot_on", stand_ins_.foot_of.size()));
  stand_ins_.append(particles_, setup_.walls);
  restore_pairs(from);
}

void SimulationBase::restore_pairs(const Checkpoint& from) {
  std::vector<Partner> partners;
  for (const std::int64_t bits : entry(from.integers, "pairs/partner")) {
    partners.push_back({static_cast<std::uint32_t>(bits)});
  }
  list_.restore(
      narrowed<std::uint32_t>(entry(from.integers, "pairs/row_begin", particles_.mobile + 1)),
      std::move(partners));
  cut_into_strips();
  memory_.pairs = static_cast<std::uint32_t>(list_.pairs());
  if (!memory_.spring.empty()) {
    memory_.spring.assign(list_.pairs() + 1, {});
    restore_records(memory_.spring, list_.pairs(), from, "pairs/spring");
  }
  if (!memory_.bridge.empty()) {
    memory_.bridge =
        narrowed<std::uint8_t>(entry(from.integers, "pairs/bridge", list_.pairs() + 1));
  }
  const bool remembers = !memory_.active.empty();
  if (remembers) memory_.active.assign(list_.pairs() + pack_width, 0);
  const auto& acting = entry(from.integers, "pairs/acting");
  auto next = acting.begin();
  for (Strip& strip : strips_) {
    strip.acting.count = 0;
    for (; next != acting.end() && *next < list_.row_begin(strip.end); ++next) {
      const auto pair = static_cast<std::uint32_t>(*next);
      const std::size_t k = strip.acting.count++;
      strip.acting.reserve(strip.acting.count);
      strip.acting.first[k] = list_.first()[pair];
      strip.acting.partner[k] = list_.partners()[pair].bits;
      strip.acting.load[k] = load_of_pair_[pair];
      strip.acting.pair[k] = pair;
      if (remembers) memory_.active[pair] = 1;
    }
  }
}

}  // namespace grainlaw::dem
