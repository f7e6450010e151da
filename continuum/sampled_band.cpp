#include "continuum/sampled_band.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

namespace grainlaw::continuum {
namespace {

/// Standard normal numbers by Box and Muller 1958: unlike std::normal_distribution the same on
/// every machine.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : bits_(seed) {}
  double operator()() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }  // [0, 1)
  std::mt19937_64 bits_;
};

/// Lower triangle L with L L^T = covariance, row-major. A direction without variance has a column
/// of zeros: pivots below the rounding of a written covariance are taken as none.
std::vector<double> square_root(const Covariance& covariance) {
  constexpr double rounding = 1e-9;
  const std::size_t n = covariance.names.size();
  std::vector<double> root(n * n, 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    double pivot = covariance(j, j);
    for (std::size_t k = 0; k < j; ++k) pivot -= root[j * n + k] * root[j * n + k];
    if (!(pivot > rounding * covariance(j, j))) continue;
    root[j * n + j] = std::sqrt(pivot);
    for (std::size_t i = j + 1; i < n; ++i) {
      double sum = covariance(i, j);
      for (std::size_t k = 0; k < j; ++k) sum -= root[i * n + k] * root[j * n + k];
      root[i * n + j] = sum / root[j * n + j];
    }
  }
  return root;
}

RheologyTable draw(const RheologyTable& table, const std::vector<double>& root, Normal& normal) {
  const auto& names = table.covariance->names;
  const std::size_t n = names.size();
  std::vector<double> unit(n);
  for (double& x : unit) x = normal();
  RheologyTable drawn = table;
  drawn.covariance.reset();
  for (std::size_t i = 0; i < n; ++i) {
    double change = 0.0;
    for (std::size_t j = 0; j <= i; ++j) change += root[i * n + j] * unit[j];
    set_coefficient(drawn, names[i], coefficient(table, names[i]) + change);
  }
  return drawn;
}

/// Empty where the draw has no steady flow or leaves the laws.
Profile profile_of(const RheologyTable& drawn, const ChuteCase& chute) {
  try {
    return steady_chute(drawn, chute).profile;
  } catch (const TableError&) {
    return {};
  } catch (const std::invalid_argument&) {
    return {};  // the mass below the no-slip height exceeds that of the layer
  }
}

/// Cubic between rows, whose slopes are the shear rates; constant beyond them.
double velocity_at(const Profile& profile, double z) {
  const auto& rows = profile.rows;
  const auto above = std::ranges::lower_bound(rows, z, {}, &ProfileRow::z);
  if (above == rows.begin()) return rows.front().velocity;
  if (above == rows.end()) return rows.back().velocity;
  const ProfileRow& a = *(above - 1);
  const ProfileRow& b = *above;
  const double h = b.z - a.z;
  const double t = (z - a.z) / h;
  const double from_a = (1.0 + 2.0 * t) * a.velocity + t * h * a.shear_rate;
  const double from_b = (3.0 - 2.0 * t) * b.velocity - (1.0 - t) * h * b.shear_rate;
  return (1.0 - t) * (1.0 - t) * from_a + t * t * from_b;
}

/// Of sorted numbers, linear between them.
double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  const double next = sorted[std::min(i + 1, sorted.size() - 1)];
  return sorted[i] + (at - std::floor(at)) * (next - sorted[i]);
}

SampledVelocity statistics(double z, std::vector<double> velocities) {
  const auto n = static_cast<double>(velocities.size());
  double mean = 0.0;
  for (const double u : velocities) mean += u / n;
  double square = 0.0;
  for (const double u : velocities) square += (u - mean) * (u - mean);
  std::ranges::sort(velocities);
  return {.z = z,
          .deviation = std::sqrt(square / (n - 1.0)),
          .lower = quantile(velocities, 0.025),
          .upper = quantile(velocities, 0.975)};
}

/// Largest |ln(sampled / linear)| over the rows. A row below the surface whose linear band reaches
/// down to rest is left out, as velocities end there, and so is one whose scatter is that of
/// rounding.
double largest_disagreement(const SampledBand& band, const std::vector<ProfileRow>& rows) {
  double largest = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double scatter = std::max(band.rows[i].deviation, rows[i].velocity_error);
    const double speed = std::abs(rows[i].velocity);
    const bool at_rest = i + 1 < rows.size() && speed < 2.0 * rows[i].velocity_error;
    if (at_rest || scatter <= 1e-6 * speed) continue;
    largest =
        std::max(largest, std::abs(std::log(band.rows[i].deviation / rows[i].velocity_error)));
  }
  return largest;
}

std::string surface_text(const SampledBand& band, const ProfileRow& surface) {
  return fmt::format("surface velocity +- {:.3g} by {} draws, +- {:.3g} by linear propagation",
                     band.rows.back().deviation,
                     band.samples - band.without_flow,
                     surface.velocity_error);
}

std::string reason(const SampledBand& band, const ProfileRow& surface) {
  std::string text;
  if (band.without_flow > 0)
    text = fmt::format(
        "; {} of {} draws of the coefficients have no steady flow here, so a band "
        "about one is not the whole answer",
        band.without_flow,
        band.samples);
  const auto& sampled = band.rows.back();
  return text + fmt::format(
                    "; the velocity is not linear in the coefficients over their errors: 95 "
                    "% of the draws lie {:.3g} below to {:.3g} above the prediction",
                    surface.velocity - sampled.lower,
                    sampled.upper - surface.velocity);
}

void judge(SampledBand& band, const std::vector<ProfileRow>& rows) {
  const ProfileRow& surface = rows.back();
  const int flowing = band.samples - band.without_flow;
  if (flowing < 2) {
    band.agrees = false;
    band.text = fmt::format(
        "{} of {} draws of the coefficients have no steady flow here: the band "
        "says nothing",
        band.without_flow,
        band.samples);
    return;
  }
  const double noise = 4.0 / std::sqrt(2.0 * (flowing - 1));
  band.agrees = band.without_flow == 0 && largest_disagreement(band, rows) <= noise;
  band.text = surface_text(band, surface) +
              (band.agrees ? std::string(": they agree") : reason(band, surface));
}

}  // namespace

std::optional<SampledBand> sample_error_band(const SteadyChute& steady,
                                             const RheologyTable& table,
                                             const ChuteCase& chute,
                                             const BandSampling& sampling) {
  const auto& rows = steady.profile.rows;
  if (!table.covariance || rows.empty()) return std::nullopt;
  const std::vector<double> root = square_root(*table.covariance);
  Normal normal(sampling.seed);
  SampledBand band{.samples = sampling.samples, .rows = {}, .text = {}};
  std::vector<std::vector<double>> velocities(rows.size());
  for (int k = 0; k < sampling.samples; ++k) {
    const Profile profile = profile_of(draw(table, root, normal), chute);
    if (profile.rows.empty()) {
      ++band.without_flow;
      continue;
    }
    for (std::size_t i = 0; i < rows.size(); ++i)
      velocities[i].push_back(velocity_at(profile, rows[i].z));
  }
  if (band.samples - band.without_flow >= 2)
    for (std::size_t i = 0; i < rows.size(); ++i)
      band.rows.push_back(statistics(rows[i].z, std::move(velocities[i])));
  judge(band, rows);
  return band;
}

}  // namespace grainlaw::continuum
