#include "dem/contact_loops.h"

namespace grainlaw::dem {

template struct ContactLoops<ContactLaw<Hooke, GaussianWell, Frictionless>>;
template struct ContactLoops<ContactLaw<Hooke, GaussianWell, Sliding>>;
template struct ContactLoops<ContactLaw<Hooke, GaussianWell, StickSlip>>;
template struct ContactLoops<ContactLaw<Hertz, GaussianWell, Frictionless>>;
template struct ContactLoops<ContactLaw<Hertz, GaussianWell, Sliding>>;
template struct ContactLoops<ContactLaw<Hertz, GaussianWell, StickSlip>>;

}  // namespace grainlaw::dem
