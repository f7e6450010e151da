#pragma once

#include <string>
#include <vector>

#include "calibration/material_fit.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// A ring cell with a split bottom: what its scene states.
struct RingCell {
  double inner_radius = 0.0;   ///< R_i [length]
  double split_radius = 0.0;   ///< R_s [length]
  double outer_radius = 0.0;   ///< R_o [length]
  double rotation_rate = 0.0;  ///< Omega of the outer part [rad/time]
};

/// omega / Omega in one cell.
struct RotationShare {
  double radius = 0.0;  ///< [length]
  double value = 0.0;
  double error = 0.0;  ///< one standard error, positive
};

/// The band at one height.
struct RingBandRow {
  double z = 0.0;                     ///< above the bottom [length]
  dem::Estimate centre;               ///< R_c [length]
  dem::Estimate width;                ///< W, without what the kernel adds [length]
  double chi_squared = 0.0;           ///< per degree of freedom; well above 1: no error function
  std::vector<RotationShare> shares;  ///< along r, that were fitted
  StatePoint state;                   ///< of the grains at the centre of the band
  double shear_rate = 0.0;            ///< there [1/time]
  double fitted_shear_rate = 0.0;     ///< R_c Omega / (W sqrt(pi)), of the error function [1/time]
};

/// The shear band of a ring cell: where the fields say it lies.
struct RingBand {
  double height = 0.0;             ///< of the free surface: mean phi falls to half its bulk value
  std::vector<RingBandRow> rows;   ///< bottom to top, off bottom and surface by the kernel's reach
  std::vector<std::string> notes;  ///< sentences: heights that could not be fitted
  /// Cells along r or z that share their grains: errors of means of independent cells are too small
  /// by its root.
  double cells_together = 1.0;
};

/// Centre and width of the error function nearest to shares that no kernel has widened.
struct BandShape {
  double centre = 0.0;  ///< R_c [length]
  double width = 0.0;   ///< W [length]
};
/// The errors of the shares are weights. Throws FitError where no error function fits.
BandShape band_shape(const std::vector<RotationShare>& shares, const BandShape& start);

/// Cells whose shear rate is at least this share of the largest one of their height are the centre
/// of the band; they are averaged with their shear rate as weight.
inline constexpr double band_centre_cut = 0.8;

/// Fits v / (r Omega) = 1/2 + 1/2 erf((r - R_c) / W') at each height, W'^2 = W^2 + 2 s^2 with s^2
/// the variance of kernel and cell, which widen a profile so. Cells within reach of a cylinder and
/// those of less than half the bulk density are left out. Neighbouring cells share their grains:
/// errors are those of the cells times sqrt(2 w / cell), and where the fit is bad also times
/// sqrt(chi^2 / degrees of freedom). p of the states is a third of the trace, tau the resultant on
/// the surface between the layers. Throws FitError where no height can be fitted.
RingBand ring_band(const dem::RingFields& fields,
                   const RingCell& cell,
                   const dem::ChuteConditions& conditions);

}  // namespace grainlaw::calibration
