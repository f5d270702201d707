#include "lodestone/physics/solid_harmonics.h"

#include <complex>
#include <vector>

#include "lodestone/common/error.h"

namespace lodestone::physics {
namespace {

using Complex = std::complex<double>;

/// R_l^m of degree 0 to `degree` and order 0 to l; of negative orders, and beyond l, by symmetry.
class Regular {
 public:
  Regular(int degree, const Eigen::Vector3d& p)
      : values_(static_cast<std::size_t>((degree + 1) * (degree + 2) / 2)) {
    const Complex across(-p.x(), -p.y());
    const double square = p.squaredNorm();
    at(0, 0) = 1.0;
    for (int l = 1; l <= degree; ++l) {
      at(l, l) = at(l - 1, l - 1) * across / (2.0 * l);
      for (int m = l - 1; m >= 0; --m) {
        Complex value = (2.0 * l - 1.0) * p.z() * at(l - 1, m);
        if (m <= l - 2) value -= square * at(l - 2, m);
        at(l, m) = value / static_cast<double>((l + m) * (l - m));
      }
    }
  }
  Complex operator()(int l, int m) const {
    if (m > l || -m > l) return 0.0;
    if (m >= 0) return values_[index(l, m)];
    return (m % 2 == 0 ? 1.0 : -1.0) * std::conj(values_[index(l, -m)]);
  }

 private:
  static std::size_t index(int l, int m) { return static_cast<std::size_t>(l * (l + 1) / 2 + m); }
  Complex& at(int l, int m) { return values_[index(l, m)]; }
  std::vector<Complex> values_;
};

}  // namespace

HarmonicGradients harmonic_gradients(int degree, const Eigen::Vector3d& point) {
  LODESTONE_CHECK(degree >= 1, "harmonics of degree 1 at least");
  const Regular regular(degree - 1, point);
  HarmonicGradients gradients(3, harmonic_count(degree));
  Eigen::Index column = 0;
  for (int l = 1; l <= degree; ++l)
    for (int m = 0; m <= l; ++m) {
      const Complex up = regular(l - 1, m + 1);     // (d/dx + i d/dy) R_l^m
      const Complex down = -regular(l - 1, m - 1);  // (d/dx - i d/dy) R_l^m
      const Complex x = 0.5 * (up + down);
      const Complex y = Complex(0.0, -0.5) * (up - down);
      const Complex z = regular(l - 1, m);
      gradients.col(column++) << x.real(), y.real(), z.real();
      if (m > 0) gradients.col(column++) << x.imag(), y.imag(), z.imag();
    }
  return gradients;
}

}  // namespace lodestone::physics
