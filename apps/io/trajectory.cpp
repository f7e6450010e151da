#include "apps/io/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "apps/io/hdf5_file.h"
#include "apps/io/safe_write.h"
#include "apps/io/units.h"

namespace grainlaw::io {
namespace {

namespace fs = std::filesystem;
using dem::InitialGrain;
using dem::Vec3;

std::string file_name(long number, std::string_view ending) {
  return fmt::format("{:08d}.{}", number, ending);
}

template <class Value>
std::vector<double> numbers(const std::vector<InitialGrain>& grains, Value value) {
  std::vector<double> list;
  list.reserve(3 * grains.size());
  for (const InitialGrain& grain : grains) value(grain, list);
  return list;
}

template <class Member>
void write_vectors(Hdf5Writer& out,
                   const std::string& path,
                   const std::vector<InitialGrain>& grains,
                   Member member,
                   Dimension dimension) {
  const auto list = numbers(grains, [&](const InitialGrain& grain, std::vector<double>& to) {
    const Vec3& v = grain.*member;
    to.insert(to.end(), {v.x, v.y, v.z});
  });
  out.dataset(path, list, {grains.size(), 3});
  out.attribute(path, "unit", grain_units().symbol(dimension));
}

std::string snapshot_bytes(const dem::Snapshot& snapshot) {
  const std::vector<InitialGrain>& grains = snapshot.state.grains;
  const Vec3& period = snapshot.state.box.period;
  Hdf5Writer out;
  out.attribute("/", "kind", "grains");
  out.attribute("/", "format", std::int64_t{1});
  out.attribute("/", "units", grain_units().symbols());
  out.attribute("/", "time", snapshot.time);
  write_vectors(out, "position", grains, &InitialGrain::position, dimension::length);
  write_vectors(out, "velocity", grains, &InitialGrain::velocity, dimension::velocity);
  write_vectors(out, "spin", grains, &InitialGrain::rotation, dimension::rate);
  const auto radius = numbers(grains, [](const InitialGrain& grain, std::vector<double>& to) {
    to.push_back(0.5 * grain.diameter);
  });
  out.dataset("radius", radius, {radius.size()});
  std::vector<std::int64_t> body;
  for (const InitialGrain& grain : grains) body.push_back(static_cast<std::int64_t>(grain.body));
  out.dataset("body", body, {body.size()});
  out.attribute("body", "meaning", "0: mobile, 1: glued at rest, 2: glued to what moves");
  out.dataset("period", std::array{period.x, period.y, period.z}, {3});
  return out.bytes();
}

std::string item(const std::string& file, std::string_view path, std::size_t grains, int width) {
  const bool integer = path == "body";
  return fmt::format(
      "<DataItem Dimensions=\"{}{}\" NumberType=\"{}\" Precision=\"8\" Format=\"HDF\">"
      "{}:/{}</DataItem>",
      grains,
      width == 3 ? " 3" : "",
      integer ? "Int" : "Float",
      file,
      path);
}

std::string xdmf_step(const std::string& file, double time, std::size_t grains) {
  std::string text = fmt::format(
      "<Grid Name=\"grains\" GridType=\"Uniform\"><Time Value=\"{}\"/>\n"
      "<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\"/>\n"
      "<Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
      time,
      grains,
      item(file, "position", grains, 3));
  for (const char* name : {"velocity", "spin"}) {
    text += fmt::format(
        "<Attribute Name=\"{}\" AttributeType=\"Vector\" Center=\"Node\">{}</Attribute>\n",
        name,
        item(file, name, grains, 3));
  }
  for (const char* name : {"radius", "body"}) {
    text += fmt::format(
        "<Attribute Name=\"{}\" AttributeType=\"Scalar\" Center=\"Node\">{}</Attribute>\n",
        name,
        item(file, name, grains, 1));
  }
  return text + "</Grid>\n";
}

/// Number of a snapshot from the name of its file; -1 for another file.
long number_of(const fs::path& file) {
  const std::string name = file.stem().string();
  long number = -1;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool whole = error == std::errc() && end == name.data() + name.size();
  const bool ours = file.extension() == ".h5" || file.extension() == ".xyz";
  return whole && ours && name.size() == 8 ? number : -1;
}

/// A snapshot whose writer was killed, "00000012.h5.1234.0.tmp".
bool left_by_a_kill(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::string snapshot =
      name.substr(0, name.find('.', std::min<std::size_t>(9, name.size())));
  return file.extension() == ".tmp" && number_of(snapshot) >= 0;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

/// Extent of the box; where it is open, as far as the centres reach.
Vec3 lattice(const dem::Snapshot& snapshot) {
  Vec3 length = snapshot.state.box.period;
  const auto reach = [&](auto coordinate) {
    double largest = 1.0;
    for (const InitialGrain& grain : snapshot.state.grains) {
      largest = std::max(largest, coordinate(grain.position) + 0.5 * grain.diameter);
    }
    return largest;
  };
  if (length.x == 0.0) length.x = reach([](const Vec3& p) { return p.x; });
  if (length.y == 0.0) length.y = reach([](const Vec3& p) { return p.y; });
  if (length.z == 0.0) length.z = reach([](const Vec3& p) { return p.z; });
  return length;
}

}  // namespace

TrajectoryWriter::TrajectoryWriter(const fs::path& run, bool goes_on, const Options& options)
    : folder_(fs::path(run).replace_extension(".grains")),
      sidecar_(fs::path(run).replace_extension(".xdmf")),
      options_(options) {
  std::error_code failure;
  fs::create_directories(folder_, failure);
  if (failure) {
    throw FileError(fmt::format("cannot make {}: {}", folder_.string(), failure.message()));
  }
  remove_temporaries(sidecar_);
  const std::vector<fs::path> files = files_in(folder_);
  for (const fs::path& file : files) {
    if (number_of(file) >= 0 || left_by_a_kill(file)) continue;
    throw ReadError(fmt::format("{} holds {}, which is no snapshot: name another output",
                                folder_.string(),
                                file.filename().string()));
  }
  for (const fs::path& file : files) {
    if (!goes_on || left_by_a_kill(file)) fs::remove(file);
  }
  if (goes_on) {
    take_over();
  } else {
    fs::remove(sidecar_);
  }
}

void TrajectoryWriter::take_over() {
  for (const fs::path& file : files_in(folder_)) {
    if (file.extension() != ".h5") continue;
    const std::string bytes = read_file(file);
    const Hdf5Reader in(bytes, file.string());
    entries_[number_of(file)] = {in.number("/", "time"), in.shape("radius").front()};
  }
}

void TrajectoryWriter::add(const dem::Snapshot& snapshot) {
  // One that a checkpoint lies before is made again, with the same time: it keeps its number.
  const auto known = std::ranges::find_if(
      entries_, [&](const auto& entry) { return entry.second.time >= snapshot.time; });
  const long number = known != entries_.end() ? known->first
                      : entries_.empty()      ? 0
                                              : entries_.rbegin()->first + 1;
  safe_write(folder_ / file_name(number, "h5"), snapshot_bytes(snapshot));
  if (options_.xyz) safe_write(folder_ / file_name(number, "xyz"), extended_xyz(snapshot));
  entries_[number] = {snapshot.time, snapshot.state.grains.size()};
  if (entries_.size() >= 2 * in_sidecar_) finish();
}

void TrajectoryWriter::finish() {
  std::string text =
      "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
      "<Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  const std::string folder = folder_.filename().string() + "/";
  for (const auto& [number, entry] : entries_) {
    text += xdmf_step(folder + file_name(number, "h5"), entry.time, entry.grains);
  }
  safe_write(sidecar_, text + "</Grid>\n</Domain>\n</Xdmf>\n");
  in_sidecar_ = entries_.size();
}

std::string extended_xyz(const dem::Snapshot& snapshot) {
  const Vec3 length = lattice(snapshot);
  const Vec3& period = snapshot.state.box.period;
  const auto letter = [](double p) { return p > 0.0 ? 'T' : 'F'; };
  std::string text = fmt::format(
      "{}\nLattice=\"{} 0 0 0 {} 0 0 0 {}\" pbc=\"{} {} {}\" Time={} "
      "Properties=species:S:1:pos:R:3:radius:R:1:velo:R:3:angular_velocity:R:3\n",
      snapshot.state.grains.size(),
      length.x,
      length.y,
      length.z,
      letter(period.x),
      letter(period.y),
      letter(period.z),
      snapshot.time);
  for (const InitialGrain& grain : snapshot.state.grains) {
    text += fmt::format("{} {} {} {} {} {} {} {} {} {} {}\n",
                        grain.body == dem::Body::none ? "grain" : "base",
                        grain.position.x,
                        grain.position.y,
                        grain.position.z,
                        0.5 * grain.diameter,
                        grain.velocity.x,
                        grain.velocity.y,
                        grain.velocity.z,
                        grain.rotation.x,
                        grain.rotation.y,
                        grain.rotation.z);
  }
  return text;
}

}  // namespace grainlaw::io
