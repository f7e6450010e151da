#include "apps/io/profile_hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "apps/io/hdf5_columns.h"

namespace grainlaw::io {

using namespace dem;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr Dimension power{1, 2, -3};
constexpr Dimension force_density{1, -2, -2};

constexpr auto frame_fields = std::to_array<Field<ProfileFrame>>({
    {"begin", &ProfileFrame::begin, dimension::time},
    {"end", &ProfileFrame::end, dimension::time},
    {"centre_of_mass", &ProfileFrame::centre_of_mass, dimension::length},
    {"kinetic_energy", &ProfileFrame::kinetic_energy, {1, 2, -2}},
});

/// Numbers of a struct that holds nothing else.
template <class T>
constexpr std::size_t numbers_of = sizeof(T) / sizeof(double);
template <class T>
using Numbers = std::array<double, numbers_of<T>>;

static_assert(numbers_of<BinMoments> == 40, "a new moment needs a new format version");
constexpr auto moment_names =
    "mass, momentum x y z, momentum_flux xx yy zz xy xz yz, mass_offset, mass_offset_squared, "
    "momentum_offset x y z, contact_stress xx yy zz xy xz yz yx zx zy, wall_force x y z, "
    "wall_force_offset x y z, grains, contacts, fabric xx yy zz xy xz yz, contact_points, "
    "dissipation";
constexpr auto sliding_names = "contact_points, dissipation";

/// One field of a FieldRow, in its order: a name, how many numbers they are and which, dimension.
struct FieldColumns {
  const char* name;
  const char* components;
  std::size_t count = 1;
  Dimension dimension = {};
};
constexpr auto symmetric = "xx yy zz xy xz yz";
constexpr auto field_columns = std::to_array<FieldColumns>({
    {"velocity", "x", 1, dimension::velocity},
    {"shear_rate", "", 1, dimension::rate},
    {"volume_fraction", ""},
    {"shear_stress", "", 1, dimension::stress},
    {"normal_stress", "", 1, dimension::stress},
    {"pressure_trace", "", 1, dimension::stress},
    {"temperature", "", 1, dimension::temperature},
    {"inertial_number", ""},
    {"softness", ""},
    {"friction", ""},
    {"coordination", ""},
    {"dissipation_per_contact", "", 1, power},
    {"sliding_share", ""},
    {"sliding_dissipation_share", ""},
    {"mass_above", "", 1, dimension::mass_per_area},
    {"density", "", 1, dimension::density},
    {"momentum", "x y z", 3, {1, -2, -1}},
    {"velocity_gradient", "x y z", 3, dimension::rate},
    {"contact_stress", "xx yy zz xy xz yz yx zx zy", 9, dimension::stress},
    {"kinetic_stress", symmetric, 6, dimension::stress},
    {"wall_force", "x y z", 3, force_density},
    {"wall_force_above", "x y z", 3, dimension::stress},
    {"fabric", symmetric, 6},
});

constexpr std::size_t all_columns() {
  std::size_t sum = 0;
  for (const FieldColumns& columns : field_columns) sum += columns.count;
  return sum;
}
static_assert(numbers_of<FieldRow> == all_columns(), "a new field needs a column");

template <class T>
void append_numbers(std::vector<double>& to, const T& from) {
  const auto numbers = std::bit_cast<Numbers<T>>(from);
  to.insert(to.end(), numbers.begin(), numbers.end());
}

/// As many of the lowest bins as hold anything in any frame.
template <class T>
std::size_t filled_bins(const std::vector<ProfileFrame>& frames,
                        std::vector<T> ProfileFrame::*list) {
  std::size_t filled = 0;
  for (const ProfileFrame& frame : frames) {
    for (std::size_t k = filled; k < (frame.*list).size(); ++k) {
      const auto numbers = std::bit_cast<Numbers<T>>((frame.*list)[k]);
      if (std::ranges::any_of(numbers, [](double x) { return x != 0.0; })) filled = k + 1;
    }
  }
  return filled;
}

/// Moments of all frames, [frame][bin][moment]. What is above the highest grain is left out; frames
/// with fewer bins are filled with zeros.
template <class T>
void write_moments(Hdf5Writer& out,
                   const std::string& path,
                   const std::vector<ProfileFrame>& frames,
                   std::vector<T> ProfileFrame::*list,
                   const char* names,
                   Precision precision) {
  const std::size_t bins = filled_bins(frames, list);
  std::vector<double> values;
  values.reserve(frames.size() * bins * numbers_of<T>);
  for (const ProfileFrame& frame : frames) {
    const std::size_t own = std::min(bins, (frame.*list).size());
    for (std::size_t k = 0; k < own; ++k) append_numbers(values, (frame.*list)[k]);
    values.resize(values.size() + (bins - own) * numbers_of<T>, 0.0);
  }
  const Shape shape{frames.size(), bins, numbers_of<T>};
  if (precision == Precision::single) {
    out.dataset(path, std::vector<float>(values.begin(), values.end()), shape);
  } else {
    out.dataset(path, values, shape);
  }
  out.attribute(path, "components", names);
  out.attribute(path, "unit", "per unit volume, in units of m, d, t");
}

template <class T>
void read_moments(const Hdf5Reader& in,
                  const std::string& path,
                  const std::vector<std::int64_t>& bins_of,
                  std::vector<ProfileFrame>& frames,
                  std::vector<T> ProfileFrame::*list) {
  const Shape shape = in.shape(path);
  const std::size_t bins = shape.size() == 3 ? shape[1] : 0;
  const std::vector<double> values = in.numbers(path, {frames.size(), bins, numbers_of<T>});
  for (std::size_t f = 0; f < frames.size(); ++f) {
    constexpr std::int64_t most = 1'000'000;
    if (bins_of[f] < 0 || bins_of[f] > most) {
      throw ReadError(fmt::format("frame {} claims {} bins", f, bins_of[f]));
    }
    (frames[f].*list).resize(static_cast<std::size_t>(bins_of[f]));
    auto from = values.begin() + static_cast<std::ptrdiff_t>(f * bins * numbers_of<T>);
    for (std::size_t k = 0; k < std::min(bins, (frames[f].*list).size()); ++k) {
      Numbers<T> numbers;
      std::copy_n(from, numbers.size(), numbers.begin());
      (frames[f].*list)[k] = std::bit_cast<T>(numbers);
      from += numbers.size();
    }
  }
}

std::size_t read_bins_per_row(const Hdf5Reader& in) {
  const std::int64_t bins = in.integer("frames", "bins_per_row");
  if (bins < 1) throw ReadError(fmt::format("{} bins in a row", bins));
  return static_cast<std::size_t>(bins);
}

using FieldRows = std::vector<FieldRow> WidthFields::*;

/// One field, or its errors, at all widths in rows z_begin[width] + (k + 1/2) row_width: [width]
/// [row][component], without the last for scalars. Narrower kernels reach less far: not a number.
void write_field(Hdf5Writer& out,
                 const std::string& path,
                 const std::vector<WidthFields>& widths,
                 FieldRows list,
                 std::size_t first,
                 const FieldColumns& columns) {
  std::size_t rows = 0;
  for (const WidthFields& width : widths) rows = std::max(rows, (width.*list).size());
  std::vector<double> values;
  for (const WidthFields& width : widths) {
    for (const FieldRow& row : width.*list) {
      const auto numbers = std::bit_cast<Numbers<FieldRow>>(row);
      const auto from = numbers.begin() + static_cast<std::ptrdiff_t>(first);
      values.insert(values.end(), from, from + static_cast<std::ptrdiff_t>(columns.count));
    }
    values.resize(values.size() + (rows - (width.*list).size()) * columns.count, not_a_number);
  }
  Shape shape{widths.size(), rows};
  if (columns.count > 1) shape.push_back(columns.count);
  out.dataset(path, values, shape);
  out.attribute(path, "unit", symbol(columns.dimension));
  if (columns.count > 1) out.attribute(path, "components", columns.components);
}

void read_field(const Hdf5Reader& in,
                const std::string& path,
                std::vector<WidthFields>& widths,
                FieldRows list,
                std::size_t first,
                const FieldColumns& columns) {
  const std::size_t rows = in.shape(path).at(1);
  Shape shape{widths.size(), rows};
  if (columns.count > 1) shape.push_back(columns.count);
  const std::vector<double> values = in.numbers(path, shape);
  for (std::size_t w = 0; w < widths.size(); ++w) {
    for (std::size_t k = 0; k < (widths[w].*list).size(); ++k) {
      FieldRow& row = (widths[w].*list)[k];
      auto numbers = std::bit_cast<Numbers<FieldRow>>(row);
      for (std::size_t c = 0; c < columns.count; ++c) {
        numbers[first + c] = values[(w * rows + k) * columns.count + c];
      }
      row = std::bit_cast<FieldRow>(numbers);
    }
  }
}

/// Calls visit(field, where its first number stands).
template <class Visit>
void for_fields(bool friction, Visit&& visit) {
  std::size_t first = 0;
  for (const FieldColumns& columns : field_columns) {
    const bool sliding = std::string_view(columns.name).starts_with("sliding");
    if (friction || !sliding) visit(columns, first);
    first += columns.count;
  }
}

}  // namespace

