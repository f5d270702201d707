#include "lodestone/physics/field_fit.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/solid_harmonics.h"

namespace lodestone::physics {
namespace {

constexpr int kHighestDegree = 8;
constexpr std::size_t kFolds = 5;
constexpr double kAround = 0.02;         // of the box of the samples, on each side
constexpr double kMostLeft = 0.1;        // of the field
constexpr double kRowsPerUnknown = 1.5;  // at least, in a fit to four fifths of the samples

/// Sums of a least-squares fit: of unknowns [set][harmonic], the background's set last.
struct Sums {
  Eigen::MatrixXd normal;
  Eigen::VectorXd right;
};

/// Where the samples lie, and a little around it: what is asked for later may lie a little further out than
/// any of these.
struct Box {
  Eigen::Vector3d low, high;
  Eigen::Vector3d centre() const { return 0.5 * (low + high); }
  double scale() const { return 0.5 * (high - low).norm(); }
};

Box box_of(const FieldSamples& samples) {
  Box box{samples.position_m.front(), samples.position_m.front()};
  for (const Eigen::Vector3d& position : samples.position_m) {
    box.low = box.low.cwiseMin(position);
    box.high = box.high.cwiseMax(position);
  }
  const Eigen::Vector3d around = kAround * (box.high - box.low);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (!(box.high[axis] > box.low[axis]))
      throw common::DataError(
          fmt::format("all samples have the same {}: the field is needed in a volume, so that "
                      "it is known how it changes",
                      "xyz"[axis]));
  box.low -= around;
  box.high += around;
  return box;
}

std::size_t unknowns(const FieldSamples& samples, int degree) {
  return (samples.coils + 1) * static_cast<std::size_t>(harmonic_count(degree));
}

int highest_degree(const FieldSamples& samples) {
  const double rows = 3.0 * static_cast<double>(samples.size()) * (kFolds - 1) / kFolds;
  int degree = 0;
  while (degree < kHighestDegree &&
         rows >= kRowsPerUnknown * static_cast<double>(unknowns(samples, degree + 1)))
    ++degree;
  if (degree == 0)
    throw common::DataError(
        fmt::format("{} samples are too few for {} coils: at least {} are needed, some hundred are better",
                    samples.size(), samples.coils,
                    std::ceil(kRowsPerUnknown * static_cast<double>(unknowns(samples, 1)) * kFolds /
                              (kFolds - 1) / 3.0)));
  return degree;
}

/// One sample's three rows. The background is a coil that always has this current.
Eigen::MatrixXd rows_of(const FieldSamples& samples, std::size_t i, const Box& box, int degree) {
  const HarmonicGradients gradients =
      harmonic_gradients(degree, (samples.position_m[i] - box.centre()) / box.scale());
  const Eigen::Index count = gradients.cols();
  Eigen::MatrixXd rows(3, static_cast<Eigen::Index>(samples.coils + 1) * count);
  for (std::size_t set = 0; set <= samples.coils; ++set) {
    const double current = set < samples.coils ? samples.current_A[i][static_cast<Eigen::Index>(set)] : 1.0;
    rows.middleCols(static_cast<Eigen::Index>(set) * count, count) = current * gradients;
  }
  return rows;
}

std::array<Sums, kFolds> sums_by_fold(const FieldSamples& samples, const std::vector<std::size_t>& fold,
                                      const Box& box, int degree) {
  constexpr Eigen::Index kBlock = 64;
  const auto size = static_cast<Eigen::Index>(unknowns(samples, degree));
  std::array<Sums, kFolds> sums;
  for (std::size_t which = 0; which < kFolds; ++which) {
    Sums& sum = sums[which];
    sum.normal = Eigen::MatrixXd::Zero(size, size);
    sum.right = Eigen::VectorXd::Zero(size);
    Eigen::MatrixXd block(3 * kBlock, size);
    Eigen::VectorXd seen(3 * kBlock);
    Eigen::Index filled = 0;
    const auto add = [&] {
      sum.normal.selfadjointView<Eigen::Lower>().rankUpdate(block.topRows(filled).transpose());
      sum.right += block.topRows(filled).transpose() * seen.head(filled);
      filled = 0;
    };
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (fold[i] != which) continue;
      block.middleRows(filled, 3) = rows_of(samples, i, box, degree);
      seen.segment(filled, 3) = samples.field_T[i];
      filled += 3;
      if (filled == block.rows()) add();
    }
    add();
  }
  return sums;
}

/// The fit of a lower degree needs a part of the sums only: of each set the first harmonics.
MeasuredField solve(const Sums& sums, const FieldSamples& samples, const Box& box, int degree,
                    int summed_degree) {
  const Eigen::Index count = harmonic_count(degree), summed = harmonic_count(summed_degree);
  const auto sets = static_cast<Eigen::Index>(samples.coils + 1);
  Eigen::MatrixXd normal(sets * count, sets * count);
  Eigen::VectorXd right(sets * count);
  for (Eigen::Index a = 0; a < sets; ++a) {
    right.segment(a * count, count) = sums.right.segment(a * summed, count);
    for (Eigen::Index b = 0; b <= a; ++b)
      normal.block(a * count, b * count, count, count) =
          sums.normal.block(a * summed, b * summed, count, count);
  }
  // Columns differ by orders of magnitude: of the same length, they are solved to more digits. The floor
  // keeps a combination that the samples say nothing of at zero.
  constexpr double kFloor = 1e-10;
  const Eigen::VectorXd length = normal.diagonal().cwiseSqrt().cwiseMax(1e-300);
  const Eigen::VectorXd shrink = length.cwiseInverse();
  Eigen::MatrixXd scaled =
      shrink.asDiagonal() * normal.selfadjointView<Eigen::Lower>().toDenseMatrix() * shrink.asDiagonal();
  scaled.diagonal().array() += kFloor;
  const Eigen::VectorXd solved =
      shrink.cwiseProduct(Eigen::LLT<Eigen::MatrixXd>(scaled).solve(shrink.cwiseProduct(right).eval()));
  MeasuredField field;
  const auto numbers = [](const Eigen::Vector3d& p) { return std::vector<double>{p.x(), p.y(), p.z()}; };
  field.region.centre_m = numbers(box.centre());
  field.region.scale_m = box.scale();
  field.region.low_m = numbers(box.low);
  field.region.high_m = numbers(box.high);
  for (Eigen::Index set = 0; set < sets; ++set) {
    std::vector<double> coefficients(solved.data() + set * count, solved.data() + (set + 1) * count);
    if (set + 1 < sets)
      field.coils_T_per_A.push_back(std::move(coefficients));
    else
      field.region.background_T = std::move(coefficients);
  }
  return field;
}

Sums total(const std::array<Sums, kFolds>& sums, std::size_t without) {
  Sums all{Eigen::MatrixXd::Zero(sums[0].normal.rows(), sums[0].normal.cols()),
           Eigen::VectorXd::Zero(sums[0].right.size())};
  for (std::size_t fold = 0; fold < kFolds; ++fold)
    if (fold != without) {
      all.normal += sums[fold].normal;
      all.right += sums[fold].right;
    }
  return all;
}

/// Differences between a field and samples, one after the other.
struct ErrorSum {
  double squares = 0.0, own_squares = 0.0;
  std::vector<double> angles_deg;

