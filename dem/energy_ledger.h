#pragma once

namespace grainlaw::dem {

/// Where the energy of a run came from and went, every channel integrated from its own force
/// since the ledger was opened. All in [energy].
struct EnergyLedger {
  double initial_energy = 0.0;  ///< kinetic and elastic, when it was opened
  double normal_dashpot = 0.0;
  double tangential_dashpot = 0.0;
  double slip = 0.0;
  double spring_lost = 0.0;     ///< tangential springs of contacts that opened
  double prefactor_work = 0.0;  ///< taken from tangential springs by a falling Hertz prefactor
  double bridge_lost = 0.0;     ///< liquid bridges that ruptured
  double field_work = 0.0;      ///< gained from gravity or a body force
  double boundary_work = 0.0;   ///< gained from moving walls and moving images

  double dissipated() const {
    return normal_dashpot + tangential_dashpot + slip + spring_lost + prefactor_work + bridge_lost;
  }
  /// What the channels do not explain of the kinetic and elastic energy of now.
  double residual(double energy) const {
    return energy - initial_energy - field_work - boundary_work + dissipated();
  }
};

}  // namespace grainlaw::dem
