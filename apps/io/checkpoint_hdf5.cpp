#include "apps/io/checkpoint_hdf5.h"

#include <bit>

#include "apps/io/hdf5_file.h"
#include "apps/io/safe_write.h"
#include "apps/io/sealed_file.h"

namespace grainlaw::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kind = "checkpoint";
constexpr int format = 1;
constexpr std::size_t largest_file = std::size_t{64} << 30;  // bytes; a million grains take about 1

template <class T>
void write_arrays(Hdf5Writer& out,
                  const std::string& group,
                  const std::map<std::string, std::vector<T>>& arrays) {
  out.group(group);
  for (const auto& [name, values] : arrays) {
    out.dataset(group + "/" + name, values, {values.size()});
  }
}

void write_texts(Hdf5Writer& out, const std::map<std::string, std::string>& texts) {
  out.group("texts");
  for (const auto& [name, text] : texts) {
    const std::string path = "texts/" + name;
    out.dataset(path, text);
    out.attribute(
        path, "length", static_cast<std::int64_t>(text.size()));  // zeros at its end count
  }
}

std::string image(const dem::Checkpoint& checkpoint, const SceneFile& scene) {
  Hdf5Writer out;
  out.attribute("/", "program", "grainlaw");
  out.attribute("/", "version", GRAINLAW_VERSION);
  out.attribute("/", "seed", std::bit_cast<std::int64_t>(scene.scene.seed));
  out.dataset("scene", scene.text);
  write_arrays(out, "numbers", checkpoint.numbers);
  write_arrays(out, "integers", checkpoint.integers);
  write_texts(out, checkpoint.texts);
  return out.bytes();
}

Shape list_shape(const Hdf5Reader& in, const std::string& path) {
  const Shape shape = in.shape(path);
  return {shape.empty() ? 0 : shape.front()};  // what has another rank is refused when read
}

dem::Checkpoint read_arrays(const Hdf5Reader& in) {
  dem::Checkpoint checkpoint;
  for (const std::string& name : in.names("numbers")) {
    const std::string path = "numbers/" + name;
    checkpoint.numbers[name] = in.numbers(path, list_shape(in, path));
  }
  for (const std::string& name : in.names("integers")) {
    const std::string path = "integers/" + name;
    checkpoint.integers[name] = in.integers(path, list_shape(in, path));
  }
  for (const std::string& name : in.names("texts")) {
    std::string& text = checkpoint.texts[name] = in.text("texts/" + name);
    const auto length = static_cast<std::size_t>(in.integer("texts/" + name, "length"));
    if (length >= text.size() && length < largest_file) text.resize(length);
  }
  return checkpoint;
}

/// Only the seal is looked at: quick, and whatever damages a file breaks it.
bool intact(const fs::path& path) {
  try {
    const std::string bytes = read_file(path, largest_file);
    unseal(kind, format, bytes, path);
    return true;
  } catch (const ReadError&) {
    return false;
  }
}

}  // namespace

fs::path checkpoint_path(const fs::path& output) {
  return output.string() + ".checkpoint";
}

fs::path previous_checkpoint_path(const fs::path& output) {
  return output.string() + ".checkpoint.previous";
}

void write_checkpoint(const dem::Checkpoint& checkpoint,
                      const SceneFile& scene,
                      const fs::path& output) {
  const fs::path newest = checkpoint_path(output);
  const bool worth_keeping = intact(newest);
  const std::string bytes = seal(kind, format, image(checkpoint, scene));
  if (worth_keeping) {
    safe_write_keeping(previous_checkpoint_path(output), newest, bytes);
  } else {
    safe_write(newest, bytes);
  }
}

StoredCheckpoint read_checkpoint(const fs::path& path) {
  const std::string bytes = read_file(path, largest_file);
  const Hdf5Reader in(unseal(kind, format, bytes, path), path.string());
  return {.checkpoint = read_arrays(in),
          .scene_text = in.text("scene"),
          .seed = std::bit_cast<std::uint64_t>(in.integer("/", "seed")),
          .version = in.text("/", "version")};
}

NewestCheckpoint newest_checkpoint(const fs::path& output) {
  std::string note;
  for (const fs::path& path : {checkpoint_path(output), previous_checkpoint_path(output)}) {
    if (!fs::exists(path)) continue;
    try {
      return {read_checkpoint(path), path, note};
    } catch (const ReadError& error) {
      note += (note.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  if (!note.empty()) throw ReadError(note);
  return {};
}

void remove_checkpoints(const fs::path& output) {
  std::error_code none;
  fs::remove(previous_checkpoint_path(output), none);
  fs::remove(checkpoint_path(output), none);
}

}  // namespace grainlaw::io