  void add(const Eigen::Vector3d& predicted_T, const Eigen::Vector3d& seen_T) {
    squares += (predicted_T - seen_T).squaredNorm();
    own_squares += seen_T.squaredNorm();
    angles_deg.push_back(std::atan2(predicted_T.cross(seen_T).norm(), predicted_T.dot(seen_T)) * 180.0 /
                         geometry::kPi);
  }
  FieldError error() const {
    FieldError result;
    result.samples = static_cast<std::int64_t>(angles_deg.size());
    result.relative_rms = own_squares > 0.0 ? std::sqrt(squares / own_squares) : 0.0;
    result.rms_T = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(angles_deg.size(), 1)));
    result.direction_median_deg = common::median(angles_deg);
    result.direction_p95_deg = common::percentile(angles_deg, 0.95);
    return result;
  }
};

FieldError held_out_error(const std::array<Sums, kFolds>& sums, const FieldSamples& samples,
                          const std::vector<std::size_t>& fold, const Box& box, int degree,
                          int summed_degree) {
  ErrorSum errors;
  for (std::size_t which = 0; which < kFolds; ++which) {
    const MeasuredField field = solve(total(sums, which), samples, box, degree, summed_degree);
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (fold[i] == which)
        errors.add(field.field_T(samples.current_A[i], samples.position_m[i]), samples.field_T[i]);
  }
  return errors.error();
}

}  // namespace

