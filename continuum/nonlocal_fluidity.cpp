#include "continuum/nonlocal_fluidity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "continuum/rheology_table.h"

namespace grainlaw::continuum {
namespace {

/// Couplings A^2 area / distance across the faces; those of the ends are 0 without a value there.
std::vector<double> couplings(const BandGrid& grid,
                              double amplitude,
                              bool first_given,
                              bool last_given) {
  std::vector<double> coupling;
  for (std::size_t i = 0; i <= grid.cells(); ++i)
    coupling.push_back(amplitude * amplitude * grid.area[i] / grid.distance[i]);
  if (!first_given) coupling.front() = 0.0;
  if (!last_given) coupling.back() = 0.0;
  return coupling;
}

/// A uniform g that the equation lowers everywhere: the largest local one, or that of an end.
double upper_bound(std::span<const FluidityTerms> terms, EndValue first, EndValue last) {
  double bound = std::max(first.value_or(0.0), last.value_or(0.0));
  for (const FluidityTerms& t : terms)
    if (t.gain > 0.0) bound = std::max(bound, t.gain / t.loss);
  return bound;
}

/// One Newton step, (C + 2 loss g - gain) g_new = loss g^2 + ends with C the couplings. The matrix
/// is an M-matrix above the solution, so no pivoting is needed, and what a row has beyond its
/// couplings is carried through the elimination instead of the diagonal: near the onset of flow the
/// couplings, (A / cell)^2, would otherwise drown it in rounding (Grassmann, Taksar & Heyman 1985).
class NewtonStep {
 public:
  NewtonStep(const BandGrid& grid,
             std::span<const FluidityTerms> terms,
             std::vector<double> coupling,
             EndValue first,
             EndValue last)
      : grid_(grid),
        terms_(terms),
        coupling_(std::move(coupling)),
        first_(first.value_or(0.0)),
        last_(last.value_or(0.0)),
        upper_(grid.cells()) {}

  /// False where a pivot is not positive: g was not above the solution.
  bool operator()(std::vector<double>& g) {
    const std::size_t n = g.size();
    bool valid = true;
    double share = 1.0;  // of the row before: its surplus over its diagonal
    for (std::size_t i = 0; i < n; ++i) {
      const double loss = terms_[i].loss * g[i];
      double surplus = (2.0 * loss - terms_[i].gain) * grid_.volume[i] + coupling_[i] * share;
      if (i + 1 == n) surplus += coupling_[n];
      const double diagonal = surplus + (i + 1 < n ? coupling_[i + 1] : 0.0);
      const double right = loss * g[i] * grid_.volume[i] +
                           coupling_[i] * (i == 0 ? first_ : g[i - 1]) +
                           (i + 1 == n ? coupling_[n] * last_ : 0.0);
      valid = valid && diagonal > 0.0;
      upper_[i] = i + 1 < n ? coupling_[i + 1] / diagonal : 0.0;
      share = surplus / diagonal;
      g[i] = right / diagonal;
    }
    for (std::size_t i = n - 1; i-- > 0;) g[i] += upper_[i] * g[i + 1];
    return valid;
  }

 private:
  const BandGrid& grid_;
  std::span<const FluidityTerms> terms_;
  std::vector<double> coupling_;
  double first_;
  double last_;
  std::vector<double> upper_;
};

/// A = 0: every cell has the fluidity of the local law.
Fluidity local_fluidity(std::span<const FluidityTerms> terms) {
  Fluidity result{.g = {}, .converged = true};
  for (const FluidityTerms& t : terms) result.g.push_back(t.gain > 0.0 ? t.gain / t.loss : 0.0);
  return result;
}

double largest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

}  // namespace

std::optional<FluidityTerms> fluidity_terms(const FlowCurve& curve, double tau, double pressure) {
  const double excess = tau - curve.yield_stress;
  const double distance = curve.linear - curve.kappa * excess;  // p beta (mu_2 - mu) / Dmu
  if (distance <= 0.0) return std::nullopt;
  return FluidityTerms{.gain = curve.linear / pressure * excess / distance,
                       .loss = curve.linear / pressure * tau / (pressure * std::sqrt(pressure))};
}

void require_linear_onset(const InertialFriction& law) {
  if (!law.exponent && !law.tabulated) return;
  throw TableError(fmt::format(
      "the nonlocal fluidity is built on a law linear in I where flow begins: this table has {}; "
      "leave out the nonlocal amplitude",
      law.exponent ? "a power of I" : "a tabulated mu(I)"));
}

double cooperativity_length(double amplitude, const InertialFriction& law, double mu) {
  const double excess = mu - law.mu0;
  return amplitude * std::sqrt((law.beta - law.kappa * excess) / (law.beta * std::abs(excess)));
}

double stop_depth(double amplitude, const InertialFriction& law, double mu) {
  if (mu <= law.mu0) return std::numeric_limits<double>::infinity();
  return 0.5 * std::numbers::pi * cooperativity_length(amplitude, law, mu);
}

Fluidity solve_fluidity(const BandGrid& grid,
                        std::span<const FluidityTerms> terms,
                        double amplitude,
                        EndValue first,
                        EndValue last,
                        std::span<const double> guess) {
  if (amplitude == 0.0) return local_fluidity(terms);
  const double bound = upper_bound(terms, first, last);
  Fluidity result{.g = std::vector<double>(grid.cells(), 0.0), .converged = true};
  if (bound == 0.0) return result;
  NewtonStep step(
      grid, terms, couplings(grid, amplitude, first.has_value(), last.has_value()), first, last);
  std::vector<double>& g = result.g;
  std::copy(guess.begin(), guess.end(), g.begin());
  if (guess.empty() || largest(g) <= 0.0 || !step(g)) g.assign(grid.cells(), bound);
  // Steps square the distance to a flow and halve that to rest, so after a change of 1e-10 a flow
  // is known to rounding, and what fell to 1e-14 of the bound is rest.
  constexpr int most = 200;
  std::vector<double> before;
  double last_change = bound;
  while (++result.iterations < most) {
    before = g;
    step(g);
    double change = 0.0;
    for (std::size_t i = 0; i < g.size(); ++i)
      change = std::max(change, std::abs(before[i] - g[i]));
    if (largest(g) < 1e-14 * bound) {
      g.assign(g.size(), 0.0);
      return result;
    }
    const bool rounding = change >= last_change && change <= 1e-6 * largest(g);
    if (change <= 1e-10 * largest(g) || rounding) return result;
    last_change = change;
  }
  result.converged = false;
  return result;
}

}  // namespace grainlaw::continuum
