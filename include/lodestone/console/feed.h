#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "lodestone/console/seat.h"
#include "lodestone/imaging/frame.h"

namespace lodestone::console {

/// Gives pages the newest image and state as fast as each asks for the next: one that is slow, hidden or
/// stuck asks for nothing, costs nothing and keeps nobody waiting. An image is encoded once, however many
/// look on. Works in a thread of its own.
class Feed {
 public:
  struct Source {
    std::function<std::shared_ptr<const imaging::Frame>()> image;  ///< the newest; null: none
    std::function<double()> now_s;                                 ///< on the clock of images
    std::function<void(PageId page, const std::shared_ptr<const std::string>& image)> send_image;
    std::function<void(PageId page)> send_state;
  };
  static constexpr double kPeriod_s = 0.05;  ///< at most one image and one state a page in this

  explicit Feed(Source source);
  ~Feed();
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  /// Nothing is sent any more.
  void end();

  // From any thread.
  void want_image(PageId page);
  void want_state(PageId page);
  void forget(PageId page);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// An image as pages get it: when it was taken and when it was sent, as little-endian doubles, and a JPEG.
std::string image_message(const imaging::Frame& frame, double now_s);

}  // namespace lodestone::console
