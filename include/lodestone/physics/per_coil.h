#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <vector>

#include "lodestone/common/error.h"

namespace lodestone::physics {

constexpr std::size_t kMostCoils = 16;

/// A number for each coil of a rig, in the order in which its description lists them. A coil that was not
/// given one has 0: a pulse for four coils is a pulse for eight in which the others are off. Holds no memory
/// of its own, so that it may be made in a control loop.
class PerCoil {
 public:
  using value_type = double;
  using iterator = double*;
  using const_iterator = const double*;

  /// Nothing for any coil.
  constexpr PerCoil() = default;
  /// The same for so many.
  explicit PerCoil(std::size_t coils, double value = 0.0) { assign(coils, value); }
  PerCoil(std::initializer_list<double> values) {
    for (const double value : values) (*this)[count_] = value;
  }
  template <std::size_t kCoils>
  PerCoil(const std::array<double, kCoils>& values) {
    static_assert(kCoils <= kMostCoils);
    for (const double value : values) (*this)[count_] = value;
  }
  explicit PerCoil(const std::vector<double>& values) {
    for (const double value : values) (*this)[count_] = value;
  }
  std::vector<double> list() const { return {begin(), end()}; }

  /// Throws LogicFault beyond the most coils that a rig may have.
  double& operator[](std::size_t coil) {
    if (coil >= count_) {
      LODESTONE_CHECK(coil < kMostCoils, "coil " + std::to_string(coil) + " of at most 16");
      count_ = coil + 1;
    }
    return values_[coil];
  }
  double operator[](std::size_t coil) const { return coil < count_ ? values_[coil] : 0.0; }

  void assign(std::size_t coils, double value) {
    LODESTONE_CHECK(coils <= kMostCoils, std::to_string(coils) + " coils of at most 16");
    values_ = {};
    for (count_ = 0; count_ < coils; ++count_) values_[count_] = value;
  }
  /// Up to the last coil that was given a number.
  std::size_t size() const { return count_; }
  iterator begin() { return values_.data(); }
  iterator end() { return values_.data() + count_; }
  const_iterator begin() const { return values_.data(); }
  const_iterator end() const { return values_.data() + count_; }

  /// Of coils, whether or not their zeros were given.
  friend bool operator==(const PerCoil& a, const PerCoil& b) { return a.values_ == b.values_; }
  friend bool operator!=(const PerCoil& a, const PerCoil& b) { return !(a == b); }

 private:
  std::array<double, kMostCoils> values_{};  // 0 beyond count_
  std::size_t count_ = 0;
};

}  // namespace lodestone::physics
