#include "apps/io/lifetimes_hdf5.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/io/units.h"

namespace grainlaw::io {
namespace {

using namespace dem;

const std::string root = "lifetimes";

/// Numbers of a group, with their names and dimensions: one list writes and reads them.
template <class Statistics, class Visit>
void for_numbers_of_all(Statistics& all, Visit&& visit) {
  visit("begin", all.begin, dimension::time);
  visit("end", all.end, dimension::time);
  visit("slice_begin", all.slice_begin, dimension::length);
  visit("slice_end", all.slice_end, dimension::length);
  visit("shear_rate", all.shear_rate, dimension::rate);
  visit("grains", all.grains, Dimension{});
}

template <class Distribution, class Visit>
void for_numbers(Distribution& d, Visit&& visit) {
  visit("distance", d.distance, dimension::length);
  visit("contacts", d.contacts, Dimension{});
  visit("unknown", d.unknown, Dimension{});
  visit("unfinished", d.unfinished, Dimension{});
  visit("survivors", d.survivors, Dimension{});
  visit("split", d.split, dimension::time);
  const auto estimate = [&](const std::string& name, auto& x, Dimension dimension) {
    visit(name, x.value, dimension);
    visit(name + "_error", x.error, dimension);
  };
  estimate("mean", d.mean, dimension::time);
  estimate("mode", d.mode, dimension::time);
  estimate("collision_rate", d.collision_rate, dimension::rate);
  estimate("long_share", d.long_share, {});
  estimate("long_shear", d.long_shear, {});
  estimate("long_normal", d.long_normal, {});
  estimate("long_sliding", d.long_sliding, {});
  estimate("short_sliding", d.short_sliding, {});
}

/// Columns of the rows, value(row) of each.
template <class Visit>
void for_columns(Visit&& visit) {
  visit(
      "begin", dimension::time, [](auto& row) -> auto& { return row.begin; });
  visit(
      "end", dimension::time, [](auto& row) -> auto& { return row.end; });
  visit(
      "contacts", Dimension{}, [](auto& row) -> auto& { return row.contacts; });
  visit(
      "density", Dimension{}, [](auto& row) -> auto& { return row.density.value; });
  visit(
      "density_error", Dimension{}, [](auto& row) -> auto& { return row.density.error; });
  visit(
      "shear_share", Dimension{}, [](auto& row) -> auto& { return row.shear_share; });
  visit(
      "normal_share", Dimension{}, [](auto& row) -> auto& { return row.normal_share; });
}

/// The long lifetimes, one element for each level.
template <class Distribution, class Visit>
void for_levels(Distribution& d, Visit&& visit) {
  visit(
      "long_lifetime", [&d](std::size_t k) -> auto& { return d.long_lifetime[k].value; });
  visit(
      "long_lifetime_error", [&d](std::size_t k) -> auto& { return d.long_lifetime[k].error; });
  visit(
      "beyond", [&d](std::size_t k) -> auto& { return d.beyond[k]; });
}

constexpr std::size_t levels = LifetimeDistribution::levels.size();

std::string group_of(std::size_t k) {
  return fmt::format("{}/{}", root, k);
}

void write(Hdf5Writer& out, const std::string& group, const LifetimeDistribution& distribution) {
  for_columns([&](const char* name, Dimension dimension, auto value) {
    std::vector<double> column;
    for (const LifetimeRow& row : distribution.rows) column.push_back(value(row));
    const std::string path = group + "/" + name;
    out.dataset(path, column, {column.size()});
    out.attribute(path, "unit", grain_units().symbol(dimension));
  });
  out.dataset(group + "/levels", LifetimeDistribution::levels, {levels});
  for_levels(distribution, [&](const char* name, auto element) {
    std::vector<double> values;
    for (std::size_t k = 0; k < levels; ++k) values.push_back(element(k));
    out.dataset(group + "/" + name, values, {levels});
  });
  for_numbers(distribution, [&](const std::string& name, double value, Dimension dimension) {
    out.attribute(group, name, value);
    out.attribute(group, name + "_unit", grain_units().symbol(dimension));
  });
}

LifetimeDistribution read(const Hdf5Reader& in, const std::string& group) {
  LifetimeDistribution distribution;
  const Shape shape = in.shape(group + "/begin");
  distribution.rows.resize(
      in.numbers(group + "/begin", {shape.empty() ? 0 : shape.front()}).size());
  for_columns([&](const char* name, Dimension, auto target) {
    const auto column = in.numbers(group + "/" + name, {distribution.rows.size()});
    for (std::size_t k = 0; k < column.size(); ++k) target(distribution.rows[k]) = column[k];
  });
  for_levels(distribution, [&](const char* name, auto element) {
    const auto values = in.numbers(group + "/" + name, {levels});
    for (std::size_t k = 0; k < levels; ++k) element(k) = values[k];
  });
  for_numbers(distribution, [&](const std::string& name, double& value, Dimension) {
    value = in.number(group, name);
  });
  return distribution;
}

}  // namespace

void write_lifetimes(Hdf5Writer& out, const LifetimeStatistics& lifetimes) {
  out.group(root);
  for_numbers_of_all(lifetimes, [&](const std::string& name, double value, Dimension dimension) {
    out.attribute(root, name, value);
    out.attribute(root, name + "_unit", grain_units().symbol(dimension));
  });
  for (std::size_t k = 0; k < lifetimes.distances.size(); ++k) {
    write(out, group_of(k), lifetimes.distances[k]);
  }
}

bool has_lifetimes(const Hdf5Reader& in) {
  return std::ranges::any_of(in.names("/"),
                             [](const std::string& name) { return name.starts_with(root + "/"); });
}

LifetimeStatistics read_lifetimes(const Hdf5Reader& in) {
  LifetimeStatistics lifetimes;
  for_numbers_of_all(lifetimes, [&](const std::string& name, double& value, Dimension) {
    value = in.number(root, name);
  });
  const std::vector<std::string> names = in.names(root);
  const auto exists = [&](std::size_t k) {
    return std::ranges::find(names, fmt::format("{}/begin", k)) != names.end();
  };
  for (std::size_t k = 0; exists(k); ++k) {
    lifetimes.distances.push_back(read(in, group_of(k)));
  }
  return lifetimes;
}

}  // namespace grainlaw::io
