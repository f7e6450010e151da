#include "apps/compare_cases.h"

#include "apps/io/scene_input.h"
#include "calibration/comparison.h"

namespace grainlaw {
namespace {

double mass_per_area(const dem::Scene& scene,
                     const dem::LocalData& data,
                     double length,
                     double width) {
  return data.summary.flowing_grains * scene.grains.mean_mass() / (length * width);
}

/// Where the gap is held: of the uppermost row clear of the wall.
double measured_load(const dem::LocalData& data) {
  const calibration::MeasuredRows rows = calibration::measured_rows(data);
  for (std::size_t k = rows.rows.size(); k-- > 0;) {
    if (rows.dense[k]) return rows.rows[k].normal_stress.value;
  }
  throw io::InputError("run '" + data.name +
                       "': no row is clear of the upper wall to take the "
                       "load from");
}

continuum::PlaneShear plane_shear(const dem::PlaneShear& shear,
                                  const dem::Scene& scene,
                                  const dem::LocalData& data) {
  continuum::PlaneShear flow;
  flow.drive.velocity = shear.velocity;
  flow.extent.mass_per_area = mass_per_area(scene, data, shear.length, shear.width);
  flow.load = shear.load ? *shear.load : measured_load(data);
  flow.gravity = shear.gravity;
  return flow;
}

continuum::BodyForceBox body_force_box(const dem::BodyForceBox& box,
                                       const dem::Scene& scene,
                                       const dem::LocalData& data) {
  continuum::BodyForceBox flow;
  flow.extent.mass_per_area = mass_per_area(scene, data, box.length, box.width);
  flow.amplitude = box.amplitude;
  flow.pressure = box.pressure;
  return flow;
}

}  // namespace

dem::Scene scene_of(const io::RunRecord& record) {
  return io::parse_scene(
             record.scene_text, record.data.name + " (scene)", {.allow_unstable_step = true})
      .scene;
}

continuum::GrainProperties grains_of(const dem::ChuteConditions& conditions) {
  continuum::GrainProperties grains{.diameter = conditions.grain_diameter,
                                    .density = conditions.grain_density};
  if (conditions.stiffness > 0.0) grains.stiffness = conditions.stiffness;
  if (conditions.attraction > 0.0) grains.adhesion = conditions.attraction;
  return grains;
}

continuum::ShearBandCase band_case(const dem::Scene& scene, const dem::LocalData& data) {
  continuum::ShearBandCase band;
  band.grains = grains_of(data.conditions);
  if (const auto* shear = std::get_if<dem::PlaneShear>(&scene.geometry)) {
    band.flow = plane_shear(*shear, scene, data);
  } else if (const auto* box = std::get_if<dem::BodyForceBox>(&scene.geometry)) {
    band.flow = body_force_box(*box, scene, data);
  } else {
    throw io::InputError("run '" + data.name + "' is no plane shear and no body-force box");
  }
  return band;
}

calibration::RingCell ring_cell(const dem::Scene& scene) {
  const auto& cell = std::get<dem::SplitBottom>(scene.geometry);
  return {.inner_radius = cell.inner_radius,
          .split_radius = cell.split_radius,
          .outer_radius = cell.outer_radius,
          .rotation_rate = cell.rotation_rate};
}

continuum::RingFlowCase ring_flow_case(const dem::Scene& scene,
                                       const dem::LocalData& data,
                                       const calibration::RingBand& measured) {
  const auto& cell = std::get<dem::SplitBottom>(scene.geometry);
  continuum::RingFlowCase ring;
  ring.cell.split_radius = cell.split_radius;
  ring.cell.depth = measured.height;
  ring.cell.rotation_rate = cell.rotation_rate;
  ring.cell.gravity = cell.gravity;
  ring.cell.grains = grains_of(data.conditions);
  ring.inner_radius = cell.inner_radius;
  ring.outer_radius = cell.outer_radius;
  return ring;
}

}  // namespace grainlaw
