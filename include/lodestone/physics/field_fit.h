#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "lodestone/physics/coils_description.h"
#include "lodestone/physics/field_samples.h"
#include "lodestone/physics/measured_region.h"

namespace lodestone::physics {

/// How far a field is from samples.
struct FieldError {
  std::int64_t samples = 0;
  double relative_rms = 0.0;          ///< RMS of the difference's magnitude over that of the samples' own
  double rms_T = 0.0;                 ///< of the difference's magnitude
  double direction_median_deg = 0.0;  ///< angle between the two
  double direction_p95_deg = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("samples", samples);
    v.field("relative_rms", relative_rms);
    v.field("rms_T", rms_T);
    v.field("direction_median_deg", direction_median_deg);
    v.field("direction_p95_deg", direction_p95_deg);
  }
};

/// The field of coils of which no geometry is known, cored ones for example: a set of harmonics for each coil
/// and one for what is there without current. Linear in the currents, so not for cores that saturate.
struct MeasuredField {
  MeasuredRegion region;
  std::vector<std::vector<double>> coils_T_per_A;  ///< [coils][harmonics]

  /// T, at a point (m) for as many currents (A) as there are coils. Throws DataError that names the point
  /// when it lies outside the box.
  Eigen::Vector3d field_T(const Eigen::VectorXd& current_A, const Eigen::Vector3d& point_m) const;
  /// Coils that are otherwise as described, with this field: each listed. Throws DataError when they are
  /// another number.
  CoilsDescription applied_to(const CoilsDescription& described) const;
};

/// Throws DataError when a sample lies outside the field's box, or has another number of coils.
FieldError field_error(const MeasuredField& field, const FieldSamples& samples);
/// Of a field as it is predicted at each sample (T), over some of them.
FieldError field_error(const std::function<Eigen::Vector3d(std::size_t sample)>& predicted_T,
                       const FieldSamples& samples, const std::vector<bool>& of);

/// A field fitted to samples, and how well it explains samples that it was not fitted to.
struct FieldFit {
  MeasuredField field;
  std::int64_t degree = 0;                 ///< of its harmonics
  FieldError fitted;                       ///< on what it was fitted to
  FieldError held_out;                     ///< each fifth of the samples by a fit to the rest
  std::vector<double> held_out_by_degree;  ///< relative RMS of degree 1, 2, ...
};

/// Least squares of solid harmonics to samples, a set for each coil and one for the field without currents;
/// of the degrees that the samples suffice for, up to 8, the one that explains held-out samples best. Throws
/// DataError where there are too few samples, they lie in a plane or on a line, or even the best fit leaves
/// more than a tenth of the field.
FieldFit fit_field(const FieldSamples& samples);

}  // namespace lodestone::physics
