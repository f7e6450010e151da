#include "calibration/bagnold_solve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/differentiate.h"
#include "calibration/model_choice.h"
#include "continuum/bagnold_profile.h"
#include "continuum/rheology.h"

namespace grainlaw::calibration {
namespace {

namespace slot = bagnold_slot;
using Values = std::array<double, slot::count>;

/// Residuals of the velocities against Brewster eq. 9, depth measured by the mass above, and of the
/// shear rates against the inverse law at the measured stress.
struct BagnoldModel {
  BagnoldForm form;
  BagnoldData data;
  BagnoldErrors errors;

  template <class Scalar>
  void operator()(const std::array<Scalar, slot::count>& x, std::span<Scalar> r) const {
    const double c = data.density * data.weight_down;
    const Scalar base_depth = (data.mass - x[slot::mass_below]) / data.density;
    const std::size_t n = data.velocity.size();
    const std::size_t first_pair = form.profile ? n : 0;
    for (std::size_t k = 0; k < n; ++k) {
      if (form.profile) {
        const double depth = data.mass_above[k] / data.density;
        const Scalar u = continuum::bagnold_velocity(
            x[slot::a], x[slot::b], x[slot::tau_c], c, base_depth, depth);
        r[k] = (u - data.velocity[k]) / errors.velocity[k];
      }
      if (form.pairs) {
        const Scalar excess = data.shear_stress[k] - x[slot::tau_c];
        const Scalar rate = continuum::bagnold_shear_rate(x[slot::a], x[slot::b], excess);
        r[first_pair + k] = (rate - data.shear_rate[k]) / errors.shear_rate[k];
      }
    }
  }
};

Values fill(const BagnoldForm& form, std::span<const double> x) {
  Values values = form.fixed;
  std::size_t k = 0;
  for (std::size_t j = 0; j < slot::count; ++j) {
    if (form.free[j]) values[j] = x[k++];
  }
  return values;
}

/// Effective variance of the shear rates at the law x: their own and that of the stress at which
/// the law is taken, s_gd^2 + (d gd/d tau s_tau)^2.
BagnoldErrors effective_errors(const BagnoldInput& input, const Values& x) {
  BagnoldErrors errors = input.errors;
  for (std::size_t k = 0; k < errors.shear_rate.size(); ++k) {
    const double rate = continuum::bagnold_shear_rate(
        x[slot::a], x[slot::b], input.data.shear_stress[k] - x[slot::tau_c]);
    const double slope = 1.0 / (x[slot::b] + 2.0 * x[slot::a] * rate);
    // At yield the slope of a pure Bagnold law is infinite and says nothing.
    if (!std::isfinite(slope)) continue;
    errors.shear_rate[k] = std::hypot(errors.shear_rate[k], slope * errors.shear_stress[k]);
  }
  return errors;
}

int count_residuals(const BagnoldInput& input, const BagnoldForm& form) {
  const int n = static_cast<int>(input.data.velocity.size());
  return (form.profile ? n : 0) + (form.pairs ? n : 0);
}

/// Columns of the free unknowns out of the derivatives by all.
Residuals residuals(const BagnoldModel& model) {
  return [model, all = differentiate<slot::count>(model)](
             std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
    const Values values = fill(model.form, x);
    std::vector<double> full(jacobian.empty() ? 0 : r.size() * slot::count);
    all(values, r, full);
    for (std::size_t i = 0, k = 0; !jacobian.empty() && i < r.size(); ++i) {
      for (std::size_t j = 0; j < slot::count; ++j) {
        if (model.form.free[j]) jacobian[k++] = full[i * slot::count + j];
      }
    }
  };
}

LeastSquaresProblem problem_with(const BagnoldInput& input,
                                 const BagnoldForm& form,
                                 std::span<const double> start,
                                 const BagnoldErrors& errors) {
  const std::array<Unknown, slot::count> unknowns{
      {{.name = "a", .lower = 0.0},
       {.name = "b", .lower = 0.0},
       {.name = "tau_c", .lower = 0.0},
       // u = 0 below the base top would be slip, which an effective base cannot express.
       {.name = "mass_below", .lower = input.mass_below_base}}};
  LeastSquaresProblem problem;
  for (std::size_t j = 0; j < slot::count; ++j) {
    if (form.free[j]) problem.unknowns.push_back(unknowns[j]);
  }
  for (std::size_t k = 0; k < start.size(); ++k) problem.unknowns[k].start = start[k];
  problem.residuals = count_residuals(input, form);
  problem.evaluate = residuals(BagnoldModel{form, input.data, errors});
  return problem;
}

/// Scatter of the weighted residuals over the blocks of the run at the law x: rows l with sum l l'
/// = covariance of the residuals of the mean rows. It holds every correlation there is, between
/// bins and between velocity, shear rate, stress and density.
Matrix block_noise(const BagnoldInput& input,
                   const BagnoldForm& form,
                   const Values& x,
                   const BagnoldErrors& errors) {
  const int count = static_cast<int>(input.blocks.size());
  const int width = count_residuals(input, form);
  Matrix noise(count, width);
  std::vector<double> mean(static_cast<std::size_t>(width));
  for (int b = 0; b < count; ++b) {
    const BagnoldModel model{form, input.blocks[static_cast<std::size_t>(b)], errors};
    const std::span<double> row(&noise(b, 0), static_cast<std::size_t>(width));
    model(x, row);
    for (std::size_t i = 0; i < row.size(); ++i) mean[i] += row[i] / count;
  }
  const double scale = 1.0 / std::sqrt(count * (count - 1.0));
  for (int b = 0; b < count; ++b) {
    for (int i = 0; i < width; ++i) {
      noise(b, i) = scale * (noise(b, i) - mean[static_cast<std::size_t>(i)]);
    }
  }
  return noise;
}

/// (tr S)^2 / tr S^2 of S = sum l l': as many independent numbers scatter like that (Bretherton et
/// al. 1999, eq. 5).
double independent_data(const Matrix& noise) {
  double trace = 0.0, squares = 0.0;
  for (int i = 0; i < noise.rows; ++i) {
    for (int j = 0; j < noise.rows; ++j) {
      double product = 0.0;
      for (int k = 0; k < noise.columns; ++k) product += noise(i, k) * noise(j, k);
      if (i == j) trace += product;
      squares += product * product;
    }
  }
  return squares > 0.0 ? trace * trace / squares : noise.columns;
}

std::vector<double> start_of(const BagnoldInput& input, const BagnoldForm& form) {
  Values start{input.start[0], input.start[1], 0.0, input.start[2]};
  if (!form.free[slot::a]) {
    // The same mean stress from the linear term alone, at the mean of the measured rates.
    double rate = 0.0;
    for (const double r : input.data.shear_rate) rate += r;
    start[slot::b] = start[slot::a] * rate / static_cast<double>(input.data.shear_rate.size());
  }
  std::vector<double> free;
  for (std::size_t j = 0; j < slot::count; ++j) {
    if (form.free[j]) free.push_back(start[j]);
  }
  return free;
}

/// Xi as a function of a, b and tau_c at the shear stress `stress` less the share of tau_c.
struct Ratio {
  double stress;  ///< of the whole layer
  double share;   ///< of the height below the plug