KernelShape read_kernel_shape(const Hdf5Reader& in, const std::string& group) {
  const std::string word = in.text(group, "kernel");
  for (const KernelShape shape : {KernelShape::lucy, KernelShape::gaussian}) {
    if (word == dem::name(shape)) return shape;
  }
  throw ReadError("unknown kernel '" + word + "'");
}

bool slides(const ProfileFrames& frames) {
  const auto counted = [](const ProfileFrame& frame) { return !frame.sliding.empty(); };
  return std::ranges::any_of(frames.frames, counted);
}

void write_frames(Hdf5Writer& out, const ProfileFrames& frames, Precision precision) {
  out.group("frames");
  out.attribute("frames", "z_begin", frames.z_begin);
  out.attribute("frames", "bin_width", frames.bin_width);
  out.attribute("frames", "bins_per_row", static_cast<std::int64_t>(frames.bins_per_row));
  out.attribute("frames", "periodic", std::int64_t{frames.periodic});
  out.attribute("frames", "friction", std::int64_t{slides(frames)});
  out.attribute("frames", "kernel", std::string(dem::name(frames.kernel.shape)));
  out.attribute("frames", "kernel_width", frames.kernel.width);
  if (!frames.from_rest) out.group("frames/begun_in_motion");
  for (const auto& field : frame_fields) {
    write_column(
        out, std::string("frames/") + field.name, frames.frames, field.dimension, field.member);
  }
  std::vector<std::int64_t> samples;
  std::vector<std::int64_t> bins;
  for (const ProfileFrame& frame : frames.frames) {
    samples.push_back(frame.samples);
    bins.push_back(static_cast<std::int64_t>(frame.bins.size()));
  }
  out.dataset("frames/samples", samples, {samples.size()});
  out.dataset("frames/bins", bins, {bins.size()});
  write_moments(out, "frames/moments", frames.frames, &ProfileFrame::bins, moment_names, precision);
  if (slides(frames)) {
    write_moments(
        out, "frames/sliding", frames.frames, &ProfileFrame::sliding, sliding_names, precision);
  }
}

