#include "apps/io/rheology_table_toml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/io/safe_write.h"

namespace grainlaw::io {
namespace {

using namespace continuum;

constexpr Bounds volume_fraction_bounds = {
    .lower = loosest_volume_fraction, .upper = 1.0, .lower_allowed = true};
constexpr Bounds slope_bounds = from_to(0.0, steepest_friction);
constexpr Bounds exponent_bounds = {.lower = least_exponent, .lower_allowed = true};

GeneralisedBagnold read_bagnold(Section& section) {
  GeneralisedBagnold law;
  law.a = section.read<double>({"a", "of gd^2", {"mass/length"}, not_negative});
  law.b = section.read<double>({"b", "of gd", {"mass/(length time)"}, not_negative});
  law.tau_c = section.read_or<double>(
      {"tau_c", "yield stress", {"mass/(length time^2)"}, not_negative}, 0.0);
  law.volume_fraction = section.read<double>(
      {"volume_fraction", "phi of the flowing bulk", {}, volume_fraction_bounds});
  const auto in_degrees = section.find<double>(
      {"inclination", "tilt at which a and b were measured", {"degrees"}, from_to(0.0, 90.0)});
  const auto in_radians =
      section.find<double>({"inclination_radians",
                            "same, for a tilt no number of degrees gives exactly",
                            {"rad"},
                            from_to(0.0, 1.58)});
  section.exactly_one_of({"inclination", "inclination_radians"});
  law.inclination = in_radians.value_or(radians(in_degrees.value_or(0.0)));
  return law;
}

/// Power law or not; the rest of mu(I) does not change.
std::optional<double> read_exponent(Section& section) {
  const Key key{"exponent", "n of x = I^n, in place of I in mu(I)", {}, exponent_bounds};
  return section.find<double>(key, "1");
}

/// beta and kappa, or mu_inf and I_mu in their place: beta = (mu_inf - mu0)/I_mu, kappa = 1/I_mu.
InertialFriction read_friction(InputFile& in) {
  Section section =
      in.section("law.friction", "mu(I) = mu0 + beta x/(1 + kappa x), x = I or a power of it");
  InertialFriction law;
  law.exponent = read_exponent(section);
  law.mu0 = section.read<double>({"mu0", "static friction", {}, not_negative});
  const auto beta = section.find<double>({"beta", "slope at I = 0", {}, slope_bounds});
  const auto mu_inf = section.find<double>({"mu_inf", "friction at large I", {}, not_negative});
  section.exactly_one_of({"beta", "mu_inf"});
  const auto kappa =
      section.find<double>({"kappa", "curvature, with beta", {}, not_negative}, "0: a line");
  const auto I_mu = section.find<double>(
      {"I_mu", "I of half the rise to mu_inf (Shi et al. 2020, eq. 1A)", {}, positive});
  if (mu_inf.has_value() != I_mu.has_value() || (mu_inf && kappa)) {
    section.problem("", "give beta, with kappa where the law is curved, or mu_inf with I_mu");
  }
  if (!mu_inf || !I_mu) {
    law.beta = beta.value_or(0.0);
    law.kappa = kappa.value_or(0.0);
    return law;
  }
  if (*mu_inf < law.mu0) {
    section.problem(
        "mu_inf",
        fmt::format("mu_inf = {} is below mu0 = {}: friction would fall with I", *mu_inf, law.mu0));
  }
  law.beta = (*mu_inf - law.mu0) / *I_mu;
  law.kappa = 1.0 / *I_mu;
  return law;
}

/// Pairs of I and mu in place of the law above; absent: there are none.
std::shared_ptr<const MonotoneCurve> read_friction_table(InputFile& in) {
  using Numbers = std::vector<double>;
  Section section = in.optional_section(
      "law.friction_table", "mu(I) by a monotone cubic through pairs, in place of [law.friction]");
  if (!section.given()) return nullptr;
  const auto I = section.read<Numbers>(
      {"inertial_number", "I, rising; beyond the ends mu is held", {}, from_to(0.0, INFINITY)});
  const auto mu = section.read<Numbers>({"friction", "mu, rising", {}, from_to(0.0, INFINITY)});
  if (!section.has("inertial_number") || !section.has("friction")) return nullptr;
  try {
    return std::make_shared<const MonotoneCurve>(I, mu);
  } catch (const TableError& error) {
    section.problem("friction", error.what());
  }
  return nullptr;
}

void read_friction_terms(InputFile& in, MuPhi& law) {
  Section softness =
      in.optional_section("law.softness_friction", "f_p = 1 - sqrt((1 + Bo) p*/p_mu)");
  if (softness.given()) {
    law.softness_friction = SoftnessFriction{
        .p_mu = softness.read<double>({"p_mu", "(Shi et al. 2020, table 6)", {}, positive})};
    const std::string form =
        softness.choice({"form", "\"linear\": f_p = 1 - (1 + Bo) p*/p_mu, without the root"},
                        {"square root", "linear"},
                        "square root");
    if (form == "linear") law.softness_friction->form = SoftnessForm::linear;
  }
  Section cohesion = in.optional_section("law.cohesion_friction", "f_B = 1 + alpha Bo^beta");
  if (cohesion.given()) {
    law.cohesion_friction = {
        cohesion.read<double>({"alpha", "(Shi et al. 2020, table 6)", {}, not_negative}),
        cohesion.read<double>({"beta", "exponent", {}, positive})};
  }
  Section stress = in.optional_section("law.cohesion_stress",
                                       "mu(I) f_p + factor Bo^b p*^g, in place of f_B; without "
                                       "exponents tau = c0 + mu p, c0 = factor f_a/d^2");
  if (stress.given()) {
    law.cohesion_stress = CohesionStress{
        .factor = stress.read<double>({"factor", "c0 over the pull f_a/d^2", {}, not_negative}),
        .bond_exponent = stress.find<double>(
            {"bond_exponent", "b, its tangent beyond Bo = 5", {}, positive}, "1"),
        .softness_exponent = stress.find<double>({"softness_exponent",
                                                  "g, at most b and 1; rigid grains: no cohesion",
                                                  {},
                                                  not_negative},
                                                 "0")};
  }
}

InertialVolumeFraction read_volume_fraction(InputFile& in) {
  Section section = in.section("law.volume_fraction", "phi(I) = phi0 (1 - I/I_phi)");
  return {
      section.read<double>({"phi0", "at I = 0, p* = 0", {}, volume_fraction_bounds}),
      section.read_or<double>({"I_phi", "inf: phi does not depend on I", {}, positive_or_infinite},
                              std::numeric_limits<double>::infinity())};
}

void read_volume_fraction_terms(InputFile& in, MuPhi& law) {
  Section softness =
      in.optional_section("law.softness_volume_fraction", "g_p = 1 + (1 + Bo) p*/p_phi");
  if (softness.given()) {
    law.softness_volume_fraction = {
        softness.read<double>({"p_phi", "(Shi et al. 2020, eq. 14)", {}, positive})};
  }
  Section cohesion = in.optional_section("law.cohesion_volume_fraction",
                                         "g_c = 1 + p1 Bo + p2 Bo^2 + p3 Bo^3 + p4 Bo^4");
  if (cohesion.given()) {
    law.cohesion_volume_fraction = {cohesion.read<double>({"p1", "(Shi et al. 2020, eq. 15)"}),
                                    cohesion.read_or<double>({"p2", "likewise"}, 0.0),
                                    cohesion.read_or<double>({"p3", "likewise"}, 0.0),
                                    cohesion.read_or<double>({"p4", "likewise"}, 0.0)};
  }
}

void read_phi(InputFile& in, MuPhi& law) {
  law.volume_fraction = read_volume_fraction(in);
  read_volume_fraction_terms(in, law);
}

MuPhi read_mu_phi(InputFile& in) {
  MuPhi law;
  const auto tabulated = read_friction_table(in);
  if (in.top().applies(!tabulated)) law.friction = read_friction(in);
  law.friction.tabulated = tabulated;
  read_friction_terms(in, law);
  read_phi(in, law);
  return law;
}

/// Coefficients of phi as functions of the contact friction, [Q_inf, Q_0, mu_p0] each:
/// Q = Q_inf + (Q_0 - Q_inf) exp(-mu_p / mu_p0)  (Shi et al. 2020, eq. 1B), at the table's mu_p.
MuPhi read_phi_of_contact_friction(InputFile& in, double contact_friction) {
  Section section = in.section("law.of_contact_friction",
                               "Q = Q_inf + (Q_0 - Q_inf) exp(-mu_p/mu_p0), at contact_friction");
  const auto read = [&](std::string_view name) {
    const auto q = section.read<std::vector<double>>({name, "[Q_inf, Q_0, mu_p0]"});
    if (q.size() == 3 && q[2] > 0.0)
      return q[0] + (q[1] - q[0]) * std::exp(-contact_friction / q[2]);
    if (section.has(name)) section.problem(name, "must be [Q_inf, Q_0, mu_p0] with mu_p0 > 0");
    return 0.5;
  };
  MuPhi law;
  law.volume_fraction.phi0 = read("phi0");
  law.volume_fraction.I_phi = read("I_phi");
  law.softness_volume_fraction = {read("p_phi")};
  law.cohesion_volume_fraction.emplace();
  law.cohesion_volume_fraction->p1 = read("p1");
  law.cohesion_volume_fraction->p2 = read("p2");
  law.cohesion_volume_fraction->p3 = read("p3");
  law.cohesion_volume_fraction->p4 = read("p4");
  return law;
}

void read_law(InputFile& in, RheologyTable& table) {
  Section section = in.section("law", "The constitutive law");
  const std::string closure =
      section.choice({"closure",
                      "\"bagnold\": tau = tau_c + a gd^2 + b gd at one tilt; \"mu_phi\": "
                      "mu(I, p*, Bo) and phi(I, p*, Bo); \"phi\": the sections of phi only, from "
                      "which no flow follows; \"phi_of_contact_friction\": phi at any mu_p"},
                     {"bagnold", "mu_phi", "phi", "phi_of_contact_friction"});
  if (section.applies(closure == "bagnold")) table.law = read_bagnold(section);
  if (section.applies(closure == "mu_phi")) table.law = read_mu_phi(in);
  table.has_friction = closure == "bagnold" || closure == "mu_phi";
  if (closure == "phi") {  // listed with mu_phi
    MuPhi law;
    read_phi(in, law);
    table.law = law;
  }
  if (section.applies(closure == "phi_of_contact_friction"))
    table.law = read_phi_of_contact_friction(in, table.contact_friction);
}

void read_base(InputFile& in, RheologyTable& table) {
  Section section = in.optional_section(
      "base", "Effective no-slip height of a bumpy base; without it u = 0 at z = 0");
  if (!section.given()) return;
  table.base = EffectiveBase{
      section.read<double>(
          {"no_slip_height", "height at which u = 0", {"grain diameter"}, not_negative}),
      section.read<double>(
          {"mass_below", "flowing mass per area below it", {"density x diameter"}, not_negative}),
      section.read_or<std::string>({"recipe", "base it was measured on"}, "", "not stated")};
}

/// The first thing wrong with a covariance, and the key it is wrong with; empty: nothing.
std::pair<std::string, std::string> covariance_problem(const RheologyTable& table,
                                                       const std::vector<std::string>& names,
                                                       const NumberRows& rows) {
  const std::vector<std::string> known = coefficient_names(table);
  for (const std::string& name : names) {
    if (std::ranges::count(known, name) > 0) continue;
    return {
        "names",
        fmt::format("'{}' is no coefficient of this table; it has {}", name, joined(known, ", "))};
  }
  const std::size_t n = names.size();
  if (rows.size() != n) {
    return {
        "matrix",
        fmt::format("{} names need {} rows, not {}: the matrix is not square", n, n, rows.size())};
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (rows[i].size() != n) {
      return {
          "matrix",
          fmt::format(
              "row {} has {} numbers, not {}: the matrix is not square", i + 1, rows[i].size(), n)};
    }
    if (rows[i][i] < 0.0) {
      return {"matrix", fmt::format("the variance of {} is negative: {}", names[i], rows[i][i])};
    }
  }
  return {};
}

void read_covariance(InputFile& in, RheologyTable& table) {
  Section section = in.optional_section(
      "covariance", "Errors of the coefficients; without it a prediction has no band");
  if (!section.given()) return;
  Covariance covariance;
  covariance.names =
      section.read<std::vector<std::string>>({"names", "coefficients, in this order"});
  const auto rows = section.read<NumberRows>({"matrix", "covariance, symmetric"});
  for (const auto& row : rows)
    covariance.matrix.insert(covariance.matrix.end(), row.begin(), row.end());
  const auto [key, text] = covariance_problem(table, covariance.names, rows);
  if (!text.empty() && section.has("names") && section.has("matrix")) section.problem(key, text);
  table.covariance = std::move(covariance);
}

void read_range(InputFile& in, ValidRange& range) {
  Section section =
      in.optional_section("range", "Where the data lie; a range left out was not explored");
  const auto read = [&](std::string_view key, std::string_view meaning, std::optional<Range>& to) {
    const auto limits =
        section.find<std::vector<double>>({key, meaning, {}, from_to(0.0, INFINITY)});
    if (!limits) return;
    if (limits->size() == 2 && limits->front() <= limits->back()) {
      to = Range{limits->front(), limits->back()};
    } else {
      section.problem(key, fmt::format("'{}' must be [lowest, highest]", key));
    }
  };
  read("inertial_number", "I", range.inertial_number);
  read("softness", "p*", range.softness);
  read("bond_number", "Bo", range.bond_number);
}

void read_words(InputFile& in, RheologyTable& table) {
  Section definitions = in.optional_section("definitions", "Meaning of the numbers, in words");
  Definitions& d = table.definitions;
  d.inertial_number = definitions.read_or<std::string>({"inertial_number", "I"}, d.inertial_number);
  d.pressure = definitions.read_or<std::string>({"pressure", "p"}, d.pressure);
  d.bond_number =
      definitions.read_or<std::string>({"bond_number", "Bo"}, d.bond_number, "no cohesion");
  d.stress = definitions.read_or<std::string>({"stress", "parts of the stress"}, d.stress);
  Section provenance = in.optional_section("provenance", "Where the table comes from");
  using Texts = std::vector<std::string>;
  Provenance& p = table.provenance;
  p.source =
      provenance.read_or<std::string>({"source", "paper and table, or program"}, "", "not stated");
  p.geometry = provenance.read_or<std::string>(
      {"geometry", "of the flow of those runs, as scenes name it"}, "", "not stated");
  p.data = provenance.find<Texts>({"data", "runs it was fitted to"}).value_or(Texts{});
  p.digests = provenance.find<Texts>({"digests", "of the files of those runs, in that order"})
                  .value_or(Texts{});
  p.checked_against =
      provenance.find<Texts>({"checked_against", "runs it was not fitted to"}).value_or(Texts{});
}

/// Every key of a table file, in the order of the key list.
RheologyTable read_keys(InputFile& in) {
  RheologyTable table;
  Section top = in.top();
  table.units = top.choice({"units", "set of a, b and tau_c; all else is dimensionless"},
                           {"grain", "stiffness", "si"},
                           "grain");
  table.contact_friction =
      top.read_or<double>({"contact_friction", "mu_p of the grains", {}, not_negative}, 0.0);
  read_law(in, table);
  read_base(in, table);
  read_covariance(in, table);
  read_range(in, table.range);
  if (const auto* law = std::get_if<MuPhi>(&table.law);
      law && law->friction.tabulated && !table.range.inertial_number)
    table.range.inertial_number =
        Range{law->friction.tabulated->x().front(), law->friction.tabulated->x().back()};
  read_words(in, table);
  return table;
}

RheologyTable read(InputFile in) {
  RheologyTable table = read_keys(in);
  in.finish();
  try {
    validate_coefficients(table);
  } catch (const TableError& error) {
    const std::string_view text = error.what();
    const bool covariance = text.find("covariance") != std::string_view::npos;
    throw InputError(
        in.message(covariance ? "covariance" : "law", covariance ? "matrix" : "", text));
  }
  return table;
}

}  // namespace

RheologyTable read_table(const std::filesystem::path& path) {
  return read(InputFile::open(path));
}

RheologyTable parse_table(const std::string& text, const std::filesystem::path& path) {
  return read(InputFile::from_text(text, path));
}

void write_table(const RheologyTable& table, const std::filesystem::path& path) {
  validate_coefficients(table);
  const std::string text = to_toml(table);
  parse_table(text, path);  // what cannot be read back is not written
  safe_write(path, text);
}

RheologyTable in_grain_units(const RheologyTable& table, const Units& units) {
  RheologyTable result = table;
  auto* law = std::get_if<GeneralisedBagnold>(&result.law);
  if (law == nullptr || table.units == "grain") return result;
  if (table.units != units.name) {
    throw InputError(
        fmt::format("a, b and tau_c of the table are in units = \"{}\", the case is in "
                    "units = \"{}\": give both in the same set, or the table in \"grain\"",
                    table.units,
                    units.name));
  }
  law->a /= units.size(dimension::bagnold_a);
  law->b /= units.size(dimension::bagnold_b);
  law->tau_c /= units.size(dimension::stress);
  result.units = "grain";
  return result;
}

std::string table_keys() {
  InputFile in = InputFile::listing();
  read_keys(in);
  return in.key_list();
}

}  // namespace grainlaw::io
