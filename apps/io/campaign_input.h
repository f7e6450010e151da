#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/io/scene_input.h"

namespace grainlaw::io {

/// A box of simple shear at every combination of I, p* and Bo.
struct ShearBoxes {
  SceneFile scene;
  std::vector<double> inertial_numbers;
  std::vector<double> softness;      ///< p*; empty: the pressure of the scene
  std::vector<double> bond_numbers;  ///< Bo; empty: the cohesion of the scene
  std::optional<double> strain;      ///< to average over; absent: the times of the scene
};

/// Chutes that differ in one property, or belong together otherwise.
struct ChuteSeries {
  std::string name;
  std::vector<SceneFile> scenes;
};

/// Scenes at many conditions: some for the fit, others to check the predictions. With shear boxes
/// the law is fitted to them, and chutes are predictions across geometries; without, to the chutes
/// of the calibration tilts.
struct Campaign {
  std::string title;
  SceneFile scene;                           ///< of the chutes; nothing without tilts
  std::optional<SceneFile> calibrate_scene;  ///< of the calibration tilts; absent: `scene`
  std::vector<double> calibrate_tilts;       ///< [rad], as in the file
  std::vector<double> predict_tilts;         ///< [rad]
  std::vector<ShearBoxes> shear_boxes;
  std::vector<ChuteSeries> series;      ///< instead of tilts and boxes: no law is fitted to them
  std::vector<std::int64_t> seeds;      ///< each run once per seed; empty: the seed of the scene
  std::filesystem::path start_table{};  ///< its predictions start the runs; empty: from rest
  std::string text;                     ///< of the campaign file
  std::filesystem::path path;
};

/// Reads campaign and scenes, and sees that every run can be made of them. Throws InputError,
/// dem::StepRefused.
Campaign read_campaign(const std::filesystem::path& path);

/// The keys of a campaign file as Markdown.
std::string campaign_keys();

}  // namespace grainlaw::io
