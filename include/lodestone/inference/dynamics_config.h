#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/data/dataset.h"
#include "lodestone/inference/dense_network.h"
#include "lodestone/inference/mixture.h"

namespace lodestone::inference {

/// The paper's: heading in, next state out. Delta: sine and cosine of the heading in, change of state out.
enum class DynamicsForm { kPaper, kDelta };
inline std::vector<std::string> names_of(DynamicsForm) { return {"paper", "delta"}; }

/// In how many ways a rig looks the same. Square: four coils alike around the dish, so that what happens,
/// seen a quarter turn on or in a mirror along an axis, is what would happen there. True of the rig as it is
/// described; no single one is built so well, and none has the same friction everywhere. Described: square
/// where the description that the recording carries has four coils alike in opposed pairs, none elsewhere;
/// what it came to stands in the checkpoint.
enum class Symmetry { kNone, kSquare, kDescribed };
inline std::vector<std::string> names_of(Symmetry) { return {"none", "square", "described"}; }

/// Shape of the learned dynamics.
struct DynamicsConfig {
  DynamicsForm form = DynamicsForm::kPaper;
  std::vector<std::int64_t> hidden = {256, 128, 32};
  bool batch_norm = true;    ///< on the input and every hidden layer
  bool input_relu = false;   ///< after that, on the input, too
  std::int64_t members = 1;  ///< ensemble size
  std::int64_t components =
      0;  ///< Gaussians of the predicted distribution; 0: a single value, as in the paper
  Symmetry symmetry = Symmetry::kNone;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("form", form, "", "what goes in and out");
    v.field("hidden", hidden, "", "width of each hidden layer", {1, kWidestLayer});
    v.field("batch_norm", batch_norm, "", "batch normalisation on input and hidden layers");
    v.field(
        "input_relu", input_relu, "",
        "what is below zero of the normalised input is cut off as in a hidden layer: the other way to read "
        "section IV-B1");
    v.field("members", members, "", "networks in the ensemble", {1, 64});
    v.field(
        "components", components, "",
        "Gaussians in the mixture that each network predicts (stick-slip is random, and a mean hides it); 0: "
        "a single value, as in the paper",
        {0, 16});
    v.field("symmetry", symmetry, "",
            "of the rig, built in: what looks the same happens the same. square: four coils alike around the "
            "dish, so every pulse is seen turned and mirrored into the same eighth of it; described: square "
            "where the recording's rig.json says so, else none. Where pulses are few, training.symmetry does "
            "better");
  }

  void validate() const {
    if (hidden.size() > kMostLayers)
      throw common::InvalidConfig("hidden", hidden,
                                  "name at most " + std::to_string(kMostLayers) + " layers");
  }
  /// Every row is seen in one eighth of the dish (geometry::SquareView).
  bool sees_an_eighth() const { return symmetry == Symmetry::kSquare; }
  bool predicts_change() const { return form == DynamicsForm::kDelta; }
  /// A heading goes in as sine and cosine.
  bool sine_cosine(data::StateLayout layout) const {
    return predicts_change() && layout == data::StateLayout::kPose;
  }
  std::int64_t inputs(const data::RowLayout& rows) const {
    return data::state_size(rows.state) + rows.action_size + (sine_cosine(rows.state) ? 1 : 0);
  }
  MixtureLayout mixture(data::StateLayout layout) const { return {components, data::state_size(layout)}; }
};

}  // namespace lodestone::inference
