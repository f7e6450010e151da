#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/io/local_data_hdf5.h"
#include "apps/io/study_input.h"
#include "continuum/rheology_table.h"

namespace grainlaw::study {

/// The runs of a study of laws.
struct LawData {
  std::vector<dem::LocalData> chutes;    ///< fitted
  std::vector<dem::LocalData> boxes;     ///< fitted: homogeneous shear, for p* and Bo
  std::vector<io::RunRecord> bands;      ///< fitted: the first gives the nonlocal amplitude
  std::vector<io::RunRecord> predicted;  ///< chutes and bands
};

bool is_chute(const dem::LocalData& data);

/// Throws io::InputError for a run that is not steady or of no use here.
LawData read_law_data(const io::LawStudy& study);

/// A fitted law: the table to use for a flow, and the nonlocal amplitude where it has one.
struct FittedLaw {
  std::function<const continuum::RheologyTable&(const dem::ChuteConditions&)> table_for;
  int coefficients = 0;
  bool of_chutes_only = false;
  std::optional<double> nonlocal = {};
};

/// A law that can be fitted; throws FitError where the runs do not allow it.
struct Law {
  std::string name;
  std::function<FittedLaw(const LawData&)> fit;
};

/// From simple to complex.
std::vector<Law> laws();

}  // namespace grainlaw::study
