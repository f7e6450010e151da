#include "dem/contact_loops.h"

namespace grainlaw::dem {

template struct ContactLoops<ContactLaw<Hooke, LiquidBridge, Frictionless>>;
template struct ContactLoops<ContactLaw<Hooke, LiquidBridge, Sliding>>;
template struct ContactLoops<ContactLaw<Hooke, LiquidBridge, StickSlip>>;
template struct ContactLoops<ContactLaw<Hertz, LiquidBridge, Frictionless>>;
template struct ContactLoops<ContactLaw<Hertz, LiquidBridge, Sliding>>;
template struct ContactLoops<ContactLaw<Hertz, LiquidBridge, StickSlip>>;

}  // namespace grainlaw::dem
