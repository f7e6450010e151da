#include "apps/io/units.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace grainlaw::io {
namespace {

/// Powers of one sign, "length time^2"; sign = 1 takes the positive exponents, -1 the negative.
std::vector<std::string> factors(Dimension d, const std::array<std::string, 3>& symbols, int sign) {
  std::vector<std::string> out;
  const std::array<int, 3> exponents{d.mass, d.length, d.time};
  for (std::size_t k = 0; k < 3; ++k) {
    const int power = sign * exponents[k];
    if (power == 1) out.push_back(symbols[k]);
    if (power > 1) out.push_back(fmt::format("{}^{}", symbols[k], power));
  }
  return out;
}

/// A product of powers such as "mass/(length time^2)"; "1" when all exponents are zero.
std::string product(Dimension d, const std::array<std::string, 3>& symbols) {
  const std::vector<std::string> above = factors(d, symbols, 1);
  const std::vector<std::string> below = factors(d, symbols, -1);
  std::string numerator = above.empty() ? "1" : joined(above, " ");
  if (below.empty()) return numerator;
  if (below.size() == 1) return fmt::format("{}/{}", numerator, below.front());
  return fmt::format("{}/({})", numerator, joined(below, " "));
}

/// What people call a unit, where that is not the product of powers.
struct UsualName {
  const char* set;
  Dimension dimension;
  const char* symbol;
};
constexpr auto usual_names = std::to_array<UsualName>({
    {"grain", dimension::velocity, "sqrt(g d)"},
    {"grain", dimension::time, "sqrt(d/g)"},
    {"grain", dimension::rate, "sqrt(g/d)"},
    {"grain", dimension::flux, "d sqrt(g d)"},
    {"grain", dimension::mass_flow, "m sqrt(g/d)/d"},
    {"grain", dimension::stiffness, "m g/d"},
    {"grain", dimension::stress, "m g/d^2"},
    {"grain", dimension::force, "m g"},
    {"grain", dimension::energy, "m g d"},
    {"stiffness", dimension::stress, "k_n/d"},
    {"stiffness", dimension::stiffness, "k_n"},
    {"si", dimension::stress, "Pa"},
    {"si", dimension::stiffness, "N/m"},
    {"si", dimension::force, "N"},
    {"si", dimension::energy, "N m"},
});

/// One line of the table of what a named set fixes.
struct FixedKey {
  const char* set;
  const char* key;
  const char* sentence;
};
constexpr auto fixed_keys = std::to_array<FixedKey>({
    {"grain", "diameter", "is 1 in units = \"grain\", whose length is the grain diameter"},
    {"grain", "density", "is 6/pi in units = \"grain\", whose mass is the mass of a grain"},
    {"grain", "gravity", "is 1 in units = \"grain\", whose acceleration is gravity"},
    {"stiffness", "diameter", "is 1 in units = \"stiffness\", whose length is the grain diameter"},
    {"stiffness", "density", "is 1 in units = \"stiffness\", whose density is that of the grains"},
    {"stiffness", "stiffness", "is 1 in units = \"stiffness\", that of the contact"},
});

const FixedKey* fixed(const std::string& set, std::string_view key) {
  for (const FixedKey& line : fixed_keys) {
    if (set == line.set && key == line.key) return &line;
  }
  return nullptr;
}

/// A key that some sets fix: refused there, where it is 1; otherwise what the file says.
std::optional<double> find_unless_fixed(Section& section, const std::string& set, const Key& key) {
  const auto value = section.find<double>(key, "required, unless the set of units fixes it");
  const FixedKey* line = fixed(set, key.name);
  if (line == nullptr) return value;
  if (section.has(key.name)) {
    section.problem(key.name,
                    fmt::format("'{}' {}: leave it out, or give the whole file in another set",
                                key.name,
                                line->sentence));
  }
  return 1.0;
}

double read_unless_fixed(Section& section, const std::string& set, const Key& key) {
  const auto value = find_unless_fixed(section, set, key);
  if (!value) section.report_missing(key);
  return value.value_or(1.0);
}

Key stiffness_key(const Units& units) {
  return {"stiffness", "normal contact stiffness k_n", units[dimension::stiffness], positive};
}

/// What a file says of its units beside gravity.
struct SetOfUnits {
  std::string name;
  double diameter = 1.0;
  double density = 1.0;
};

/// Mass and stiffness of everything else are counted in those of a grain.
void refuse_immeasurable(Section& grains, const SetOfUnits& read) {
  const double mass =
      read.density * std::numbers::pi / 6.0 * read.diameter * read.diameter * read.diameter;
  if (std::isnormal(mass)) return;
  grains.problem("diameter",
                 fmt::format("a grain of diameter {:.4g} and density {:.4g} has a mass of {:.4g}: "
                             "no number to count in",
                             read.diameter,
                             read.density,
                             mass));
}

SetOfUnits read_set(InputFile& in) {
  SetOfUnits read;
  read.name = in.top().choice(
      {"units",
       "set of all numbers in the file: \"grain\" (grain mass m, diameter d, gravity g are 1), "
       "\"stiffness\" (grain density, diameter, contact stiffness are 1), \"si\" (kg, m, s)"},
      {"grain", "stiffness", "si"});
  constexpr auto meaning = "The grains: what the set of units does not fix";
  Section grains =
      read.name == "si" ? in.section("grains", meaning) : in.optional_section("grains", meaning);
  const Key diameter{"diameter", "mean grain diameter d", {"length"}, positive};
  const Key density{"density", "grain density rho_p", {"mass/length^3"}, positive};
  read.diameter = read_unless_fixed(grains, read.name, diameter);
  read.density = read_unless_fixed(grains, read.name, density);
  refuse_immeasurable(grains, read);
  return read;
}

Units units_of(const SetOfUnits& read, double gravity) {
  if (read.name == "si") return si_units(read.diameter, read.density, gravity);
  return read.name == "stiffness" ? stiffness_units(gravity) : Units{};
}

}  // namespace

