#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/io/scene_input.h"

namespace grainlaw::io {

/// One scene at several tilts: some for the fit, others to check the predictions.
struct Campaign {
  std::string title;
  SceneFile scene;
  std::vector<double> calibrate_tilts;  ///< [rad], as in the file
  std::vector<double> predict_tilts;    ///< [rad]
  std::filesystem::path start_table{};  ///< its predictions start the runs; empty: from rest
  std::string text;                     ///< of the campaign file
  std::filesystem::path path;
};

/// Reads campaign and scene. Throws InputError, dem::StepRefused.
Campaign read_campaign(const std::filesystem::path& path);

/// "theta23", "theta24.2": name of the run at a tilt [rad], unique within a campaign.
std::string run_name(double tilt);

/// The scene of a campaign at one tilt [rad], named run_name(tilt); its text says the same.
SceneFile scene_at(const Campaign& campaign, double tilt);

/// The keys of a campaign file as Markdown.
std::string campaign_keys();

}  // namespace grainlaw::io
