#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/io/rheology_table_toml.h"

namespace grainlaw::io {
namespace {

using namespace continuum;

/// The fewest digits that give the same bits, always as a TOML float (5 is written 5.0).
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += fmt::format("\\{}", c);
    } else if (code < 0x20 || code == 0x7f) {
      out += fmt::format("\\u{:04x}", code);
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string list(const std::vector<std::string>& texts) {
  std::vector<std::string> items;
  items.reserve(texts.size());
  for (const std::string& text : texts) items.push_back(in_quotes(text));
  return fmt::format("[{}]", joined(items, ", "));
}

std::string list(const std::vector<double>& values) {
  std::vector<std::string> items;
  for (const double value : values) items.push_back(number(value));
  return fmt::format("[{}]", joined(items, ", "));
}

/// Sections and lines of a TOML file.
class TomlText {
 public:
  explicit TomlText(std::string heading) : text_(std::move(heading)) {}
  void section(std::string_view name) { text_ += fmt::format("\n[{}]\n", name); }
  void line(std::string_view key, const std::string& value, std::string_view comment = {}) {
    text_ += fmt::format("{} = {}{}{}\n", key, value, comment.empty() ? "" : "  # ", comment);
  }
  void line(std::string_view key, double value, std::string_view comment = {}) {
    line(key, number(value), comment);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void write_law(TomlText& out, const GeneralisedBagnold& law) {
  out.section("law");
  out.line("closure", in_quotes("bagnold"), "|tau| = tau_c + a gd^2 + b gd, at this tilt only");
  out.line("a", law.a, "mass/length");
  out.line("b", law.b, "mass/(length time)");
  out.line("tau_c", law.tau_c, "mass/(length time^2)");
  out.line("volume_fraction", law.volume_fraction);
  if (const auto tilt = exact_degrees(law.inclination)) {
    out.line("inclination", *tilt, "degrees");
  } else {
    out.line("inclination_radians",
             law.inclination,
             fmt::format("{:.6g} degrees", degrees(law.inclination)));
  }
}

/// A term the law has, though it may be zero.
bool covers(const std::optional<Covariance>& covariance, const std::string& name) {
  if (!covariance) return false;
  const auto& names = covariance->names;
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Powers of Bo up to the last that is there.
void write_cohesion(TomlText& out,
                    const CohesionVolumeFraction& law,
                    const std::optional<Covariance>& covariance) {
  const std::array<double, 4> powers{law.p1, law.p2, law.p3, law.p4};
  std::size_t count = powers.size();
  const auto name = [](std::size_t k) { return fmt::format("p{}", k + 1); };
  while (count > 1 && powers[count - 1] == 0.0 && !covers(covariance, name(count - 1))) --count;
  out.section("law.cohesion_volume_fraction");
  for (std::size_t k = 0; k < count; ++k) {
    out.line(name(k), powers[k], k == 0 ? "g_c = 1 + p1 Bo + p2 Bo^2 + ..." : "");
  }
}

void write_inertial(TomlText& out, const MuPhi& law, const std::optional<Covariance>& covariance) {
  if (const auto& table = law.friction.tabulated) {
    out.section("law.friction_table");
    out.line("inertial_number", list(table->x()), "mu(I): monotone cubic, held beyond the ends");
    out.line("friction", list(table->y()));
    return;
  }
  out.section("law.friction");
  const bool curved = law.friction.kappa != 0.0 || covers(covariance, "kappa");
  out.line("mu0",
           law.friction.mu0,
           curved ? "mu(I) = mu0 + beta I/(1 + kappa I)" : "mu(I) = mu0 + beta I");
  out.line("beta", law.friction.beta);
  if (curved) out.line("kappa", law.friction.kappa);
  if (law.friction.exponent) out.line("exponent", *law.friction.exponent, "I^exponent for I");
}

void write_friction(TomlText& out, const MuPhi& law, const std::optional<Covariance>& covariance) {
  write_inertial(out, law, covariance);
  if (const auto& softness = law.softness_friction) {
    out.section("law.softness_friction");
    const bool linear = softness->form == SoftnessForm::linear;
    out.line("p_mu",
             softness->p_mu,
             linear ? "f_p = 1 - (1 + Bo) p*/p_mu" : "f_p = 1 - sqrt((1 + Bo) p*/p_mu)");
    if (linear) out.line("form", in_quotes("linear"));
  }
  if (const auto& cohesion = law.cohesion_friction) {
    out.section("law.cohesion_friction");
    out.line("alpha", cohesion->alpha, "f_B = 1 + alpha Bo^beta");
    out.line("beta", cohesion->beta);
  }
  if (const auto& cohesion = law.cohesion_stress) {
    out.section("law.cohesion_stress");
    const bool power = cohesion->bond_exponent || cohesion->softness_exponent;
    out.line("factor",
             cohesion->factor,
             power ? "mu(I) f_p + factor Bo^b p*^g" : "tau = factor f_a/d^2 + mu p");
    if (const auto& b = cohesion->bond_exponent) out.line("bond_exponent", *b, "b");
    if (const auto& g = cohesion->softness_exponent) out.line("softness_exponent", *g, "g");
  }
}

void write_volume_fraction(TomlText& out,
                           const MuPhi& law,
                           const std::optional<Covariance>& covariance) {
  const bool varies = std::isfinite(law.volume_fraction.I_phi);
  out.section("law.volume_fraction");
  out.line("phi0", law.volume_fraction.phi0, varies ? "phi(I) = phi0 (1 - I/I_phi)" : "");
  if (varies) out.line("I_phi", law.volume_fraction.I_phi);
  if (const auto& softness = law.softness_volume_fraction) {
    out.section("law.softness_volume_fraction");
    out.line("p_phi", softness->p_phi, "g_p = 1 + (1 + Bo) p*/p_phi");
  }
  if (const auto& cohesion = law.cohesion_volume_fraction) {
    write_cohesion(out, *cohesion, covariance);
  }
}

void write_law(TomlText& out, const GeneralisedBagnold& law, const RheologyTable&) {
  write_law(out, law);
}

void write_law(TomlText& out, const MuPhi& law, const RheologyTable& table) {
  out.section("law");
  if (table.has_friction) {
    out.line("closure", in_quotes("mu_phi"), "mu(I, p*, Bo) and phi(I, p*, Bo)");
    write_friction(out, law, table.covariance);
  } else {
    out.line("closure", in_quotes("phi"), "phi(I, p*, Bo) only: no flow follows");
  }
  write_volume_fraction(out, law, table.covariance);
}

void write_covariance(TomlText& out, const Covariance& covariance) {
  const std::size_t n = covariance.names.size();
  std::string rows = "[\n";
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::string> row;
    for (std::size_t j = 0; j < n; ++j) row.push_back(number(covariance(i, j)));
    rows += fmt::format("  [{}],\n", joined(row, ", "));
  }
  out.section("covariance");
  out.line("names", list(covariance.names));
  out.line("matrix", rows + "]");
}

void write_range(TomlText& out, const ValidRange& range) {
  const auto write = [&](std::string_view key, const std::optional<Range>& limits) {
    if (!limits) return;
    out.line(key, fmt::format("[{}, {}]", number(limits->lower), number(limits->upper)));
  };
  out.section("range");
  write("inertial_number", range.inertial_number);
  write("softness", range.softness);
  write("bond_number", range.bond_number);
}

void write_words(TomlText& out, const Definitions& definitions, const Provenance& provenance) {
  out.section("definitions");
  out.line("inertial_number", in_quotes(definitions.inertial_number));
  out.line("pressure", in_quotes(definitions.pressure));
  out.line("bond_number", in_quotes(definitions.bond_number));
  out.line("stress", in_quotes(definitions.stress));
  out.section("provenance");
  out.line("source", in_quotes(provenance.source));
  if (!provenance.geometry.empty()) out.line("geometry", in_quotes(provenance.geometry));
  out.line("data", list(provenance.data));
  if (!provenance.digests.empty()) out.line("digests", list(provenance.digests));
  out.line("checked_against", list(provenance.checked_against));
}

}  // namespace

std::string to_toml(const RheologyTable& table) {
  TomlText out("# Rheology table of grainlaw. Sections and keys: docs/formats.md.\n");
  out.line("units", in_quotes(table.units));
  out.line("contact_friction", table.contact_friction, "mu_p");
  std::visit([&](const auto& law) { write_law(out, law, table); }, table.law);
  if (table.base) {
    out.section("base");
    out.line("no_slip_height", table.base->no_slip_height, "grain diameters");
    out.line("mass_below", table.base->mass_below, "grain density x diameter");
    out.line("recipe", in_quotes(table.base->recipe));
  }
  if (table.covariance) write_covariance(out, *table.covariance);
  write_range(out, table.range);
  write_words(out, table.definitions, table.provenance);
  return out.text();
}

}  // namespace grainlaw::io
