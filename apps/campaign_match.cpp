#include "apps/campaign_match.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/compare_runs.h"
#include "dem/run.h"

namespace grainlaw {
namespace {

/// Equal but for the rounding of files.
bool equal(double a, double b) {
  return std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b));
}

bool same_tilt(double a, double b) {
  return std::abs(a - b) < 1e-9;
}

/// Runs of other programs: their base is their own, and numbers were rounded on the way.
bool same_grains_elsewhere(const dem::ChuteConditions& a, const dem::ChuteConditions& b) {
  return equal(a.grain_diameter, b.grain_diameter) && equal(a.grain_density, b.grain_density) &&
         equal(a.stiffness, b.stiffness) && equal(a.contact_friction, b.contact_friction);
}

bool same_chute(const io::RunRecord& record, const io::PlannedRun& run) {
  const dem::ChuteConditions& found = record.data.conditions;
  const dem::ChuteConditions expected = dem::conditions(run.file.scene);
  if (expected.geometry != "chute" || !same_tilt(found.inclination, expected.inclination)) {
    return false;
  }
  if (!record.imported_from.empty()) {
    return same_grains_elsewhere(found, expected) &&
           equal(found.mass_per_area, expected.mass_per_area);
  }
  return same_grains(found, expected) && found.mass_per_area == expected.mass_per_area;
}

/// All numbers of a law.
std::vector<double> parameters(const dem::Hooke& law) {
  return {law.stiffness, law.damping, law.dashpot, law.root_damping};
}
std::vector<double> parameters(const dem::Hertz& law) {
  return {law.stiffness, law.damping, law.dashpot};
}
std::vector<double> parameters(const dem::Frictionless&) {
  return {};
}
std::vector<double> parameters(const dem::Sliding& law) {
  return {law.coefficient, law.stiffness, law.damping, law.dashpot};
}
std::vector<double> parameters(const dem::StickSlip& law) {
  return {law.coefficient, law.stiffness, law.damping, law.dashpot, law.static_coefficient};
}
/// Without the strength, which Bo tells.
std::vector<double> parameters(const dem::Cohesionless&) {
  return {};
}
std::vector<double> parameters(const dem::GaussianWell& law) {
  return {law.width, static_cast<double>(law.reference)};
}
std::vector<double> parameters(const dem::ReversibleAdhesion& law) {
  return {law.slope, static_cast<double>(law.reference)};
}
std::vector<double> parameters(const dem::LiquidBridge& law) {
  return {law.contact_angle, law.volume, static_cast<double>(law.reference)};
}

template <class Law>
bool same_law(const Law& a, const Law& b) {
  const auto numbers = [](const Law& law) {
    return std::visit([](const auto& one) { return parameters(one); }, law);
  };
  return a.index() == b.index() && std::ranges::equal(numbers(a), numbers(b), equal);
}

bool same_laws(const dem::Scene& a, const dem::Scene& b) {
  return equal(a.grains.size_ratio, b.grains.size_ratio) && same_law(a.normal, b.normal) &&
         same_law(a.friction, b.friction) && same_law(a.cohesion, b.cohesion);
}

/// As measured; as the scene set them where nothing was.
io::BoxState state_of(const dem::LocalData& data, const dem::Scene& scene) {
  if (data.rows.empty()) return io::box_state(scene);
  const dem::LocalRow& row = data.rows[data.rows.size() / 2];
  const double d = data.conditions.grain_diameter;
  return {.inertial_number = row.inertial_number.value,
          .softness = row.softness.value,
          .bond_number = data.conditions.attraction / (row.normal_stress.value * d * d)};
}

bool near(const io::BoxState& a, const io::BoxState& b) {
  constexpr double much = 0.05;  // the servo of a box holds its pressure within 1 %
  const auto close = [](double x, double y) { return std::abs(x - y) <= much * std::abs(y); };
  return close(a.inertial_number, b.inertial_number) && close(a.softness, b.softness) &&
         close(a.bond_number, b.bond_number);
}

/// The scene of a run of ours in a box at a pressure.
std::optional<dem::Scene> box_scene(const io::RunRecord& record) {
  if (!record.imported_from.empty() || record.data.conditions.geometry != "simple_shear") return {};
  dem::Scene scene = io::parse_scene(record.scene_text, record.data.name).scene;
  const auto& box = std::get<dem::SimpleShear>(scene.geometry);
  return box.pressure && *box.pressure > 0.0 ? std::optional(std::move(scene)) : std::nullopt;
}

bool same_box(const io::RunRecord& record, const dem::Scene& scene, const io::PlannedRun& run) {
  if (!std::holds_alternative<dem::SimpleShear>(run.file.scene.geometry)) return false;
  const io::BoxState planned = io::box_state(run.file.scene);
  return same_laws(scene, run.file.scene) &&
         (near(io::box_state(scene), planned) || near(state_of(record.data, scene), planned));
}

}  // namespace

const io::PlannedRun* planned_for(const io::RunRecord& record,
                                  const std::vector<io::PlannedRun>& planned,
                                  bool by_name) {
  const std::optional<dem::Scene> box = box_scene(record);
  const bool chute = record.data.conditions.geometry == "chute";
  const auto found = std::ranges::find_if(planned, [&](const io::PlannedRun& run) {
    if (by_name && record.data.name != run.file.scene.name) return false;
    return chute ? same_chute(record, run) : box && same_box(record, *box, run);
  });
  return found == planned.end() ? nullptr : &*found;
}

}  // namespace grainlaw
