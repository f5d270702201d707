#include "lodestone/segmentation/frame_labels.h"

#include <algorithm>
#include <numeric>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"

namespace lodestone::segmentation {

std::vector<std::size_t> doubtful(const FrameLabels& labels, std::size_t most) {
  std::vector<std::size_t> order(labels.labels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return labels.labels[a].doubt > labels.labels[b].doubt;
  });
  order.resize(std::min(order.size(), most));
  return order;
}

std::vector<std::size_t> usable(const FrameLabels& labels, std::size_t first, std::size_t last) {
  std::vector<std::size_t> which;
  for (std::size_t i = first; i < last; ++i)
    if (labels.labels[i].pose || labels.labels[i].by_person) which.push_back(i);
  return which;
}

FrameLabels read_labels(const std::string& file, const std::vector<std::string>& frames) {
  auto labels = common::read_artefact<FrameLabels>(file);
  if (labels.labels.size() != frames.size())
    throw common::DataError(file + " has " + std::to_string(labels.labels.size()) +
                            " labels, and there are " + std::to_string(frames.size()) +
                            " images: give the frames.source and frames.count that it was made of");
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (labels.labels[i].frame != frames[i])
      throw common::DataError(file + ": label " + std::to_string(i) + " is of " + labels.labels[i].frame +
                              ", the image is " + frames[i] + ": it is of other images");
  return labels;
}

}  // namespace lodestone::segmentation
