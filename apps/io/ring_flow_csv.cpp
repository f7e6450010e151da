#include "apps/io/ring_flow_csv.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

namespace grainlaw::io {
namespace {

using continuum::RingFlowRow;
using nlohmann::ordered_json;

struct Column {
  const char* name;
  double RingFlowRow::*member;
  Dimension dimension;
};
constexpr auto columns = std::to_array<Column>({
    {"z", &RingFlowRow::z, dimension::length},
    {"centre", &RingFlowRow::centre, dimension::length},
    {"width", &RingFlowRow::width, dimension::length},
    {"shear_rate", &RingFlowRow::shear_rate, dimension::rate},
    {"pressure", &RingFlowRow::pressure, dimension::stress},
    {"friction", &RingFlowRow::friction, dimension::number},
    {"inertial_number", &RingFlowRow::inertial_number, dimension::number},
    {"volume_fraction", &RingFlowRow::volume_fraction, dimension::number},
});

ordered_json scaled(const std::vector<double>& values, double size) {
  ordered_json result = ordered_json::array();
  for (const double value : values) result.push_back(value * size);
  return result;
}

}  // namespace

std::string ring_flow_csv(const continuum::RingFlow& flow,
                          double rotation_rate,
                          const Units& units) {
  const double length = units.size(dimension::length), velocity = units.size(dimension::velocity);
  std::string out = fmt::format("# {}: {}\n# units {}\nz [{}],r [{}],rotation [1],velocity [{}]\n",
                                continuum::name(flow.answer.outcome),
                                flow.answer.text,
                                units.symbols(),
                                units.symbol(dimension::length),
                                units.symbol(dimension::length),
                                units.symbol(dimension::velocity));
  for (std::size_t k = 0; k < flow.z.size(); ++k) {
    for (std::size_t i = 0; i < flow.r.size(); ++i) {
      const double share = flow.rotation[k * flow.r.size() + i];
      out += fmt::format("{},{},{},{}\n",
                         flow.z[k] * length,
                         flow.r[i] * length,
                         share,
                         share * rotation_rate * flow.r[i] * velocity);
    }
  }
  return out;
}

std::string ring_flow_json(const continuum::RingFlow& flow, const Units& units) {
  ordered_json out;
  out["outcome"] = continuum::name(flow.answer.outcome);
  out["text"] = flow.answer.text;
  out["torque"] = flow.torque * units.size(dimension::energy);
  out["units"]["set"] = units.symbols();
  out["units"]["torque"] = units.symbol(dimension::energy);
  for (const Column& column : columns) {
    ordered_json& values = out["band"][column.name] = ordered_json::array();
    for (const RingFlowRow& row : flow.rows)
      values.push_back(row.*column.member * units.size(column.dimension));
    out["units"][column.name] = units.symbol(column.dimension);
  }
  const double length = units.size(dimension::length);
  out["field"]["r"] = scaled(flow.r, length);
  out["field"]["z"] = scaled(flow.z, length);
  for (std::size_t k = 0; k < flow.z.size(); ++k) {
    const auto first = flow.rotation.begin() + static_cast<long>(k * flow.r.size());
    out["field"]["rotation"].push_back(
        std::vector<double>(first, first + static_cast<long>(flow.r.size())));
  }
  return out.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace grainlaw::io
