#include "apps/measured_so_far.h"

#include <fmt/format.h>

#include "apps/io/checkpoint_hdf5.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/io/scene_text.h"
#include "dem/flow_setup.h"

namespace grainlaw {

std::optional<dem::LocalData> measured_so_far(const io::SceneFile& scene,
                                              double least,
                                              const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  io::RunRecord record = io::read_run_record(path);
  if (record.scene_text != scene.text) return std::nullopt;
  dem::LocalData& data = record.data;
  const double in_file = scene.units[io::dimension::time].size * least;
  const io::Override averaging{"measurement", "averaging_time", fmt::format("{:.6g}", in_file)};
  const io::SceneFile shorter =
      io::parse_scene(io::with_values(scene.text, {averaging}), scene.path);
  const auto& frames = data.frames.frames;
  data.window =
      dem::steady_window(dem::assess(frames, dem::steady_criteria(shorter.scene)), frames);
  if (!data.window.steady) return std::nullopt;
  data.rows = dem::average(data.frames, data.conditions, data.window);
  data.fields = dem::fields_at_widths(data.frames, data.conditions, data.window);
  io::write_local_data(data, shorter, path);
  io::remove_checkpoints(path);
  return std::move(data);
}

}  // namespace grainlaw