ProfileFrames read_frames(const Hdf5Reader& in) {
  ProfileFrames frames;
  frames.z_begin = in.number("frames", "z_begin");
  frames.bin_width = in.number("frames", "bin_width");
  frames.bins_per_row = read_bins_per_row(in);
  frames.periodic = in.integer("frames", "periodic") != 0;
  frames.kernel = {read_kernel_shape(in, "frames"), in.number("frames", "kernel_width")};
  frames.from_rest = !in.has("frames/begun_in_motion");
  std::vector<ProfileFrame>& list = frames.frames;
  list.resize(length_of(in, "frames/begin"));
  for (const auto& field : frame_fields) {
    read_column(in, std::string("frames/") + field.name, list, field.member);
  }
  const auto samples = in.integers("frames/samples", {list.size()});
  for (std::size_t f = 0; f < list.size(); ++f) list[f].samples = static_cast<int>(samples[f]);
  const auto bins = in.integers("frames/bins", {list.size()});
  read_moments(in, "frames/moments", bins, list, &ProfileFrame::bins);
  if (in.integer("frames", "friction") != 0) {
    read_moments(in, "frames/sliding", bins, list, &ProfileFrame::sliding);
  }
  return frames;
}

void write_widths(Hdf5Writer& out, const LocalData& data) {
  const std::vector<WidthFields>& widths = data.fields;
  out.group("fields");
  write_column(out, "fields/width", widths, dimension::length, &WidthFields::width);
  write_column(out, "fields/z_begin", widths, dimension::length, &WidthFields::z_begin);
  write_column(out, "fields/row_width", widths, dimension::length, &WidthFields::row_width);
  std::vector<std::int64_t> rows;
  for (const WidthFields& width : widths) {
    rows.push_back(static_cast<std::int64_t>(width.values.size()));
  }
  out.dataset("fields/rows", rows, {rows.size()});
  for_fields(slides(data.frames), [&](const FieldColumns& columns, std::size_t first) {
    const std::string path = std::string("fields/") + columns.name;
    write_field(out, path, widths, &WidthFields::values, first, columns);
    write_field(out, path + "_error", widths, &WidthFields::errors, first, columns);
  });
}

std::vector<WidthFields> read_widths(const Hdf5Reader& in, bool friction) {
  std::vector<WidthFields> widths(length_of(in, "fields/width"));
  read_column(in, "fields/width", widths, &WidthFields::width);
  read_column(in, "fields/z_begin", widths, &WidthFields::z_begin);
  read_column(in, "fields/row_width", widths, &WidthFields::row_width);
  const auto rows = in.integers("fields/rows", {widths.size()});
  const std::size_t most = widths.empty() ? 0 : in.shape("fields/density").at(1);
  FieldRow unknown;
  unknown.sliding_share = unknown.sliding_dissipation = not_a_number;
  for (std::size_t w = 0; w < widths.size(); ++w) {
    const auto count = static_cast<std::size_t>(rows[w]);
    if (rows[w] < 0 || count > most) throw ReadError(fmt::format("{} of {} rows", rows[w], most));
    widths[w].values.resize(count, unknown);
    widths[w].errors.resize(count, unknown);
  }
  for_fields(friction, [&](const FieldColumns& columns, std::size_t first) {
    const std::string path = std::string("fields/") + columns.name;
    read_field(in, path, widths, &WidthFields::values, first, columns);
    read_field(in, path + "_error", widths, &WidthFields::errors, first, columns);
  });
  return widths;
}

}  // namespace grainlaw::io
