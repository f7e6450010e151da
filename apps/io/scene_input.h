#pragma once

#include <filesystem>
#include <string>

#include "apps/io/units.h"
#include "dem/scene.h"

namespace grainlaw::io {

/// A scene as read, in internal units (m = d = g = 1), and the units of its file.
struct SceneFile {
  dem::Scene scene;
  Units units;
  std::string text;  ///< of the file, as it goes into the local data
  std::filesystem::path path;
};

struct SceneOptions {
  bool allow_unstable_step = false;  ///< as if the scene said so (--allow-step)
};

/// Reads and validates a scene. A missing section is a missing mechanism.
/// Throws InputError, and dem::StepRefused for a step that would be unstable.
SceneFile read_scene(const std::filesystem::path& path, const SceneOptions& options = {});

/// Same for a text, e.g. the scene inside a local data file; `path` is for messages.
SceneFile parse_scene(const std::string& text,
                      const std::filesystem::path& path,
                      const SceneOptions& options = {});

/// The keys of a scene file as Markdown.
std::string scene_keys();

}  // namespace grainlaw::io
