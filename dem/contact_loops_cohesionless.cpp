#include "dem/contact_loops.h"

namespace grainlaw::dem {

template struct ContactLoops<ContactLaw<Hooke, Cohesionless, Frictionless>>;
template struct ContactLoops<ContactLaw<Hooke, Cohesionless, Sliding>>;
template struct ContactLoops<ContactLaw<Hooke, Cohesionless, StickSlip>>;
template struct ContactLoops<ContactLaw<Hertz, Cohesionless, Frictionless>>;
template struct ContactLoops<ContactLaw<Hertz, Cohesionless, Sliding>>;
template struct ContactLoops<ContactLaw<Hertz, Cohesionless, StickSlip>>;

}  // namespace grainlaw::dem
