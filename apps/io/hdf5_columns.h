#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/io/hdf5_file.h"
#include "apps/io/units.h"

namespace grainlaw::io {

/// A number of a struct, its name in the file and its dimension: one line writes and reads it.
template <class T, class Member = double>
struct Field {
  const char* name;
  Member T::*member;
  Dimension dimension = {};
};

inline std::string symbol(Dimension dimension) {
  return grain_units().symbol(dimension);
}

/// One dataset over all elements of a list, value of each element.
template <class T, class Value>
void write_column(Hdf5Writer& out,
                  const std::string& path,
                  const std::vector<T>& list,
                  Dimension dimension,
                  Value value) {
  std::vector<double> column;
  column.reserve(list.size());
  for (const T& element : list) column.push_back(std::invoke(value, element));
  out.dataset(path, column, {column.size()});
  out.attribute(path, "unit", symbol(dimension));
}

template <class T, class Target>
void read_column(const Hdf5Reader& in,
                 const std::string& path,
                 std::vector<T>& list,
                 Target target) {
  const std::vector<double> column = in.numbers(path, {list.size()});
  for (std::size_t k = 0; k < list.size(); ++k) std::invoke(target, list[k]) = column[k];
}

/// The length of a list of which `path` is one column.
inline std::size_t length_of(const Hdf5Reader& in, const std::string& path) {
  const Shape shape = in.shape(path);
  return in.numbers(path, {shape.empty() ? 0 : shape.front()}).size();
}

}  // namespace grainlaw::io
