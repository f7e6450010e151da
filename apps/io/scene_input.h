#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/io/scene_geometry.h"
#include "apps/io/scene_text.h"
#include "apps/io/units.h"
#include "dem/scene.h"

namespace grainlaw::io {

/// A scene as read, in internal units (m = d = g = 1), and the units of its file.
struct SceneFile {
  dem::Scene scene;
  Units units;
  std::string text;  ///< as it goes into the local data: of the file, with what was overridden
  std::filesystem::path path;
};

struct SceneOptions {
  bool allow_unstable_step = false;  ///< as if the scene said so (--allow-step)
};

/// Reads and validates a scene, and the file of its start, which is relative to `path`. A missing
/// section is a missing mechanism.
/// Throws InputError, and dem::StepRefused for a step that would be unstable.
SceneFile read_scene(const std::filesystem::path& path, const SceneOptions& options = {});

/// Same for a text, e.g. the scene inside a local data file; `path` is for messages.
SceneFile parse_scene(const std::string& text,
                      const std::filesystem::path& path,
                      const SceneOptions& options = {});

/// Makes the text of a file whose scene was changed say the same, so that the text read again is
/// the scene of the run. Where that cannot be done line by line, comment lines in front of the text
/// state the values.
void restate(SceneFile& file, const std::vector<Override>& overrides);

/// The keys of a scene file as Markdown.
std::string scene_keys();

}  // namespace grainlaw::io
