#pragma once

#include <array>
#include <string>
#include <vector>

#include "lodestone/physics/coils_description.h"
#include "lodestone/physics/field_fit.h"
#include "lodestone/physics/field_samples.h"

namespace lodestone::physics {

/// By what a coil differs from its description.
struct CoilShift {
  std::string name;
  std::array<double, 3> moved_m = {};
  double tilted_deg = 0.0;
  double gain = 1.0;  ///< of its field, relative to what was described
};

/// Air-core coils that stand where samples say, and how well they explain them.
struct CoilFit {
  CoilsDescription coils;                   ///< listed one by one
  std::vector<CoilShift> shifts;            ///< of each coil
  std::array<double, 3> background_T = {};  ///< what is there without current
  FieldError described;                     ///< of all samples, before anything was fitted
  FieldError held_out;                      ///< of every fifth sample, by a fit to the others
  FieldError fitted;                        ///< of all samples, by the fit to all
};

/// Moves, tilts and scales each coil of a description until their exact fields are nearest to the samples:
/// least squares, with standard deviations of 5 mm, 6 degrees and 10 % for what a description leaves open, so
/// that what the samples do not tell stays as it was described. Throws DataError where the samples are of
/// another number of coils, too few, or of coils without a winding (harmonics_T_per_A), or more than a tenth
/// of the field is left: cores, swapped columns or units.
CoilFit fit_coils(const CoilsDescription& described, const FieldSamples& samples);

/// How far the field of described coils is from samples. What is there without current counts as an error,
/// unless the coils were measured with it. Throws DataError as above, and where a sample lies in a winding or
/// where nobody measured.
FieldError field_error(const CoilsDescription& coils, const FieldSamples& samples);

}  // namespace lodestone::physics
