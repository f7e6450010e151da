#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "dem/estimate.h"

namespace grainlaw::calibration {

/// Where a law is taken: I, p* and Bo.
template <class T>
struct StateOf {
  T inertial_number{};
  T softness{};  ///< p*
  T bond_number{};
};
using State = StateOf<double>;

/// Coefficients a law can have; a fit has some of them active, the rest stay at `inactive`.
inline constexpr std::size_t law_slots = 8;
template <class S>
using Slots = std::array<S, law_slots>;

/// One coefficient as the fit sees it. The fit works in numbers that pass smoothly through the law
/// without the term (1/I_phi, not I_phi); the table has their `power`.
struct Slot {
  std::string name;
  double inactive = 0.0;
  double start = 0.0;
  double lower = 0.0;
  int power = 1;  ///< coefficient of the table = (number of the fit)^power
};

/// A part of a law that the data may not need.
struct LawTerm {
  std::string name;
  std::vector<std::size_t> slots;  ///< go together
  int after = -1;                  ///< slot that must have gone before; -1: none
};

/// A law y(I, p*, Bo) with what a fit must know of it.
struct FittableLaw {
  std::string name;
  std::vector<Slot> slots;            ///< at most law_slots
  std::vector<std::size_t> possible;  ///< slots of this family
  std::vector<LawTerm> terms;
  std::function<double(const Slots<double>&, const State&)> value;
  /// Derivatives by the slots, and by I, p*, Bo.
  std::function<double(const Slots<double>&, const State&, Slots<double>&)> by_slots;
  std::function<std::array<double, 3>(const Slots<double>&, const State&)> by_state;
};

/// What a law is fitted to.
struct LawDatum {
  State state;
  State error;  ///< standard errors of the state
  double y = 0.0;
  double y_error = 0.0;
  bool flagged = false;  ///< outside the range where the law is known to hold: weighs less if it
                         ///< lies far off
};

}  // namespace grainlaw::calibration
