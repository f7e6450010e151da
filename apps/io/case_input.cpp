#include "apps/io/case_input.h"

#include <cmath>
#include <numbers>

#include "apps/io/flow_input.h"
#include "apps/io/sweep_input.h"

namespace grainlaw::io {
namespace {

/// k_n of the material: the prefactor of Hertz' law between equal spheres, E d / (3 (1 - nu^2))
/// (Brewster et al. 2008, section II), in internal units.
std::optional<double> find_hertz_stiffness(Section& section, const Units& units) {
  const auto modulus =
      section.find<double>({"youngs_modulus",
                            "E of the grains, in place of stiffness: k_n = E d / (3 "
                            "(1 - nu^2)), the prefactor of Hertz",
                            units[dimension::stress],
                            positive});
  const Key ratio{"poisson_ratio", "nu of the grains", {}, between(-1.0, 0.5)};
  const auto nu = section.find<double>(ratio, "required with youngs_modulus");
  if (modulus && !nu) section.report_missing(ratio);
  if (nu && !modulus)
    section.problem("poisson_ratio", "'poisson_ratio' has a meaning with 'youngs_modulus' only");
  if (modulus && units.name == "stiffness")
    section.problem("youngs_modulus",
                    "the set \"stiffness\" fixes k_n: give the whole file in another set of units");
  if (!modulus) return std::nullopt;
  return *modulus / (3.0 * (1.0 - nu.value_or(0.0) * nu.value_or(0.0)));
}

/// f_a of liquid bridges between equal grains, 2 pi r gamma cos(theta), r = d / 2 (Shi et al. 2020,
/// eq. 4), in internal units.
std::optional<double> find_bridge_adhesion(Section& section, const Units& units) {
  const auto tension = section.find<double>({"surface_tension",
                                             "gamma of the liquid between grains, in place of "
                                             "adhesion: f_a = pi d gamma cos(contact_angle)",
                                             units[dimension::tension],
                                             positive});
  const Key wetting{"contact_angle",
                    "of the liquid on the grains",
                    {"degrees"},
                    {.lower = 0.0, .upper = 90.0, .lower_allowed = true}};
  const auto angle = section.find<double>(wetting, "required with surface_tension");
  if (tension && !angle) section.report_missing(wetting);
  if (angle && !tension)
    section.problem("contact_angle", "'contact_angle' has a meaning with 'surface_tension' only");
  if (!tension) return std::nullopt;
  return std::numbers::pi * *tension * std::cos(radians(angle.value_or(0.0)));
}

void read_grains(InputFile& in, const Units& units, continuum::GrainProperties& grains) {
  Section section = in.optional_section("grains", "The grains: what the set of units does not fix");
  grains.diameter = 1.0;
  grains.density = 6.0 / std::numbers::pi;  // of a sphere of mass 1 and diameter 1
  grains.stiffness = find_stiffness(section, units);
  if (const auto hertz = find_hertz_stiffness(section, units)) grains.stiffness = hertz;
  const Key adhesion{"adhesion", "largest attraction f_a", units[dimension::force], positive};
  grains.adhesion = section.find<double>(adhesion, "cohesionless");
  if (const auto bridge = find_bridge_adhesion(section, units)) grains.adhesion = bridge;
  section.at_most_one_of({"stiffness", "youngs_modulus"});
  section.at_most_one_of({"adhesion", "surface_tension"});
}

/// Of tilt, size and flow two, or of tilt and size one where the largest flow is asked.
void check_what_is_given(Section& section, const CaseFile& file) {
  section.at_most_one_of({"mass_per_area", "depth"});
  const bool tilt = section.has("inclination");
  const bool size = section.has("mass_per_area") || section.has("depth");
  const bool flow = section.has("mass_flow");
  if (file.question != Question::largest_flow) {
    if (int{tilt} + int{size} + int{flow} != 2)
      section.problem(flow && tilt && size ? "mass_flow" : "",
                      "exactly two of tilt (inclination), size (mass_per_area or depth) and flow "
                      "(mass_flow) must be given: the third is found");
    return;
  }
  if (flow)
    section.problem("mass_flow", "answer = \"largest_flow\" looks for the flow: leave it out");
  if (tilt == size)
    section.problem(
        "",
        "answer = \"largest_flow\" takes either the tilt (inclination), for the "
        "largest over all depths, or the size (mass_per_area or depth), for the largest "
        "over all tilts");
}

void read_chute(Section& section, const Units& units, CaseFile& file) {
  constexpr auto third = "two of tilt, size and mass_flow are given";
  const auto tilt = section.find<double>(
      {"inclination", "tilt theta of the base", {"degrees"}, between(-90.0, 90.0)}, third);
  file.tilt_sought = !tilt;
  file.chute.inclination = radians(tilt.value_or(0.0));
  file.chute.gravity = 1.0;
  const auto mass = section.find<double>({"mass_per_area",
                                          "size: flowing mass per unit area of the base",
                                          units[dimension::mass_per_area],
                                          positive},
                                         third);
  file.depth = section.find<double>({"depth",
                                     "size: height of the free surface above the base",
                                     units[dimension::length],
                                     positive},
                                    third);
  file.mass_flow = section.find<double>({"mass_flow",
                                         "int rho u dz downhill, mass per time and unit width",
                                         units[dimension::mass_flow],
                                         positive},
                                        third);
  file.chute.mass_per_area = mass.value_or(0.0);
  file.chute.slip_length = section.read_or<double>(
      {"slip_length", "L_s of u = L_s du/dz at the base", units[dimension::length], not_negative},
      0.0,
      "no slip");
  check_what_is_given(section, file);
}

void read_walls(InputFile& in, const Units& units, continuum::ChuteCase& chute) {
  Section section =
      in.optional_section("walls", "Side walls that the grains slide along; without it none");
  if (!section.given()) return;
  continuum::SideWalls walls;
  walls.width =
      section.read<double>({"width", "between the walls", units[dimension::length], positive});
  walls.friction = section.read<double>({"friction", "mu_w of grains on a wall", {}, positive});
  walls.pressure_ratio =
      section.read<double>({"pressure_ratio",
                            "sigma_yy / sigma_zz at the walls, about 0.85 in dense flow",
                            {},
                            positive});
  chute.walls = walls;
}

/// Tilts that follow the first: two lists of equal length.
void read_tilts(Section& section, const Unit& time, continuum::TransientOptions& options) {
  const auto times = section.find<std::vector<double>>(
      {"tilt_times", "the tilt changes at, ascending", time, positive}, "the tilt stays");
  const auto tilts = section.find<std::vector<double>>(
      {"tilts", "tilt from then on", {"degrees"}, between(-90.0, 90.0)}, "the tilt stays");
  if (section.has("tilt_times") && !times) return;  // a wrong value: said already
  if (section.has("tilts") && !tilts) return;
  const std::size_t count = times ? times->size() : 0;
  if (count != (tilts ? tilts->size() : 0)) {
    section.problem(tilts ? "tilts" : "tilt_times", "tilt_times and tilts must be equally long");
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && !((*times)[i] > (*times)[i - 1]))
      section.problem("tilt_times", "the times of tilt_times must ascend");
    options.tilts.push_back({(*times)[i], radians((*tilts)[i])});
  }
}

Question question(Section& top) {
  const std::string answer = top.choice(
      {"answer",
       "\"flow\": the steady flow, by time integration from rest and by quadrature; \"steady\": by "
       "quadrature alone; \"start\": the time-dependent flow from rest; \"step\": that from the "
       "steady flow of another tilt; \"largest_flow\": the largest steady mass flow over all tilts "
       "of a size or all depths at a tilt"},
      {"flow", "steady", "start", "step", "largest_flow"},
      "flow");
  if (answer == "steady") return Question::steady;
  if (answer == "start") return Question::start;
  if (answer == "largest_flow") return Question::largest_flow;
  return answer == "step" ? Question::step : Question::flow;
}

void read_transient(InputFile& in, const Units& units, CaseFile& file) {
  continuum::TransientOptions& options = file.transient;
  Section section =
      in.optional_section("transient", "Time integration; not with answer = \"steady\"");
  const Unit time = units[dimension::time];
  const Key limit{"time_limit", "the flow is followed up to here", time, positive};
  options.time_limit =
      section.find<double>(limit, "from the relaxation time").value_or(options.time_limit);
  options.output_times =
      section
          .find<std::vector<double>>({"output_times", "profiles are wanted at", time, not_negative},
                                     "only the last profile")
          .value_or(options.output_times);
  options.relative_tolerance = section.read_or<double>(
      {"relative_tolerance", "of the time integration", {}, between(1e-14, 1e-1)},
      options.relative_tolerance);
  options.cells = static_cast<int>(section.read_or<std::int64_t>(
      {"cells", "of the mass coordinate", {}, from_to(4, 100000)}, options.cells));
  const auto delta = section.find<double>(
      {"yield_regularisation",
       "delta of tau_y q/sqrt(q^2 + delta^2) in place of an exact yield stress, to study its error",
       {},
       positive},
      "yield is exact");
  options.yield_regularisation = delta.value_or(0.0);
  read_tilts(section, time, options);
  const Key before{
      "inclination_before",
      "with answer = \"step\": the flow at the beginning is the steady one of this tilt",
      {"degrees"},
      between(-90.0, 90.0)};
  const auto tilt_before = section.find<double>(before, "required with answer = \"step\"");
  if (tilt_before) options.inclination_before = radians(*tilt_before);
  if (file.question == Question::step && !tilt_before) section.report_missing(before);
  if (file.question != Question::step && tilt_before) {
    section.problem(
        "inclination_before",
        "'inclination_before' belongs to answer = \"step\": the layer starts from rest");
  }
  if (file.question == Question::flow && !options.tilts.empty()) {
    section.problem("tilts",
                    "a steady flow has one tilt: 'tilts' needs answer = \"start\" or \"step\"");
  }
  if (section.given() && file.question == Question::steady)
    section.problem("", "[transient] has no meaning with answer = \"steady\": leave it out");
  if (section.given() && file.question == Question::largest_flow)
    section.problem("", "[transient] has no meaning with answer = \"largest_flow\": leave it out");
}

void read_question(InputFile& in, CaseFile& file) {
  Section top = in.top();
  file.name = top.read_or<std::string>(
      {"name", "of the case"}, in.path().stem().string(), "name of the file");
  file.question = question(top);
}

void read_chute_case(InputFile& in, CaseFile& file) {
  Section chute = in.section("chute", "The inclined layer; or [geometry] for another flow");
  file.units = read_units(in, chute);
  read_question(in, file);
  read_grains(in, file.units, file.chute.grains);
  read_chute(chute, file.units, file);
  read_walls(in, file.units, file.chute);
  read_transient(in, file.units, file);
  read_sweep(in, file);
  if (file.sweep && (file.tilt_sought || file.mass_flow))
    chute.problem("", "a sweep takes the tilt and the size of every layer: give both here");
}

/// A flow without [chute]; only its steady state can be asked.
void read_other_case(InputFile& in, Section& geometry, CaseFile& file) {
  read_flow(in, geometry, file);
  read_question(in, file);
  continuum::GrainProperties grains;
  read_grains(in, file.units, grains);
  if (file.band) file.band->grains = grains;
  if (file.split_bottom) file.split_bottom->grains = grains;
  if (file.ring_cell) file.ring_cell->cell.grains = grains;
  if (file.question == Question::start)
    in.top().problem("answer", "answer = \"start\" is known for a [chute] only");
  if (file.question == Question::step)
    in.top().problem("answer", "answer = \"step\" is known for a [chute] only");
  if (file.question == Question::largest_flow)
    in.top().problem("answer", "answer = \"largest_flow\" is known for a [chute] only");
}

void read_keys(InputFile& in, CaseFile& file) {
  Section geometry = in.optional_section("geometry", "A flow other than a chute, in its place");
  if (geometry.applies(!geometry.given())) read_chute_case(in, file);
  if (geometry.given()) read_other_case(in, geometry, file);
}

CaseFile read(InputFile in) {
  CaseFile file;
  read_keys(in, file);
  in.finish();
  file.text = in.text();
  file.path = in.path();
  return file;
}

}  // namespace

CaseFile read_case(const std::filesystem::path& path) {
  return read(InputFile::open(path));
}

CaseFile parse_case(const std::string& text, const std::filesystem::path& path) {
  return read(InputFile::from_text(text, path));
}

std::string case_message(const CaseFile& file,
                         std::string_view section,
                         std::string_view key,
                         std::string_view text) {
  return InputFile::from_text(file.text, file.path).message(section, key, text);
}

std::string case_keys() {
  InputFile in = InputFile::listing();
  CaseFile file;
  read_keys(in, file);
  return in.key_list();
}

}  // namespace grainlaw::io
