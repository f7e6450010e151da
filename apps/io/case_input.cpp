#include "apps/io/case_input.h"

#include <numbers>

#include "apps/io/flow_input.h"
#include "apps/io/sweep_input.h"

namespace grainlaw::io {
namespace {

void read_grains(InputFile& in, const Units& units, continuum::GrainProperties& grains) {
  Section section = in.optional_section("grains", "The grains: what the set of units does not fix");
  grains.diameter = 1.0;
  grains.density = 6.0 / std::numbers::pi;  // of a sphere of mass 1 and diameter 1
  grains.stiffness = find_stiffness(section, units);
  const Key adhesion{"adhesion", "largest attraction f_a", units[dimension::force], positive};
  grains.adhesion = section.find<double>(adhesion, "cohesionless");
}

void read_chute(Section& section, const Units& units, CaseFile& file) {
  file.chute.inclination = radians(section.read<double>(
      {"inclination", "tilt theta of the base", {"degrees"}, between(-90.0, 90.0)}));
  file.chute.gravity = 1.0;
  const auto mass = section.find<double>({"mass_per_area",
                                          "flowing mass per unit area of the base",
                                          units[dimension::mass_per_area],
                                          positive});
  file.depth = section.find<double>(
      {"depth", "height of the free surface above the base", units[dimension::length], positive});
  section.exactly_one_of({"mass_per_area", "depth"});
  file.chute.mass_per_area = mass.value_or(0.0);
  file.chute.slip_length = section.read_or<double>(
      {"slip_length", "L_s of u = L_s du/dz at the base", units[dimension::length], not_negative},
      0.0,
      "no slip");
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
       "steady flow of another tilt"},
      {"flow", "steady", "start", "step"},
      "flow");
  if (answer == "steady") return Question::steady;
  if (answer == "start") return Question::start;
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
  if (section.given() && file.question == Question::steady) {
    section.problem("", "[transient] has no meaning with answer = \"steady\": leave it out");
  }
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
}

/// A flow without [chute]; only its steady state can be asked.
void read_other_case(InputFile& in, Section& geometry, CaseFile& file) {
  read_flow(in, geometry, file);
  read_question(in, file);
  continuum::GrainProperties grains;
  read_grains(in, file.units, grains);
  if (file.band) file.band->grains = grains;
  if (file.split_bottom) file.split_bottom->grains = grains;
  if (file.question == Question::start)
    in.top().problem("answer", "answer = \"start\" is known for a [chute] only");
  if (file.question == Question::step)
    in.top().problem("answer", "answer = \"step\" is known for a [chute] only");
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
