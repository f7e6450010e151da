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
      amplitude_(amplitude),
      matrix_(amplitude > 0.0 ? mesh.cells() : 0, mesh.rows()) {
  for (const double p : pressures_) curves_.push_back(flow_curve(law, grains, p));
}

/// visit(cell, other, coupling) for every face between two cells, A^2 area / distance.
template <class Visit>
void RingFluidity::visit_faces(Visit visit) const {
  const double h = mesh_.thickness();
  const double square = amplitude_ * amplitude_;
  for (std::size_t k = 0; k < mesh_.rows(); ++k) {
    for (std::size_t i = 0; i < mesh_.columns(); ++i) {
      const std::size_t here = mesh_.cell(i, k);
      if (i + 1 < mesh_.columns())
        visit(here,
              mesh_.cell(i + 1, k),
              square * mesh_.r()[i + 1] * h / (mesh_.radius(i + 1) - mesh_.radius(i)));
      if (k + 1 < mesh_.rows())
        visit(here, mesh_.cell(i, k + 1), square * mesh_.radius(i) * mesh_.width(i) / h);
    }
  }
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
  const auto place = [&](std::size_t cell) {
    return cell % mesh_.columns() * mesh_.rows() + cell / mesh_.columns();
  };
  matrix_.clear();
  std::vector<double> step(g.size(), 0.0);  // the residual first
  for (std::size_t cell = 0; cell < g.size(); ++cell) {
    const Reaction R = reaction(cell / mesh_.columns(), shear_rates[cell], g[cell]);
    const double volume = mesh_.volume(cell % mesh_.columns());
    matrix_(place(cell), place(cell)) = -volume * R.slope;
    step[place(cell)] = volume * R.value;
  }
  visit_faces([&](std::size_t cell, std::size_t other, double coupling) {
    const std::size_t a = place(cell), b = place(other);
    matrix_(a, a) += coupling;
    matrix_(b, b) += coupling;
    matrix_(std::max(a, b), std::min(a, b)) -= coupling;
    step[a] += coupling * (g[other] - g[cell]);
    step[b] += coupling * (g[cell] - g[other]);
  });
  if (!matrix_.factorise())
    throw SolverError("the fluidity of the ring cell has no solution: its matrix is singular");
  matrix_.solve(step);
  double change = 0.0;
  for (std::size_t cell = 0; cell < g.size(); ++cell) {
    const double bound = least(cell / mesh_.columns(), shear_rates[cell]);
    const double before = g[cell];
    g[cell] += step[place(cell)];
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
