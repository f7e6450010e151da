#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "continuum/rheology.h"

namespace grainlaw::continuum {

/// A bumpy base does not hold u = 0 at its top plane z = 0 (highest base-grain centre + d/2) but at
/// an effective height above it. Measured with one recipe of base, valid for that recipe.
struct EffectiveBase {
  double no_slip_height = 0.0;  ///< z at which u = 0 [d]
  double mass_below = 0.0;      ///< flowing mass per unit area below that height [rho_p d]
  std::string recipe{};         ///< base it was measured on; empty: not stated
};

/// Covariance of the fitted coefficients, row-major, in the order of `names`.
struct Covariance {
  std::vector<std::string> names;
  std::vector<double> matrix;

  double operator()(std::size_t i, std::size_t j) const { return matrix[i * names.size() + j]; }
};

/// An interval of one dimensionless number.
struct Range {
  double lower = 0.0;
  double upper = 0.0;
};

/// Where the data of a table lie. An absent range was not explored (the law does not depend on it).
struct ValidRange {
  std::optional<Range> inertial_number{};
  std::optional<Range> softness{};
  std::optional<Range> bond_number{};
};

/// Meaning of the numbers, in words, so that a table can be used without its authors.
struct Definitions {
  std::string inertial_number = "I = gd d sqrt(rho_p / p), measured shear rate, grain density";
  std::string pressure = "p = sigma_zz";
  std::string bond_number;  ///< empty: no cohesion in the data
  std::string stress = "contact (normal and tangential) + kinetic";
};

/// Where a table comes from and what it was checked against.
struct Provenance {
  std::string source;                        ///< paper and table, or the program and its version
  std::string geometry{};                    ///< flow of those runs, as scenes name it; empty: not
                                             ///< stated
  std::vector<std::string> data;             ///< runs it was fitted to
  std::vector<std::string> digests{};        ///< of their files, in that order; empty: not stated
  std::vector<std::string> checked_against;  ///< runs it was not fitted to
};

/// One constitutive law with everything a prediction needs to use it honestly.
/// a, b, tau_c are stored in the set of units named by `units`; mu, phi laws are dimensionless.
struct RheologyTable {
  std::variant<GeneralisedBagnold, MuPhi> law;
  bool has_friction = true;              ///< false: phi only, mu(I) of the law says nothing
  double contact_friction = 0.0;         ///< mu_p of the grains
  std::string units = "grain";           ///< of a, b, tau_c
  std::optional<EffectiveBase> base;     ///< absent: u = 0 at z = 0
  std::optional<Covariance> covariance;  ///< absent: the table states no errors
  ValidRange range;
  Definitions definitions;
  Provenance provenance;
};

/// A table that contradicts itself or leaves physics; the message names value, bound and remedy.
struct TableError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Checks signs, ranges, monotony, and that the covariance is symmetric, positive semidefinite and
/// names coefficients the table has; and that a flow follows from the table, which it does not from
/// phi alone. Throws TableError.
void validate(const RheologyTable& table);

/// The same for a table that may have phi only. Throws TableError.
void validate_coefficients(const RheologyTable& table);

/// A flow in time passes through all I from 0 on: refuses a tabulated mu(I) that begins above 0, by
/// which grains would start at once with its first I. Throws TableError.
void require_continuous_yield(const std::variant<GeneralisedBagnold, MuPhi>& law);

/// Names of the coefficients of a table, only those that are present, in this order:
///   closure A: a, b, tau_c, volume_fraction;
///   closure B: mu0, beta, kappa (all three with friction only, none if it is tabulated),
///   exponent, p_mu, cohesion_alpha,
///   cohesion_beta, cohesion_factor, cohesion_bond_exponent, cohesion_softness_exponent, phi0,
///   I_phi, p_phi, p1..p4;
///   both: no_slip_height, mass_below. A covariance may name any subset in any order.
std::vector<std::string> coefficient_names(const RheologyTable& table);

/// Reads or replaces one coefficient by name. Throws TableError for an unknown name.
double coefficient(const RheologyTable& table, const std::string& name);
void set_coefficient(RheologyTable& table, const std::string& name, double value);

}  // namespace grainlaw::continuum
