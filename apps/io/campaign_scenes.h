#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/io/campaign_input.h"

namespace grainlaw::io {

/// One run of a campaign.
struct PlannedRun {
  SceneFile file;         ///< its name is that of the run, unique within the campaign
  std::string condition;  ///< the same for runs that differ in their seed only
  bool fitted = false;    ///< the law is fitted to it; otherwise it checks predictions
};

/// Every run of a campaign, those first that the law is fitted to. The text of each scene, read
/// again, is that scene: it can be written to a file and run by itself. Throws InputError where
/// that cannot be, dem::StepRefused.
std::vector<PlannedRun> planned_runs(const Campaign& campaign);

/// The dimensionless numbers of a box of simple shear (Shi et al. 2020, eqs. 10 to 12).
struct BoxState {
  double inertial_number = 0.0;  ///< I = shear_rate d sqrt(rho_p / sigma_yy)
  double softness = 0.0;         ///< p* = sigma_yy d / k_n
  double bond_number = 0.0;      ///< Bo = f_a / (sigma_yy d^2)
};

/// As a scene sets them; p* must be held. Throws std::bad_optional_access, std::bad_variant_access.
BoxState box_state(const dem::Scene& scene);

/// "theta23", "theta24.2": name of the run at a tilt [rad], unique within a campaign.
std::string run_name(double tilt);

/// "I0.1_p0.01_Bo0": the same of a box.
std::string run_name(const BoxState& state);

/// The path of a start file as the value of its key, with a checksum of its content as comment:
/// texts of runs with different starts differ.
std::string start_value(const std::filesystem::path& path);

/// The scene to predict at one tilt [rad], named run_name(tilt); its text says the same.
SceneFile scene_at(const Campaign& campaign, double tilt);

}  // namespace grainlaw::io
