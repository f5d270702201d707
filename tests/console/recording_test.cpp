#include "lodestone/console/recording.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;
using console::Recording;

namespace {

console::BenchState state_at(double time_s, std::int64_t samples) {
  console::BenchState state;
  state.now_s = time_s;
  console::BenchSample sample;
  sample.time_s = time_s;
  sample.pose = geometry::Pose2{0.001, -0.002, 0.5};
  if (samples > 1) sample.target_m = geometry::Vector2(0.004, -0.002);
  sample.current_A = {1.5, 0.0, 0.0, 0.0};
  state.sample = sample;
  state.samples = samples;
  return state;
}

void wait_until(const std::function<bool()>& there) {
  for (int i = 0; i < 500 && !there(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  REQUIRE(there());
}

}  // namespace

TEST_CASE("a recording holds each sample once, as soon as it was there, and a film") {
  const tests::TemporaryFolder folder;
  std::mutex mutex;
  console::BenchState now = state_at(100.0, 1);
  const auto frame = std::make_shared<imaging::Frame>();
  frame->image = cv::Mat(480, 640, CV_8UC3, cv::Scalar(80, 120, 160));
  Recording::Source source;
  source.state = [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return now;
  };
  source.image = [&] { return frame; };
  source.failed = [](const std::string& why) { FAIL(why); };
  const auto rows = [&] {
    const std::string text = common::read_file(folder / "a-1.csv");
    return std::count(text.begin(), text.end(), '\n') - 1;
  };
  {
    const Recording recording(folder.path(), "a-1", source);
    wait_until([&] { return rows() == 1; });
    {
      const std::lock_guard<std::mutex> lock(mutex);
      now = state_at(100.3, 2);
    }
    wait_until([&] { return rows() == 2; });
  }
  const auto found = console::recordings_in(folder.path());
  REQUIRE(found.size() == 1);
  CHECK(found[0].name == "a-1");
  CHECK(found[0].seconds == Approx(0.3));
  const common::Json samples = console::read_recording(folder.path(), "a-1");
  REQUIRE(samples.size() == 2);
  CHECK(samples[0]["x_mm"] == 1.0);
  CHECK(samples[0]["target_mm"].is_null());
  CHECK(samples[1]["target_mm"][0] == 4.0);
  CHECK(samples[1]["current_A"][0] == 1.5);
  CHECK(std::filesystem::exists(folder / "a-1.mp4") != std::filesystem::exists(folder / "a-1.avi"));
  for (const char* name : {"../a-1", "", "a/1", "b"})
    CHECK_THROWS_AS(console::read_recording(folder.path(), name), common::Error);
}

TEST_CASE("the recording of a sphere says nothing of a heading") {
  const tests::TemporaryFolder folder;
  Recording::Source source;
  source.state = [] { return state_at(100.0, 1); };
  source.image = [] { return std::shared_ptr<const imaging::Frame>(); };
  source.bench.sphere = true;
  source.failed = [](const std::string& why) { FAIL(why); };
  {
    const Recording recording(folder.path(), "round", source);
    wait_until([&] {
      const std::string text = common::read_file(folder / "round.csv");
      return std::count(text.begin(), text.end(), '\n') == 2;
    });
  }
  const common::Json samples = console::read_recording(folder.path(), "round");
  REQUIRE(samples.size() == 1);
  CHECK(samples[0]["x_mm"] == 1.0);
  CHECK(samples[0]["heading_deg"].is_null());
}

TEST_CASE("a recording of a day is replayed in so many samples, and none is written over another") {
  const tests::TemporaryFolder folder;
  const std::string name = console::new_recording_name(folder.path());
  const std::string header =
      "time_s,x_mm,y_mm,heading_deg,target_x_mm,target_y_mm,error_mm,current_px_A,current_mx_A,"
      "current_py_A,current_my_A,pose_age_ms,jitter_ms\n";
  std::string rows = header;
  for (int i = 0; i < 12000; ++i) rows += std::to_string(i) + ",1,2,3,,,,0,0,0,0,,\n";
  common::write_file_atomically(folder / (name + ".csv"), rows);
  const common::Json samples = console::read_recording(folder.path(), name);
  CHECK(samples.size() == 4000);
  CHECK(samples[0]["time_s"] == 0.0);
  CHECK(samples.back()["time_s"] == 11997.0);
  std::filesystem::create_symlink("round.csv", folder / "round.csv");
  REQUIRE(console::recordings_in(folder.path()).size() == 1);
  std::set<std::string> names = {name};
  for (int i = 0; i < 5; ++i) {  // most of them in one second
    const std::string next = console::new_recording_name(folder.path());
    CHECK(names.insert(next).second);
    common::write_file_atomically(folder / (next + ".csv"), header);
  }
}
