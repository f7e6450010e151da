#include "dem/contact_loops.h"

namespace grainlaw::dem {

template struct ContactLoops<ContactLaw<Hooke, ReversibleAdhesion, Frictionless>>;
template struct ContactLoops<ContactLaw<Hooke, ReversibleAdhesion, Sliding>>;
template struct ContactLoops<ContactLaw<Hooke, ReversibleAdhesion, StickSlip>>;
template struct ContactLoops<ContactLaw<Hertz, ReversibleAdhesion, Frictionless>>;
template struct ContactLoops<ContactLaw<Hertz, ReversibleAdhesion, Sliding>>;
template struct ContactLoops<ContactLaw<Hertz, ReversibleAdhesion, StickSlip>>;

}  // namespace grainlaw::dem
