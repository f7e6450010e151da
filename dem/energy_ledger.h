#pragma once

namespace grainlaw::dem {

/// Where the energy of a run came from and went, every channel integrated from its own force
/// since the ledger was opened. All in [energy].
struct EnergyLedger {
  double initial_energy = 0.0;  ///< kinetic and elastic, when it was opened
  double normal_dashpot = 0.0;
  double tangential_dashpot = 0.0;
  double slip = 0.0;
  double spring_lost = 0.0;   ///< tangential springs of contacts that opened
  double gravity_work = 0.0;  ///< gained

  double dissipated() const { return normal_dashpot + tangential_dashpot + slip + spring_lost; }
  /// What the channels do not explain of the kinetic and elastic energy of now.
  double residual(double energy) const {
    return energy - initial_energy - gravity_work + dissipated();
  }
};

}  // namespace grainlaw::dem
