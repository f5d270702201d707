#include "lodestone/console/feed.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstring>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

using namespace lodestone;
using console::Feed;
using console::PageId;

namespace {

/// A camera that is told when to take its next image, and what pages were sent.
struct Hall {
  Hall() {
    Feed::Source source;
    source.image = [this] {
      const std::lock_guard<std::mutex> lock(mutex);
      return frame;
    };
    source.now_s = [] { return 7.0; };
    source.send_image = [this](PageId page, const std::shared_ptr<const std::string>& image) {
      const std::lock_guard<std::mutex> lock(mutex);
      images[page].push_back(image);
    };
    source.send_state = [this](PageId page) {
      const std::lock_guard<std::mutex> lock(mutex);
      ++states[page];
    };
    feed = std::make_unique<Feed>(std::move(source));
  }
  void take(double stamp_s) {
    const auto taken = std::make_shared<imaging::Frame>();
    taken->image = cv::Mat(48, 64, CV_8UC3, cv::Scalar(10, 20, 30));
    taken->stamp_s = stamp_s;
    const std::lock_guard<std::mutex> lock(mutex);
    frame = taken;
  }
  std::size_t had(PageId page) {
    const std::lock_guard<std::mutex> lock(mutex);
    return images[page].size();
  }
  bool reach(PageId page, std::size_t count) {
    for (int i = 0; i < 1000 && had(page) < count; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return had(page) == count;
  }

  std::mutex mutex;
  std::shared_ptr<const imaging::Frame> frame;
  std::map<PageId, std::vector<std::shared_ptr<const std::string>>> images;
  std::map<PageId, int> states;
  std::unique_ptr<Feed> feed;
};

}  // namespace

TEST_CASE("a page gets each image once, and only what it asks for") {
  Hall hall;
  hall.feed->want_image(1);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  CHECK(hall.had(1) == 0);  // there is none yet
  hall.take(1.0);
  REQUIRE(hall.reach(1, 1));
  hall.take(2.0);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(hall.had(1) == 1);  // it has not asked again
  hall.feed->want_image(1);
  hall.feed->want_image(2);
  REQUIRE(hall.reach(1, 2));
  REQUIRE(hall.reach(2, 1));
  hall.feed->want_image(1);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(hall.had(1) == 2);  // no newer one
  hall.feed->forget(1);
  hall.take(3.0);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(hall.had(1) == 2);
  hall.feed->want_state(2);
  for (int i = 0; i < 400; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::lock_guard<std::mutex> lock(hall.mutex);
    if (hall.states[2] == 1) break;
  }
  const std::lock_guard<std::mutex> lock(hall.mutex);
  CHECK(hall.states[2] == 1);
  CHECK(hall.images[1][1] == hall.images[2][0]);  // encoded once
}

TEST_CASE("an image message says when it was taken and sent, and holds a JPEG") {
  imaging::Frame frame;
  frame.image = cv::Mat(48, 64, CV_8UC3, cv::Scalar(10, 20, 30));
  frame.stamp_s = 12.5;
  const std::string message = console::image_message(frame, 12.75);
  double taken_s = 0.0, sent_s = 0.0;
  std::memcpy(&taken_s, message.data(), 8);
  std::memcpy(&sent_s, message.data() + 8, 8);
  CHECK(taken_s == 12.5);
  CHECK(sent_s == 12.75);
  CHECK(message.substr(16, 3) == "\xff\xd8\xff");
}
