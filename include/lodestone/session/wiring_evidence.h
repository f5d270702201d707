#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lodestone/physics/four_coils.h"

namespace lodestone::session {

/// One way in which the coils may be connected: who asks for coil i gets coil `coil[i]`, with its field
/// turned round where `sign[i]` is -1.
struct CoilWiring {
  /// The paper's four, as they should be.
  CoilWiring() : CoilWiring(physics::kFourCoils) {}
  /// So many, as they should be.
  explicit CoilWiring(std::size_t coils);
  std::vector<int> coil;
  std::vector<int> sign;

  bool operator==(const CoilWiring& other) const { return coil == other.coil && sign == other.sign; }
};

/// What answers in the place of a coil.
struct CoilAnswer {
  int coil = 0;
  int sign = 1;
};

/// Wirings that nothing has ruled out.
struct PossibleWirings {
  /// A rig of many coils has more than anybody would list.
  static constexpr std::size_t kMostListed = 1000;

  std::vector<CoilWiring> listed;                ///< all of them, or the first kMostListed
  std::vector<std::vector<CoilAnswer>> answers;  ///< [coils]: what may answer in the place of each

  /// How much is still open: less when something is ruled out, 1 when one wiring is left.
  std::size_t open() const;
};

/// What speaks against each coil answering in the place of each other one, and against the wirings that are
/// made of them. Of up to 16 coils, of which there are 2^16 16! wirings: the least of all is found over the
/// sets of coils that the first few ask for (Held and Karp 1962).
class WiringEvidence {
 public:
  explicit WiringEvidence(std::size_t coils);

  std::size_t coils() const { return against_.size(); }
  /// A log-likelihood, up to a constant, against `coil` answering who asks for `asked`, turned round or not.
  void add(std::size_t asked, std::size_t coil, bool reversed, double against);

  /// Against the most likely wiring.
  double least() const;
  /// Wirings with less than `more` more against them.
  PossibleWirings possible(double more) const;

 private:
  using Sets = std::vector<double>;  // [2^coils]

  /// Least against the first coils asked for, where they are answered by the coils of a set.
  Sets least_before() const;
  /// Least against all the others, which the other coils answer.
  Sets least_after() const;
  double either_way(std::size_t asked, std::size_t coil) const;
  void list(PossibleWirings& possible, CoilWiring& wiring, std::size_t asked, std::size_t set, double sum,
            double bound, const Sets& after) const;

  std::vector<std::vector<std::array<double, 2>>> against_;  // [coils, coils, reversed]
};

}  // namespace lodestone::session