  template <class Scalar>
  void operator()(const std::array<Scalar, slot::count>& x, std::span<Scalar> result) const {
    const Scalar excess = (1.0 - share) * (stress - x[slot::tau_c]);
    result[0] =
        x[slot::b] / (x[slot::a] * continuum::bagnold_shear_rate(x[slot::a], x[slot::b], excess));
  }
};

}  // namespace

BagnoldForm stress_rate_pairs(bool yields) {
  return {.profile = false, .pairs = true, .free = {true, true, yields, false}};
}

int SolvedBagnold::unknown(std::size_t wanted) const {
  if (!form.free[wanted]) return -1;
  return static_cast<int>(
      std::count(form.free.begin(), form.free.begin() + static_cast<std::ptrdiff_t>(wanted), true));
}

SolvedBagnold solve_bagnold(const BagnoldInput& input, const BagnoldForm& form) {
  const auto problem_at = [&](std::span<const double> x) {
    return problem_with(input, form, x, effective_errors(input, fill(form, x)));
  };
  SolvedBagnold solved;
  solved.form = form;
  solved.blocks = static_cast<int>(input.blocks.size());
  solved.minimum = minimise_reweighted(problem_at, start_of(input, form));
  solved.values = fill(form, solved.minimum.values);
  const LeastSquaresProblem problem = problem_at(solved.minimum.values);
  solved.independent_data = problem.residuals;
  if (input.blocks.empty()) {
    solved.uncertainty = uncertainty(problem, solved.minimum);
    return solved;
  }
  const BagnoldErrors errors = effective_errors(input, solved.values);
  const Matrix noise = block_noise(input, form, solved.values, errors);
  solved.independent_data = independent_data(noise);
  solved.uncertainty = uncertainty(problem, solved.minimum, noise);
  return solved;
}

Minimum solve_bagnold_weighted(const BagnoldInput& input,
                               const BagnoldForm& form,
                               const SolvedBagnold& weights) {
  return minimise(
      problem_with(input, form, start_of(input, form), effective_errors(input, weights.values)));
}

FittedCoefficient stress_ratio(const SolvedBagnold& solved,
                               const BagnoldInput& input,
                               double share_of_height) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  FittedCoefficient ratio{.name = "Xi"};
  if (!(solved.values[slot::a] > 0.0)) {
    ratio.value = ratio.error = infinity;
    return ratio;
  }
  Values slopes{};
  differentiate<slot::count>(Ratio{input.data.weight_down * input.data.mass, share_of_height})(
      solved.values, {&ratio.value, 1}, slopes);
  double variance = 0.0;
  for (std::size_t i = 0; i < slot::mass_below; ++i) {
    for (std::size_t j = 0; j < slot::mass_below; ++j) {
      const int p = solved.unknown(i), q = solved.unknown(j);
      if (p >= 0 && q >= 0) variance += slopes[i] * slopes[j] * solved.uncertainty.covariance(p, q);
    }
  }
  ratio.error = std::sqrt(variance);
  const double half = interval_half_width(solved.blocks > 1, solved.blocks - 1) * ratio.error;
  ratio.interval = {.lower = std::max(0.0, ratio.value - half), .upper = ratio.value + half};
  return ratio;
}

}  // namespace grainlaw::calibration