double Units::size(Dimension d) const {
  return std::pow(mass, d.mass) * std::pow(length, d.length) * std::pow(time, d.time);
}

Unit Units::operator[](Dimension d) const {
  const std::string words = product(d, {"mass", "length", "time"});
  return {words == "1" ? "" : words, size(d)};
}

std::string Units::symbol(Dimension d) const {
  for (const UsualName& usual : usual_names) {
    if (name == usual.set && d == usual.dimension) return usual.symbol;
  }
  if (name == "si") return product(d, {"kg", "m", "s"});
  return product(d, {"m", "d", "t"});
}

std::string Units::symbols() const {
  if (name == "si") return "SI: kg, m, s";
  if (name == "stiffness") {
    return "stiffness: m = rho_p d^3, d = grain diameter, t = sqrt(rho_p d^3 / k_n)";
  }
  return "grain: m = mass of a grain, d = grain diameter, t = sqrt(d/g)";
}

Units si_units(double diameter, double density, double gravity) {
  const double volume = std::numbers::pi / 6.0 * diameter * diameter * diameter;
  return {"si", diameter, density * volume, std::sqrt(diameter / gravity)};
}

Units stiffness_units(double gravity) {
  return {"stiffness", 1.0, std::numbers::pi / 6.0, std::sqrt(1.0 / gravity)};
}

Units read_units(InputFile& in, Section& with_gravity) {
  const SetOfUnits read = read_set(in);
  const Key gravity{"gravity", "g", {"length/time^2"}, positive};
  return units_of(read, read_unless_fixed(with_gravity, read.name, gravity));
}

Units read_units(InputFile& in) {
  const SetOfUnits read = read_set(in);
  return units_of(read, read.name == "si" ? 9.81 : 1.0);
}

std::optional<double> find_stiffness(Section& section, const Units& units) {
  const auto value = find_unless_fixed(section, units.name, stiffness_key(units));
  return units.name == "stiffness" ? 1.0 / units.size(dimension::stiffness) : value;
}

double read_stiffness(Section& section, const Units& units) {
  const auto value = find_stiffness(section, units);
  if (!value) section.report_missing(stiffness_key(units));
  return value.value_or(1.0);
}

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}
double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

std::optional<double> exact_degrees(double tilt) {
  const double near = degrees(tilt);
  for (int digits = 1; digits <= 17; ++digits) {
    const double candidate = std::stod(fmt::format("{:.{}g}", near, digits));
    if (radians(candidate) == tilt) return candidate;
  }
  for (const double towards : {0.0, 360.0}) {
    const double candidate = std::nextafter(near, towards);
    if (radians(candidate) == tilt) return candidate;
  }
  return std::nullopt;
}

}  // namespace grainlaw::io
