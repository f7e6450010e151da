#include "apps/io/case_input.h"

#include <numbers>

#include "apps/io/flow_input.h"

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
}

void read_transient(InputFile& in, const Units& units, CaseFile& file) {
  continuum::TransientOptions& options = file.transient;
  Section section =
      in.optional_section("transient", "Start from rest; only with answer = \"start\"");
  const Unit time = units[dimension::time];
  const Key limit{"time_limit", "the start is followed up to here", time, positive};
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
  if (section.given() && file.question == Question::steady) {
    section.problem("", "[transient] has no meaning with answer = \"steady\": leave it out");
  }
}

void read_question(InputFile& in, CaseFile& file) {
  Section top = in.top();
  file.name = top.read_or<std::string>(
      {"name", "of the case"}, in.path().stem().string(), "name of the file");
  const std::string answer =
      top.choice({"answer", "what is asked: the steady flow, or the start from rest of a chute"},
                 {"steady", "start"},
                 "steady");
  file.question = answer == "start" ? Question::start : Question::steady;
}

void read_chute_case(InputFile& in, CaseFile& file) {
  Section chute = in.section("chute", "The inclined layer; or [geometry] for another flow");
  file.units = read_units(in, chute);
  read_question(in, file);
  read_grains(in, file.units, file.chute.grains);
  read_chute(chute, file.units, file);
  read_transient(in, file.units, file);
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

std::string case_keys() {
  InputFile in = InputFile::listing();
  CaseFile file;
  read_keys(in, file);
  return in.key_list();
}

}  // namespace grainlaw::io
