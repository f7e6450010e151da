#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::io {

/// Lengths of the axes of a dataset, slowest first.
using Shape = std::vector<std::size_t>;

/// HDF5 is not thread-safe: whoever uses it holds this lock, one thread of the process at a time.
class Hdf5Lock {
 public:
  Hdf5Lock();
  Hdf5Lock(const Hdf5Lock&) = delete;
  Hdf5Lock& operator=(const Hdf5Lock&) = delete;
  ~Hdf5Lock();
};

/// An HDF5 file built in memory (core driver): the disk sees it only whole, through safe_write.
/// Every function throws FileError when HDF5 reports a failure. A dataset makes the groups of its
/// path.
class Hdf5Writer {
 public:
  Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;
  ~Hdf5Writer();

  void group(const std::string& path);
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, std::int64_t value);
  void attribute(const std::string& object, const std::string& name, const std::string& value);
  void dataset(const std::string& path, std::span<const double> values, const Shape& shape);
  void dataset(const std::string& path, std::span<const std::int64_t> values, const Shape& shape);
  void dataset(const std::string& path, std::span<const float> values, const Shape& shape);
  void dataset(const std::string& path, const std::string& text);
  std::string bytes();  ///< the whole file

 private:
  Hdf5Lock lock_;
  std::int64_t file_ = -1;
};

/// An HDF5 file read from memory. Throws ReadError when something is missing or of another kind.
class Hdf5Reader {
 public:
  Hdf5Reader(std::string_view bytes, std::string name);
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;
  ~Hdf5Reader();

  bool has(const std::string& path) const;
  double number(const std::string& object, const std::string& name) const;
  std::int64_t integer(const std::string& object, const std::string& name) const;
  std::string text(const std::string& object, const std::string& name) const;
  std::string text(const std::string& dataset) const;
  Shape shape(const std::string& path) const;
  /// Datasets in a group and the groups inside it, by their paths from there.
  std::vector<std::string> names(const std::string& group) const;
  std::vector<double> numbers(const std::string& path, const Shape& expected) const;
  std::vector<std::int64_t> integers(const std::string& path, const Shape& expected) const;

 private:
  void check(std::int64_t status, std::string_view what) const;
  template <class T>
  std::vector<T> space_for(const Shape& shape) const;
  void read(const std::string& path, const Shape& expected, std::int64_t type, void* values) const;
  Hdf5Lock lock_;
  std::string name_;
  std::size_t size_;  ///< of the file [bytes]; no dataset can be larger
  std::int64_t file_ = -1;
};

}  // namespace grainlaw::io
