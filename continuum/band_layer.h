#pragma once

#include <optional>
#include <string>
#include <vector>

#include "continuum/shear_band_cells.h"
#include "continuum/yielding_curve.h"

namespace grainlaw::continuum {

/// What holds at an end of a band: its velocity, or the stress on it.
struct BandEnd {
  std::optional<double> velocity{};
  double stress = 0.0;
};

/// Plane shear or body-force box in time, elastic below yield: see YieldingLayer for what modulus
/// and damping do. Cells from the moving wall on, in the box from y = 0 with velocities reversed;
/// unknowns are the stress at every face and the velocity of the cell behind it,
///     dsigma/dt = G (K |du/dM| - Q(sigma)),     du/dt = f - d(sigma + t_e dsigma/dt)/dM.
class BandLayer : public OdeSystem {
 public:
  /// `mass` of the faces from the first end, ascending from 0.
  BandLayer(const BandProblem& problem,
            std::vector<double> mass,
            BandEnd first,
            BandEnd last,
            double driving_stress,
            double elastic_time);

  Bandwidth bandwidth() const override { return {2, 2}; }
  void rate(double t, std::span<const double> y, std::span<double> dydt) const override;
  void jacobian(double t, std::span<const double> y, BandView matrix) const override;
  double event(double, std::span<const double>) const override { return 1.0; }
  std::string component_name(std::size_t i) const override;

  std::vector<double> rest() const;
  double momentum(std::span<const double> y) const;
  /// max |du/dt| of the rates of all unknowns.
  double largest_acceleration(std::span<const double> rate) const;
  /// As the steady solution has it; shear rates are those of the velocity.
  BandState band_state(std::span<const double> y) const;

 private:
  struct Face {
    double mass;      ///< from the first end
    double distance;  ///< between the velocities on its sides, in mass
    double pressure;
    FlowCurve curve;
    YieldingCurve yielding;
  };
  double cell_mass(std::size_t cell) const { return faces_[cell + 1].mass - faces_[cell].mass; }
  /// A given end stress is no unknown: its rate is 0.
  bool held(std::size_t face) const;
  double plastic_rate(std::span<const double> y, std::size_t face) const;
  double stress_rate(std::span<const double> y, std::size_t face) const;
  /// Mean of both faces of a cell; static where a stress has no rate.
  double volume_fraction(std::span<const double> y, std::size_t cell) const;
  /// Force per mass on every cell.
  std::vector<double> drive(std::span<const double> y) const;

  const BandProblem& problem_;
  std::vector<Face> faces_;
  BandEnd first_;
  BandEnd last_;
  std::size_t cells_;
  double elastic_time_;
  double wave_speed_squared_;
};

}  // namespace grainlaw::continuum
