#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <initializer_list>
#include <string>

namespace lodestone::geometry {

constexpr int kMostDrives = 16;

/// What drives a rig's coils during a pulse: as many numbers as its drive takes (RigDescription::drive_size),
/// up to 16. As an action each is within [-1, 1]; otherwise in A, or in percent of the full drive. Holds no
/// memory of its own, so that it may be made in a control loop.
class Drive : public Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostDrives, 1> {
 public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostDrives, 1>;

  /// Of no number.
  Drive() = default;
  explicit Drive(Eigen::Index size) : Matrix(size) {}
  Drive(std::initializer_list<double> numbers) : Matrix(static_cast<Eigen::Index>(numbers.size())) {
    std::copy(numbers.begin(), numbers.end(), data());
  }
  template <class Other>
  Drive(const Eigen::MatrixBase<Other>& other) : Matrix(other) {}  // NOLINT(google-explicit-constructor)
  template <class Other>
  Drive& operator=(const Eigen::MatrixBase<Other>& other) {
    Matrix::operator=(other);
    return *this;
  }
};

/// The drive that stands in memory, number by number.
template <class Number>
Drive as_drive(const Number* numbers, int size) {
  Drive drive(size);
  for (Eigen::Index i = 0; i < size; ++i) drive[i] = static_cast<double>(numbers[i]);
  return drive;
}

/// What its numbers are called in columns: x and y where there are two, else 0, 1, ...
inline std::string number_name(int number, int size) {
  if (size == 2) return number == 0 ? "x" : "y";
  return std::to_string(number);
}

/// A drive of so many numbers from `draw`, the last of them drawn first.
template <class Draw>
Drive drawn_drive(int size, const Draw& draw) {
  Drive drive(size);
  for (Eigen::Index i = size; i-- > 0;) drive[i] = draw();
  return drive;
}

}  // namespace lodestone::geometry
