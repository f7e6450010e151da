#include "apps/io/hdf5_file.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "apps/io/input_file.h"

namespace grainlaw::io {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

std::recursive_mutex one_user;

/// HDF5's own exit handler crashes when a disk was full, and its errors go to stderr: both off.
void prepare_library() {
  static const bool done = [] {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    return true;
  }();
  static_cast<void>(done);
}

/// Any HDF5 handle with its closing function.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

void require(std::int64_t status, std::string_view call) {
  if (status < 0) throw FileError(fmt::format("HDF5 failed in {}", call));
}

Handle created(hid_t id, Handle::Close close, std::string_view call) {
  require(id, call);
  return {id, close};
}

/// Dates of objects would make two equal runs differ.
Handle properties_without_times(hid_t kind) {
  Handle list = created(H5Pcreate(kind), H5Pclose, "H5Pcreate");
  require(H5Pset_obj_track_times(list, false), "H5Pset_obj_track_times");
  return list;
}

/// Files in memory need a name. HDF5 refuses to open one whose name is that of a real file, and no
/// file can be inside a device.
constexpr const char* memory_name = "/dev/null/grainlaw";

Handle memory_file_access() {
  constexpr std::size_t increment = 1 << 20;
  Handle access = created(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "H5Pcreate");
  require(H5Pset_fapl_core(access, increment, false), "H5Pset_fapl_core");
  return access;
}

Handle scalar() {
  return created(H5Screate(H5S_SCALAR), H5Sclose, "H5Screate");
}

Handle space_of(const Shape& shape) {
  const std::vector<hsize_t> lengths(shape.begin(), shape.end());
  return created(H5Screate_simple(static_cast<int>(lengths.size()), lengths.data(), nullptr),
                 H5Sclose,
                 "H5Screate_simple");
}

/// A text of fixed length, filled up with zeros.
Handle text_type(std::size_t length) {
  Handle type = created(H5Tcopy(H5T_C_S1), H5Tclose, "H5Tcopy");
  require(H5Tset_size(type, std::max<std::size_t>(length, 1)), "H5Tset_size");
  require(H5Tset_strpad(type, H5T_STR_NULLPAD), "H5Tset_strpad");
  require(H5Tset_cset(type, H5T_CSET_UTF8), "H5Tset_cset");
  return type;
}

void write_attribute(
    hid_t file, const std::string& object, const std::string& name, hid_t type, const void* value) {
  const Handle owner = created(H5Oopen(file, object.c_str(), H5P_DEFAULT), H5Oclose, object);
  const Handle space = scalar();
  const Handle attribute =
      created(H5Acreate2(owner, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
              H5Aclose,
              object + "@" + name);
  require(H5Awrite(attribute, type, value), object + "@" + name);
}

void write_dataset(hid_t file,
                   const std::string& path,
                   hid_t stored,
                   hid_t given,
                   const void* values,
                   const Shape& shape) {
  const Handle space = space_of(shape);
  const Handle properties = properties_without_times(H5P_DATASET_CREATE);
  const Handle links = created(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "H5Pcreate");
  require(H5Pset_create_intermediate_group(links, 1), "H5Pset_create_intermediate_group");
  const Handle dataset =
      created(H5Dcreate2(file, path.c_str(), stored, space, links, properties, H5P_DEFAULT),
              H5Dclose,
              path);
  if (values != nullptr)
    require(H5Dwrite(dataset, given, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path);
}

}  // namespace

Hdf5Lock::Hdf5Lock() {
  one_user.lock();
  prepare_library();
}
Hdf5Lock::~Hdf5Lock() {
  one_user.unlock();
}

Hdf5Writer::Hdf5Writer() {
  const Handle creation = properties_without_times(H5P_FILE_CREATE);
  const Handle access = memory_file_access();
  // With the core driver and no backing store the name never reaches the disk.
  file_ = H5Fcreate(memory_name, H5F_ACC_TRUNC, creation, access);
  require(file_, "H5Fcreate");
}

Hdf5Writer::~Hdf5Writer() {
  if (file_ >= 0) H5Fclose(file_);
}

void Hdf5Writer::group(const std::string& path) {
  const Handle properties = properties_without_times(H5P_GROUP_CREATE);
  created(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose, path);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, double value) {
  write_attribute(file_, object, name, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, std::int64_t value) {
  write_attribute(file_, object, name, H5T_NATIVE_INT64, &value);
}

void Hdf5Writer::attribute(const std::string& object,
                           const std::string& name,
                           const std::string& value) {
  write_attribute(file_, object, name, text_type(value.size()), value.c_str());
}

void Hdf5Writer::dataset(const std::string& path,
                         std::span<const double> values,
                         const Shape& shape) {
  write_dataset(file_, path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), shape);
}

void Hdf5Writer::dataset(const std::string& path,
                         std::span<const std::int64_t> values,
                         const Shape& shape) {
  write_dataset(file_, path, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(), shape);
}

void Hdf5Writer::dataset(const std::string& path,
                         std::span<const float> values,
                         const Shape& shape) {
  write_dataset(file_, path, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, values.data(), shape);
}

void Hdf5Writer::dataset(const std::string& path, const std::string& text) {
  const Handle type = text_type(text.size());
  write_dataset(file_, path, type, type, text.c_str(), {1});
}

std::string Hdf5Writer::bytes() {
  require(H5Fflush(file_, H5F_SCOPE_GLOBAL), "H5Fflush");
  const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
  require(size, "H5Fget_file_image");
  std::string image(static_cast<std::size_t>(size), '\0');
  require(H5Fget_file_image(file_, image.data(), image.size()), "H5Fget_file_image");
  return image;
}

Hdf5Reader::Hdf5Reader(std::string_view bytes, std::string name)
    : name_(std::move(name)), size_(bytes.size()) {
  const Handle access = memory_file_access();
  // HDF5 copies the image and does not write to it, whatever its interface says.
  require(H5Pset_file_image(access, const_cast<char*>(bytes.data()), bytes.size()),
          "H5Pset_file_image");
  file_ = H5Fopen(memory_name, H5F_ACC_RDONLY, access);
  check(file_, "the HDF5 part");
}

Hdf5Reader::~Hdf5Reader() {
  if (file_ >= 0) H5Fclose(file_);
}

void Hdf5Reader::check(std::int64_t status, std::string_view what) const {
  if (status < 0) throw ReadError(fmt::format("cannot read {} of {}", what, name_));
}

namespace {

/// An attribute of one number, opened and checked.
Handle open_attribute(hid_t file,
                      const std::string& object,
                      const std::string& name,
                      H5T_class_t kind) {
  Handle attribute(H5Aopen_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                   H5Aclose);
  if (attribute < 0) return attribute;
  const Handle space(H5Aget_space(attribute), H5Sclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const bool fits = H5Sget_simple_extent_npoints(space) == 1 && H5Tget_class(type) == kind;
  return fits ? std::move(attribute) : Handle(-1, H5Aclose);
}

/// Name of the k-th link of a group; empty when HDF5 fails.
std::string link_name(hid_t group, hsize_t k) {
  const auto name = [&](char* to, std::size_t room) {
    return H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, k, to, room, H5P_DEFAULT);
  };
  const ssize_t length = name(nullptr, 0);
  if (length < 0) return {};
  std::string text(static_cast<std::size_t>(length) + 1, '\0');  // HDF5 ends it with a zero
  if (name(text.data(), text.size()) < 0) return {};
  text.pop_back();
  return text;
}

std::string without_padding(std::string text) {
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

}  // namespace

bool Hdf5Reader::has(const std::string& path) const {
  return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0;
}

double Hdf5Reader::number(const std::string& object, const std::string& name) const {
  double value = 0.0;
  const Handle attribute = open_attribute(file_, object, name, H5T_FLOAT);
  check(attribute, object + "@" + name);
  check(H5Aread(attribute, H5T_NATIVE_DOUBLE, &value), object + "@" + name);
  return value;
}

std::int64_t Hdf5Reader::integer(const std::string& object, const std::string& name) const {
  std::int64_t value = 0;
  const Handle attribute = open_attribute(file_, object, name, H5T_INTEGER);
  check(attribute, object + "@" + name);
  check(H5Aread(attribute, H5T_NATIVE_INT64, &value), object + "@" + name);
  return value;
}

std::string Hdf5Reader::text(const std::string& object, const std::string& name) const {
  const Handle attribute = open_attribute(file_, object, name, H5T_STRING);
  check(attribute, object + "@" + name);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  check(H5Tis_variable_str(type) == 0 ? 0 : -1, object + "@" + name);
  std::string value(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, value.data()), object + "@" + name);
  return without_padding(std::move(value));
}

std::string Hdf5Reader::text(const std::string& path) const {
  const Handle dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
  check(dataset, path);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const bool fixed = H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
  check(fixed && shape(path) == Shape{1} ? 0 : -1, path);
  std::string value(H5Tget_size(type), '\0');
  check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()), path);
  return without_padding(std::move(value));
}