Eigen::Vector3d MeasuredField::field_T(const Eigen::VectorXd& current_A,
                                       const Eigen::Vector3d& point_m) const {
  LODESTONE_CHECK(current_A.size() == static_cast<Eigen::Index>(coils_T_per_A.size()),
                  "a current for each coil");
  region.check_holds(point_m);
  std::vector<double> all = region.background_T;  // as many numbers as of each coil: one sum for all
  for (std::size_t coil = 0; coil < coils_T_per_A.size(); ++coil)
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] += current_A[static_cast<Eigen::Index>(coil)] * coils_T_per_A[coil][i];
  return region.sum(all, point_m);
}

CoilsDescription MeasuredField::applied_to(const CoilsDescription& described) const {
  if (described.count() != coils_T_per_A.size())
    throw common::DataError(
        fmt::format("the samples are of {} coils, the rig has {}", coils_T_per_A.size(), described.count()));
  CoilsDescription coils = described;
  coils.each.clear();
  for (std::size_t coil = 0; coil < described.count(); ++coil) {
    coils.each.push_back(described.coil(coil));
    coils.each.back().gain = 1.0;  // is in what was measured
    coils.each.back().harmonics_T_per_A = coils_T_per_A[coil];
  }
  coils.measured = region;
  return coils;
}

FieldError field_error(const MeasuredField& field, const FieldSamples& samples) {
  if (samples.coils != field.coils_T_per_A.size())
    throw common::DataError(fmt::format("the samples are of {} coils, the field of {}", samples.coils,
                                        field.coils_T_per_A.size()));
  ErrorSum errors;
  for (std::size_t i = 0; i < samples.size(); ++i)
    errors.add(field.field_T(samples.current_A[i], samples.position_m[i]), samples.field_T[i]);
  return errors.error();
}

FieldError field_error(const std::function<Eigen::Vector3d(std::size_t sample)>& predicted_T,
                       const FieldSamples& samples, const std::vector<bool>& of) {
  ErrorSum errors;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (of[i]) errors.add(predicted_T(i), samples.field_T[i]);
  return errors.error();
}

FieldFit fit_field(const FieldSamples& samples) {
  LODESTONE_CHECK(samples.size() > 0, "samples");
  const Box box = box_of(samples);
  const int highest = highest_degree(samples);
  common::RandomStream random(1, "folds of a field's samples");
  std::vector<std::size_t> fold(samples.size());
  for (std::size_t& which : fold) which = random.below(kFolds);
  const std::array<Sums, kFolds> sums = sums_by_fold(samples, fold, box, highest);
  FieldFit fit;
  int best = 0;
  for (int degree = 1; degree <= highest; ++degree) {
    const FieldError error = held_out_error(sums, samples, fold, box, degree, highest);
    fit.held_out_by_degree.push_back(error.relative_rms);
    if (best != 0 && error.relative_rms >= fit.held_out.relative_rms) continue;
    best = degree;
    fit.held_out = error;
  }
  if (!(fit.held_out.relative_rms <= kMostLeft))
    throw common::DataError(fmt::format(
        "even the best fit leaves {:.0f} % of the field unexplained (at most {:.0f}): is a column in "
        "another unit, are two of them swapped, do cores saturate, or are {} samples too few for {} coils?",
        100.0 * fit.held_out.relative_rms, 100.0 * kMostLeft, samples.size(), samples.coils));
  fit.field = solve(total(sums, kFolds), samples, box, best, highest);
  fit.degree = best;
  fit.fitted = field_error(fit.field, samples);
  return fit;
}

}  // namespace lodestone::physics
