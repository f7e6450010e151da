#include "continuum/ring_fluidity.h"

#include <algorithm>
#include <cmath>

#include "continuum/answer.h"

namespace grainlaw::continuum {

RingFluidity::RingFluidity(const RingMesh& mesh,
                           const MuPhi& law,
                           const GrainProperties& grains,
                           std::vector<double> pressures,
                           double amplitude)
    : mesh_(mesh),
      law_(law),
      grains_(grains),
      pressures_(std::move(pressures)),
      amplitude_(amplitude) {
  for (const double p : pressures_) curves_.push_back(flow_curve(law, grains, p));
  if (amplitude == 0.0) return;
  std::vector<Eigen::Triplet<double>> triplets;
  const auto couple = [&](std::size_t one, std::size_t other, double strength) {
    const auto a = static_cast<int>(one), b = static_cast<int>(other);
    triplets.emplace_back(a, a, strength);
    triplets.emplace_back(b, b, strength);
    triplets.emplace_back(std::max(a, b), std::min(a, b), -strength);
  };
  const double h = mesh.thickness();
  const double square = amplitude * amplitude;
  for (std::size_t k = 0; k < mesh.rows(); ++k) {
    for (std::size_t i = 0; i < mesh.columns(); ++i) {
      const std::size_t here = mesh.cell(i, k);
      if (i + 1 < mesh.columns())
        couple(here,
               mesh.cell(i + 1, k),
               square * mesh.r()[i + 1] * h / (mesh.radius(i + 1) - mesh.radius(i)));
      if (k + 1 < mesh.rows())
        couple(here, mesh.cell(i, k + 1), square * mesh.radius(i) * mesh.width(i) / h);
    }
  }
  const auto size = static_cast<long>(mesh.cells());
  diffusion_.resize(size, size);
  diffusion_.setFromTriplets(triplets.begin(), triplets.end());
  factors_.analyzePattern(diffusion_);
}

RingFluidity::Reaction RingFluidity::reaction(std::size_t row, double shear_rate, double g) const {
  const FlowCurve& curve = curves_[row];
  const double p = pressures_[row];
  const double tau = p * shear_rate / g;
  const double excess = tau - curve.yield_stress;
  const double distance = curve.linear - curve.kappa * excess;
  const double rate = shear_rate / std::sqrt(p);
  const double factor = curve.linear / p;
  return {
      .value = factor * g * (excess / distance - rate),
      .slope = factor * (excess / distance - rate - tau * curve.linear / (distance * distance))};
}

double RingFluidity::local(std::size_t row, double shear_rate) const {
  const double p = pressures_[row];
  return p * shear_rate / shear_stress(law_, grains_, shear_rate, p);
}

/// The friction of the law is reached in the limit of this g.
double RingFluidity::least(std::size_t row, double shear_rate) const {
  const FlowCurve& curve = curves_[row];
  if (curve.kappa == 0.0) return 0.0;
  return pressures_[row] * shear_rate / (curve.yield_stress + curve.linear / curve.kappa);
}

bool RingFluidity::newton_step(std::span<const double> shear_rates, std::vector<double>& g) {
  constexpr double accuracy = 1e-9;
  const auto size = static_cast<long>(g.size());
  Eigen::Map<Eigen::VectorXd> value(g.data(), size);
  Matrix matrix = diffusion_;
  Eigen::VectorXd residual = -(diffusion_.selfadjointView<Eigen::Lower>() * value);
  for (std::size_t k = 0; k < mesh_.rows(); ++k) {
    for (std::size_t i = 0; i < mesh_.columns(); ++i) {
      const std::size_t cell = mesh_.cell(i, k);
      const auto at = static_cast<long>(cell);
      const Reaction R = reaction(k, shear_rates[cell], g[cell]);
      residual[at] += mesh_.volume(i) * R.value;
      matrix.coeffRef(at, at) -= mesh_.volume(i) * R.slope;
    }
  }
  factors_.factorize(matrix);
  if (factors_.info() != Eigen::Success)
    throw SolverError("the fluidity of the ring cell has no solution: its matrix is singular");
  const Eigen::VectorXd step = factors_.solve(residual);
  double change = 0.0;
  for (std::size_t cell = 0; cell < g.size(); ++cell) {
    const double bound = least(cell / mesh_.columns(), shear_rates[cell]);
    const double before = g[cell];
    g[cell] += step[static_cast<long>(cell)];
    if (!(g[cell] > bound)) g[cell] = 0.5 * (before + bound);
    change = std::max(change, std::abs(g[cell] - before) / before);
  }
  return change < accuracy;
}

void RingFluidity::solve(std::span<const double> shear_rates, std::vector<double>& g) {
  const bool begin = g.size() != shear_rates.size();
  if (begin) g.resize(shear_rates.size());
  for (std::size_t cell = 0; cell < g.size(); ++cell) {
    const std::size_t row = cell / mesh_.columns();
    if (begin || amplitude_ == 0.0) g[cell] = local(row, shear_rates[cell]);
    constexpr double inside = 1.0 + 1e-4;  // of what the largest friction allows
    g[cell] = std::max(g[cell], inside * least(row, shear_rates[cell]));
  }
  if (amplitude_ == 0.0) return;
  constexpr int most = 100;
  for (int k = 0; k < most; ++k)
    if (newton_step(shear_rates, g)) return;
  throw SolverError("the fluidity of the ring cell does not converge");
}

}  // namespace grainlaw::continuum
