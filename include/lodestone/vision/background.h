#pragma once

#include <vector>

#include "lodestone/vision/rod_fit.h"

namespace lodestone::vision {

/// The same place and angle, as far as two images tell. Which end is the head does not matter.
bool lies_alike(const Rod& a, const Rod& b);

/// What looks like a needle and stays put while pulses turn needles: reflections, scratches, a bit of wire.
/// What one pulse has left where it was is background; a needle that stuck is one no more as soon as it
/// stirs.
class Background {
 public:
  /// Nothing is known of the dish.
  void forget() { things_.clear(); }
  /// The coils made a field.
  void pulse();
  /// And went off before that pulse was over: it may have moved nothing. Before the next look.
  void pulse_cut();
  /// What a look shows.
  void see(const std::vector<Rod>& candidates);
  /// This is background, as pulses should have moved it that have not.
  void add(const Rod& rod) { things_.push_back({rod, 1, true}); }
  /// The needle lies like this: so it is none of the background, whatever stays put there.
  void except(const Rod& needle);

  /// Something has lain there from before a pulse until after it.
  bool holds(const Rod& rod) const;
  /// Something lay near before a pulse, and nothing like it: the pulse has turned it, or moved it a little.
  bool has_stirred(const Rod& rod) const;

 private:
  struct Thing {
    Rod rod;             ///< as it was seen first
    int pulses = 0;      ///< since it was seen first
    bool still = false;  ///< and there it was after one of them
  };
  std::vector<Thing> things_;  // the latest last
};

}  // namespace lodestone::vision
