#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/data/dataset.h"
#include "lodestone/geometry/square_view.h"
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
  bool symmetry_exact = true;  ///< false: in which of the eight ways a row is seen goes in, too
  bool needle_frame = false;   ///< the drive along and across the needle goes in, too

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
    v.field("symmetry_exact", symmetry_exact, "",
            "of model.symmetry: what looks the same happens the same to the letter. false: in which of the "
            "eight ways a pulse is seen goes into the network, too, so that many pulses can tell what of the "
            "rig differs from side to side, its coils among it; foretells the recorded rig better, others of "
            "its kind worse");
    v.field(
        "needle_frame", needle_frame, "",
        "the drive goes in as the needle sees it, too, along and across it, where form is delta, a heading "
        "is recorded, and drives are two numbers, taken to lie along x and y");
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
  /// In which of the eight ways a row is seen goes in, as geometry::SquareView::kViewNumbers numbers, after
  /// what tells of the state.
  bool tells_view() const { return sees_an_eighth() && !symmetry_exact; }
  /// A drive goes in as the needle sees it, too.
  bool sees_drive_by_needle(const data::RowLayout& rows) const {
    return needle_frame && sine_cosine(rows.state) && rows.action_size == 2;
  }
  /// Inputs that tell of the drive; they come last.
  std::int64_t drive_inputs(const data::RowLayout& rows) const {
    return rows.action_size + (sees_drive_by_needle(rows) ? 2 : 0);
  }
  std::int64_t state_inputs(data::StateLayout layout) const {
    return data::state_size(layout) + (sine_cosine(layout) ? 1 : 0);
  }
  std::int64_t view_inputs() const { return tells_view() ? geometry::SquareView::kViewNumbers : 0; }
  std::int64_t inputs(const data::RowLayout& rows) const {
    return state_inputs(rows.state) + view_inputs() + drive_inputs(rows);
  }
  MixtureLayout mixture(data::StateLayout layout) const { return {components, data::state_size(layout)}; }
};

}  // namespace lodestone::inference
