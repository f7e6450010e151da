#include "apps/study_source.h"

#include <limits>

#include "apps/exit_code.h"
#include "apps/io/import.h"

namespace grainlaw::study {

std::vector<io::SceneFile> source_scenes(const io::RunSource& source) {
  if (source.scene.empty()) return {};
  return {changed(io::read_scene(source.scene), {{"", "name", "\"run\""}})};
}

std::vector<Run> obtain(const io::RunSource& source,
                        const std::vector<io::SceneFile>& scenes,
                        const Context& context) {
  std::vector<Run> runs;
  if (!source.run.empty()) {
    dem::LocalData data = io::read_run(source.run).data;
    const std::string name = data.name;
    runs.push_back({name, std::move(data), {}, std::numeric_limits<double>::quiet_NaN()});
  } else {
    runs = run_scenes(scenes, context);
  }
  for (const Run& run : runs) {
    if (!run.data) throw NoAnswer(run.name + ": " + run.failure);
    if (!run.data->window.steady) {
      throw NoAnswer(run.name + " is not steady: " + run.data->window.reason);
    }
  }
  return runs;
}

}  // namespace grainlaw::study