Shape Hdf5Reader::shape(const std::string& path) const {
  const Handle dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
  check(dataset, path);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  check(rank, path);
  std::vector<hsize_t> lengths(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space, lengths.data(), nullptr), path);
  return {lengths.begin(), lengths.end()};
}

std::vector<std::string> Hdf5Reader::names(const std::string& path) const {
  const Handle group(H5Gopen2(file_, path.c_str(), H5P_DEFAULT), H5Gclose);
  check(group, path);
  H5G_info_t info{};
  check(H5Gget_info(group, &info), path);
  std::vector<std::string> names;
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    const std::string name = link_name(group, k);
    const Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose);
    const std::string full = fmt::format("{}/{}", path, name);
    check(object, full);
    if (H5Iget_type(object) != H5I_GROUP) {
      names.push_back(name);
    } else {
      for (const std::string& inner : this->names(full)) {
        names.push_back(fmt::format("{}/{}", name, inner));
      }
    }
  }
  return names;
}

namespace {

/// Number of values; more than `most` is returned as most + 1.
std::size_t count(const Shape& shape, std::size_t most) {
  if (std::ranges::count(shape, 0u) > 0) return 0;
  std::size_t product = 1;
  for (const std::size_t length : shape) {
    if (length > most / product) return most + 1;
    product *= length;
  }
  return product;
}

}  // namespace

