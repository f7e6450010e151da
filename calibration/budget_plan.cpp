#include "calibration/budget_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace grainlaw::calibration {
namespace {

using continuum::RheologyTable;
using Places = std::vector<std::vector<double>>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Step of the forward differences, relative: their error is of its order, far below what a plan
/// can feel, and far above the rounding of the quadrature (1e-13).
constexpr double relative_step = 1e-5;

/// Standard error of a curvature that no data have told yet; see information_of.
constexpr double unknown_kappa = 4.0;

/// Every coordinate from 0 to 1; 0 where it does not vary.
Places scaled(const Places& places) {
  Places result = places;
  for (std::size_t c = 0; !places.empty() && c < places.front().size(); ++c) {
    const auto at = [c](const std::vector<double>& place) { return place.at(c); };
    const auto [low, high] = std::ranges::minmax(places, {}, at);
    const double span = high.at(c) - low.at(c);
    for (std::vector<double>& place : result) {
      place[c] = span > 0.0 ? (place[c] - low[c]) / span : 0.0;
    }
  }
  return result;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t c = 0; c < a.size(); ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(sum);
}

/// The first place of the pair that is farthest apart.
std::size_t first_of_farthest(const Places& places) {
  std::size_t first = 0;
  double farthest = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i + 1; j < places.size(); ++j) {
      const double apart = distance(places[i], places[j]);
      if (apart > farthest) {
        farthest = apart;
        first = i;
      }
    }
  }
  return first;
}

const continuum::MuPhi& law_of(const RheologyTable& table) {
  return std::get<continuum::MuPhi>(table.law);
}

double friction_at(const RheologyTable& table, const State& state) {
  const continuum::Confinement at{.softness = (1.0 + state.bond_number) * state.softness,
                                  .bond_number = state.bond_number};
  return continuum::friction(law_of(table), state.inertial_number, at);
}

/// The law could be curved, and the fit took it for straight.
bool left_out_kappa(const RheologyTable& table) {
  const auto& law = law_of(table).friction;
  return law.kappa == 0.0 && !law.exponent;
}

/// Forward differences of a number that follows from the table.
template <class Number>
std::vector<double> gradient(const RheologyTable& table,
                             const std::vector<std::string>& coefficients,
                             const Number& number) {
  std::vector<double> result;
  const double here = number(table);
  for (const std::string& name : coefficients) {
    const double value = continuum::coefficient(table, name);
    const double step = relative_step * std::max(std::abs(value), 1e-2);
    RheologyTable moved = table;
    continuum::set_coefficient(moved, name, value + step);
    result.push_back((number(moved) - here) / step);
  }
  return result;
}

}  // namespace

std::vector<std::size_t> spread_order(const Places& places) {
  const Places at = scaled(places);
  for (const auto& place : places) {
    if (place.size() != places.front().size()) throw std::invalid_argument("places differ in size");
  }
  std::vector<std::size_t> order;
  std::vector<double> nearest(at.size(), std::numeric_limits<double>::infinity());
  std::size_t next = at.empty() ? 0 : first_of_farthest(at);
  while (order.size() < at.size()) {
    order.push_back(next);
    for (std::size_t k = 0; k < at.size(); ++k) {
      nearest[k] = std::min(nearest[k], distance(at[k], at[next]));
    }
    for (const std::size_t chosen : order) nearest[chosen] = -1.0;  // not again
    next = static_cast<std::size_t>(std::ranges::max_element(nearest) - nearest.begin());
  }
  return order;
}

int varied_coordinates(const Places& places) {
  int varied = 0;
  for (std::size_t c = 0; !places.empty() && c < places.front().size(); ++c) {
    const auto differs = [&](const auto& place) { return place[c] != places.front()[c]; };
    varied += std::ranges::any_of(places, differs) ? 1 : 0;
  }
  return varied;
}

