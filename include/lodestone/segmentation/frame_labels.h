#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::segmentation {

struct LabelledPose : geometry::Pose2 {
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("x_m", x_m);
    v.field("y_m", y_m);
    v.field("heading_rad", heading_rad);
  }
};

/// What is said of one image: where the needle lies in it.
struct FrameLabel {
  std::string frame;                  ///< its name
  std::optional<LabelledPose> pose;   ///< absent: no needle, or it could not be told where
  std::optional<std::string> reason;  ///< why not
  double doubt = 1.0;                 ///< of a proposal, 0 to 1
  bool by_person = false;             ///< looked through, so that no pose means no needle

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("frame", frame);
    v.field("pose", pose);
    v.field("reason", reason);
    v.field("doubt", doubt);
    v.field("by_person", by_person);
  }
};

/// Labels of the images of one needle, in their order: `labels.json`.
struct FrameLabels {
  static constexpr const char* kFile = "labels.json";
  std::vector<FrameLabel> labels;
  bool taped = true;  ///< whether one end of the needle looks other than the rest

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("labels", labels);
    v.field("taped", taped);
  }
};

/// Which images a person should look at: those of which there is most doubt first, so many at most.
std::vector<std::size_t> doubtful(const FrameLabels& labels, std::size_t most);

/// Labelled images that may be learned from: with a needle, or looked through by a person. From `first` on,
/// before `last`.
std::vector<std::size_t> usable(const FrameLabels& labels, std::size_t first, std::size_t last);

/// Reads labels.json. Throws IoError, and DataError that names file and image where the labels are not those
/// of these images.
FrameLabels read_labels(const std::string& file, const std::vector<std::string>& frames);

}  // namespace lodestone::segmentation