void Hdf5Reader::read(const std::string& path,
                      const Shape& expected,
                      std::int64_t type,
                      void* values) const {
  if (shape(path) != expected) {
    throw ReadError(fmt::format("{} of {} has a length the rest does not have", path, name_));
  }
  const Handle dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle stored(H5Dget_type(dataset), H5Tclose);
  check(H5Tget_class(stored) == H5Tget_class(type) ? 0 : -1, path);
  check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path);
}

template <class T>
std::vector<T> Hdf5Reader::space_for(const Shape& shape) const {
  const std::size_t most = size_ / std::min(sizeof(T), sizeof(float));  // as it may be stored
  const std::size_t values = count(shape, most);
  check(values <= most ? 0 : -1, "a dataset larger than the file");
  return std::vector<T>(values);
}

std::vector<double> Hdf5Reader::numbers(const std::string& path, const Shape& expected) const {
  std::vector<double> values = space_for<double>(expected);
  read(path, expected, H5T_NATIVE_DOUBLE, values.data());
  return values;
}

std::vector<std::int64_t> Hdf5Reader::integers(const std::string& path,
                                               const Shape& expected) const {
  std::vector<std::int64_t> values = space_for<std::int64_t>(expected);
  read(path, expected, H5T_NATIVE_INT64, values.data());
  return values;
}

}  // namespace grainlaw::io