std::vector<std::string> friction_coefficients(const RheologyTable& table) {
  constexpr std::array<std::string_view, 8> of_friction{"mu0",
                                                        "beta",
                                                        "kappa",
                                                        "exponent",
                                                        "p_mu",
                                                        "cohesion_alpha",
                                                        "cohesion_beta",
                                                        "cohesion_factor"};
  std::vector<std::string> names;
  if (!table.covariance) return names;
  for (std::size_t k = 0; k < table.covariance->names.size(); ++k) {
    const std::string& name = table.covariance->names[k];
    const bool uncertain = (*table.covariance)(k, k) > 0.0;
    if (uncertain && std::ranges::find(of_friction, name) != of_friction.end()) {
      names.push_back(name);
    }
  }
  const bool has_kappa = std::ranges::find(names, "kappa") != names.end();
  if (!names.empty() && !has_kappa && left_out_kappa(table)) names.push_back("kappa");
  return names;
}

std::vector<double> friction_gradient(const RheologyTable& table,
                                      const std::vector<std::string>& coefficients,
                                      const State& state) {
  return gradient(
      table, coefficients, [&](const RheologyTable& law) { return friction_at(law, state); });
}

dem::Estimate surface_velocity(const RheologyTable& table, const continuum::ChuteCase& chute) {
  continuum::SteadyChute steady = continuum::steady_chute(table, chute);
  if (!continuum::flows(steady.answer.outcome) || steady.profile.rows.empty()) return {nan, nan};
  continuum::add_error_band(steady, table, chute);
  const continuum::ProfileRow& surface = steady.profile.rows.back();
  return {surface.velocity, surface.velocity_error};
}

std::vector<double> velocity_gradient(const RheologyTable& table,
                                      const std::vector<std::string>& coefficients,
                                      const continuum::ChuteCase& chute) {
  const auto log_velocity = [&](const RheologyTable& law) {
    const continuum::SteadyChute steady = continuum::steady_chute(law, chute);
    if (!continuum::flows(steady.answer.outcome) || steady.profile.rows.empty()) return nan;
    return std::log(steady.profile.rows.back().velocity);
  };
  std::vector<double> result = gradient(table, coefficients, log_velocity);
  if (!std::ranges::all_of(result, [](double value) { return std::isfinite(value); })) return {};
  return result;
}

double effective_friction_error(const RheologyTable& table,
                                const State& state,
                                double friction_error,
                                double inertial_number_error) {
  State moved = state;
  const double step = relative_step * state.inertial_number;
  moved.inertial_number += step;
  const double slope = (friction_at(table, moved) - friction_at(table, state)) / step;
  return std::hypot(friction_error, slope * inertial_number_error);
}

std::vector<double> information_of(const RheologyTable& table,
                                   const std::vector<std::string>& coefficients,
                                   std::span<const Observation> observations) {
  const std::size_t size = coefficients.size();
  std::vector<double> information(size * size, 0.0);
  for (std::size_t i = 0; i < size && left_out_kappa(table); ++i) {
    if (coefficients[i] == "kappa") information[i * size + i] = std::pow(unknown_kappa, -2);
  }
  for (const Observation& one : observations) {
    const std::vector<double> g = friction_gradient(table, coefficients, one.state);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        information[i * size + j] += g[i] * g[j] / (one.error * one.error);
      }
    }
  }
  return information;
}

std::size_t most_wanted(const RheologyTable& table,
                        const std::vector<std::string>& coefficients,
                        std::span<const Candidate> candidates,
                        std::span<const std::vector<double>> targets,
                        const std::vector<double>& known,
                        double seconds) {
  std::vector<Information> informations;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const double averaged = candidates[k].run - candidates[k].warm_up;
    if (!(averaged > 0.0)) continue;
    Information f = friction_gradient(table, coefficients, candidates[k].state);
    for (double& value : f) value *= std::sqrt(averaged / candidates[k].run) / candidates[k].noise;
    informations.push_back(std::move(f));
    places.push_back(k);
  }
  if (places.empty()) throw std::invalid_argument("no candidate can be run in this time");
  const Design design = v_optimal(informations, targets, known, seconds);
  return places[static_cast<std::size_t>(std::ranges::max_element(design.share) -
                                         design.share.begin())];
}

}  // namespace grainlaw::calibration
