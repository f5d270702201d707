#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/imaging/dish_view.h"
#include "lodestone/inference/unet.h"
#include "lodestone/vision/rod_fit.h"

namespace lodestone::vision {

/// The network and the scale it works at.
struct SegmenterConfig {
  inference::UNetConfig network;
  double view_pixel_m = 0.2e-3;
  double view_margin_m = 0.0023;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("network", network, "the U-Net");
    v.field("view_pixel_m", view_pixel_m, "m", "side of a pixel of the rectified view", {1e-5, 0.01});
    v.field("view_margin_m", view_margin_m, "m", "the view reaches so far beyond the dish", {0.0, 0.1});
  }
};

/// A trained U-Net, ready for use: says for every mask pixel of a rectified view whether it is needle, and
/// whether it is tape. Const calls may run on several threads.
class Segmenter {
 public:
  static constexpr const char* kKind = "segmenter";  ///< of its checkpoint
  using Workspace = inference::UNet::Workspace;      ///< of one thread

  /// `weights` of the U-Net by name. Throws CheckpointError that begins with `what` when they do not fit.
  Segmenter(const SegmenterConfig& config, const inference::Arrays& weights,
            const std::string& what = "segmenter");
  /// Reads a checkpoint of kind "segmenter". Throws CheckpointError.
  static std::shared_ptr<const Segmenter> load(const std::string& folder);

  /// `view`: [h, w] 8-bit BGR of a DishView, sides multiples of config().network.multiple().
  Evidence segment(const cv::Mat& view, Workspace& workspace) const;

  /// A view of the dish at this segmenter's scale.
  imaging::DishView view_of(const imaging::CameraModel& camera, double dish_radius_m) const;
  /// Where the mask of an area of that view lies.
  MaskGrid grid_of(const imaging::DishView& view, const cv::Rect& area) const;
  const SegmenterConfig& config() const { return config_; }

 private:
  SegmenterConfig config_;
  inference::UNet network_;
};

/// Writes a checkpoint: the network's weights with normaliser and batch normalisation, and what is known of
/// it.
void save_segmenter(const std::string& folder, const SegmenterConfig& config,
                    const inference::Arrays& weights, const common::Json& training,
                    const common::Json& metrics);

}  // namespace lodestone::vision
