#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>

#include "common_options.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/imaging/calibration.h"
#include "lodestone/imaging/calibration_board.h"
#include "lodestone/imaging/calibration_overlay.h"
#include "lodestone/imaging/frame_guard.h"
#include "lodestone/imaging/image_file.h"
#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/imaging/video_writer.h"
#include "lodestone/rig/camera_source.h"
#include "lodestone/rig/rendered_camera.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/runs/run_folder.h"
#include "lodestone/segmentation/needle_pose.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct CalibrateConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  std::int64_t images = 4;
  rig::RigConfig rig;
  imaging::BoardConfig board;
  imaging::CalibrationConfig fit;
  imaging::SceneConfig scene;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of rendered benches", {0, 9e15});
    v.field("threads", threads, "", "threads of --trials; 0 means one per processor", {0, 1024});
    v.field("images", images, "", "images to average; the camera must stand still", {1, 1000});
    v.group("rig", rig, "the rig, with its camera");
    v.retired("camera", "rig.camera");
    v.group("board", board, "the printed board");
    v.group("fit", fit, "how the camera is fitted");
    v.group("scene", scene, "lens, and the ranges of rendered benches");
  }
};

struct CalibrateOptions : CommonOptions {
  bool rendered = false;
  std::int64_t trials = 0;
  std::string check;
  std::string print_board;
  std::string film;
  std::int64_t places = 200;
  std::vector<std::string> board_files;
};

constexpr double kGetImage_s = 5.0;

std::vector<cv::Mat> grab(const CalibrateConfig& config) {
  if (config.rig.camera.source.empty() && config.rig.camera.kind != rig::CameraKind::kGenicam)
    throw common::ConfigError(
        "calibrate: which camera? --camera PATH (image, folder or video), --set rig.camera.kind=uvc with "
        "--camera 0, "
        "--set rig.camera.kind=genicam, or --rendered to try it without one");
  const std::unique_ptr<rig::Camera> camera = rig::open_camera(config.rig.camera);
  std::vector<cv::Mat> images;
  for (std::int64_t i = 0; i < config.images; ++i) {
    // A folder may hold fewer.
    try {
      images.push_back(camera->grab(kGetImage_s).image);
    } catch (const common::HardwareError&) {
      if (images.empty()) throw;
      break;
    }
  }
  return images;
}

cv::Mat render(const imaging::SceneRenderer& renderer) {
  common::RandomStream random(renderer.scene().seed, "image for calibration");
  return renderer.render({}, random).image;
}

/// A film of a needle that lies elsewhere in every image.
void write_film(const imaging::SceneRenderer& renderer, const std::string& file, std::int64_t places) {
  const imaging::Scene& scene = renderer.scene();
  constexpr double kFrameRate_hz = 10.0;
  const std::string folder = std::filesystem::path(file).parent_path().string();
  if (!folder.empty()) common::make_folders(folder);
  imaging::VideoWriter film(
      file, {static_cast<int>(scene.camera.width_px), static_cast<int>(scene.camera.height_px)},
      kFrameRate_hz);
  common::RandomStream random(scene.seed, "film of a needle");
  for (std::int64_t i = 0; i < places; ++i)
    film.write(renderer.render({{segmentation::draw_needle_pose(scene.bench, random)}}, random).image);
  film.finish();
  common::log_info("wrote " + film.file() + ": a needle in " + std::to_string(places) + " places");
}

double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Calibrates many rendered benches, whose cameras are known, and prints the errors as JSON.
void run_trials(const CalibrateConfig& config, std::int64_t trials) {
  struct Trial {
    bool failed = false;
    imaging::FloorError error;
    double ms = 0.0;
  };
  std::vector<Trial> results(static_cast<std::size_t>(trials));
  common::ThreadPool pool(static_cast<std::size_t>(config.threads));
  pool.for_each(results.size(), [&](std::size_t index) {
    const imaging::SceneRenderer renderer(imaging::draw_scene(
        config.scene,
        common::derive_seed(static_cast<std::uint64_t>(config.seed), "calibration trial", index)));
    const cv::Mat image = render(renderer);
    const double start_ms = thread_ms();
    try {
      const imaging::Calibration found =
          imaging::calibrate_from_dish({image}, config.scene.bench, config.scene.lens, config.fit);
      results[index].error = imaging::floor_error(found.camera, renderer.scene().camera, config.scene.bench);
    } catch (const common::DataError&) {
      results[index].failed = true;
    }
    results[index].ms = thread_ms() - start_ms;
  });
  std::vector<double> rms_mm, max_mm, ms;
  for (const Trial& trial : results) {
    ms.push_back(trial.ms);
    if (trial.failed) continue;
    rms_mm.push_back(1e3 * trial.error.rms_m);
    max_mm.push_back(1e3 * trial.error.max_m);
  }
  const auto spread = [](std::vector<double> values) -> common::Json {
    if (values.empty()) return nullptr;
    std::sort(values.begin(), values.end());
    const auto at = [&](double fraction) {
      return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
    };
    return {{"median", at(0.5)}, {"p95", at(0.95)}, {"max", at(1.0)}};
  };
  common::Json json;
  json["rms_mm"] = spread(rms_mm);
  json["worst_point_mm"] = spread(max_mm);
  json["ms"] = spread(ms);
  json["failures"] = trials - static_cast<std::int64_t>(rms_mm.size());
  json["n"] = trials;
  std::printf("%s\n", json.dump(2).c_str());
}

/// 0 when the camera stands where it stood, 1 when it moved.
void check_moved(const CalibrateConfig& config, const cv::Mat& image, const std::string& file) {
  const imaging::Calibration calibration = imaging::read_calibration(file);
  const double moved_m = imaging::camera_moved_m(image, calibration, config.scene.bench, config.fit);
  std::printf("the image has moved by %.3f mm since %s was made\n", 1e3 * moved_m, file.c_str());
  if (moved_m > config.fit.moved_bound_m)
    throw common::HardwareError("the camera has moved: " + std::to_string(1e3 * moved_m) + " mm, bound is " +
                                std::to_string(1e3 * config.fit.moved_bound_m) + " mm; calibrate again");
}

/// A picture of the board, and what to call it.
struct BoardView {
  std::string name;
  cv::Mat image;
};

/// An image; or of a video the views of the board that differ.
void add_views(const std::string& file, const imaging::BoardConfig& board,
               std::vector<BoardView>& views_of_all) {
  constexpr std::size_t kMost = 40;
  if (imaging::is_image_file(file)) {
    views_of_all.push_back({file, imaging::read_image(file)});
    return;
  }
  rig::CameraSourceConfig source;
  source.source = file;
  const std::unique_ptr<rig::Camera> video = rig::open_camera(source);
  std::vector<imaging::BoardCorners> views;
  std::int64_t frames = 0;
  try {
    for (; views.size() < kMost; ++frames) {
      const cv::Mat image = video->grab(kGetImage_s).image;
      const imaging::BoardCorners corners = imaging::detect_board(image, board);
      if (!imaging::is_another_view(corners, views, image.cols)) continue;
      views.push_back(corners);
      views_of_all.push_back({fmt::format("{}, image {}", file, frames + 1), image});
    }
  } catch (const common::HardwareError&) {
    // it has ended
  }
  common::log_info(file + ": " + std::to_string(views.size()) + " views of the board that differ, in " +
                   std::to_string(frames) + " images");
}

/// A print of another size changes nothing here, but is told of where it can be seen.
void tell_of_small_prints(const std::vector<BoardView>& views, const CalibrateConfig& config,
                          const imaging::CameraModel& camera) {
  constexpr double kAsStated = 0.985;
  for (const BoardView& view : views) {
    const auto size = imaging::size_on_floor(imaging::detect_board(view.image, config.board), camera,
                                             config.scene.bench.dish_radius_m);
    if (!size || *size > kAsStated) continue;
    common::log_warning(fmt::format(
        "{}: the board lies flat in the dish, where its squares are {:.2f} mm, {:.1f} % of "
        "board.square_m = {}: it is printed smaller (measure a square, and set board.square_m), "
        "or the camera stood nearer when it saw the dish. Neither changes this calibration, whose "
        "scale is the dish's",
        view.name, 1e3 * *size * config.board.square_m, 100.0 * *size, config.board.square_m));
    return;
  }
}

imaging::DishFit fit(const CalibrateConfig& config, const CalibrateOptions& options,
                     const std::vector<cv::Mat>& images) {
  imaging::CameraModel start = imaging::nominal_camera(config.scene.lens);
  if (options.board_files.empty()) return imaging::fit_dish(images, config.scene.bench, start, config.fit);
  std::vector<BoardView> views;
  for (const std::string& file : options.board_files) add_views(file, config.board, views);
  std::vector<cv::Mat> boards;
  for (const BoardView& view : views) boards.push_back(view.image);
  const imaging::BoardFit lens = imaging::fit_board(boards, config.board);
  common::log_info("board: " + std::to_string(lens.used.size()) + " images, residual " +
                   std::to_string(lens.rms_px) + " px, focal length " + std::to_string(lens.camera.focal_px) +
                   " px");
  // The height that the nominal lens and distance stand for, with the focal length measured.
  const Eigen::Vector3d place = start.translation_m * (lens.camera.focal_px / start.focal_px);
  start = lens.camera;
  start.rotation = imaging::nominal_camera(config.scene.lens).rotation;
  start.translation_m = place;
  imaging::DishFit found = imaging::fit_dish(images, config.scene.bench, start, config.fit, true);
  found.calibration.method = common::name_of(config.board.kind);
  tell_of_small_prints(views, config, found.calibration.camera);
  return found;
}

void calibrate(const CalibrateOptions& options) {
  auto config = resolve_config<CalibrateConfig>(options);
  config.scene.bench = rig::bench_of(config.rig);
  if (!options.print_board.empty()) {
    imaging::write_board(options.print_board, config.board);
    common::log_info("wrote " + options.print_board +
                     ": print it in true size, measure a square, and set board.square_m");
    return;
  }
  if (options.trials > 0) return run_trials(config, options.trials);
  if (!options.film.empty() && !options.rendered)
    throw common::ConfigError("--film shows a rendered bench: give --rendered, too");
  std::unique_ptr<imaging::SceneRenderer> renderer;
  std::vector<cv::Mat> images;
  if (options.rendered) {
    renderer = std::make_unique<imaging::SceneRenderer>(
        imaging::draw_scene(config.scene, static_cast<std::uint64_t>(config.seed)));
    images.push_back(render(*renderer));
  } else {
    images = grab(config);
  }
  if (!options.check.empty()) return check_moved(config, images.front(), options.check);
  if (options.out.empty())
    throw common::ConfigError("calibrate: --out DIR is missing; name the folder to write into");
  const imaging::DishFit found = fit(config, options, images);
  runs::RunFolder run({options.out, "calibrate", common::config_to_json(config), config.seed});
  run.begin();
  const imaging::Calibration& calibration = found.calibration;
  imaging::write_calibration(options.out + "/calibration.json", calibration);
  imaging::write_image(options.out + "/overlay.png",
                       imaging::calibration_overlay(images.front(), calibration.camera, config.scene.bench));
  if (!options.film.empty()) write_film(*renderer, options.film, options.places);
  run.finish();
  for (const imaging::EdgeUse& edge : found.edges)
    if (edge.expected > 0)
      std::printf("%-12s %4lld of %4lld points, %.3f px RMS\n", edge.name.c_str(),
                  static_cast<long long>(edge.used), static_cast<long long>(edge.expected), edge.rms_px);
  std::printf("reprojection error %.3f mm (%.3f px) RMS\n", 1e3 * calibration.reprojection_rms_m,
              calibration.reprojection_rms_px);
  if (renderer) {
    const imaging::FloorError error =
        imaging::floor_error(calibration.camera, renderer->scene().camera, config.scene.bench);
    std::printf("true error over the dish %.3f mm RMS, %.3f mm at worst\n", 1e3 * error.rms_m,
                1e3 * error.max_m);
  }
  std::printf("look at %s/overlay.png: the lines must lie on the edges\n", options.out.c_str());
}

}  // namespace

void add_calibrate(Verb& program) {
  Verb& verb = program.add_verb(
      "calibrate", "find where the camera stands over the dish, from its image; or measure the coils");
  auto& options = configure<CalibrateConfig>(verb, calibrate);
  add_common_options(verb, options);
  add_shorthand(
      verb, options, "--camera", "rig.camera.source", Shorthand::kText,
      "image, folder, video; number of a USB camera; name of a GenICam camera (see rig.camera.kind)");
  verb.add_option("--rendered", &options.rendered, "try it on a rendered bench, where the truth is known");
  verb.add_option("--film", &options.film,
                  "film a needle on the rendered bench, to try train-segmenter --frames on (.avi, .mp4)")
      .named("FILE");
  verb.add_option("--places", &options.places, "images of that film, each with the needle elsewhere")
      .within(1, 100000)
      .with_default();
  verb.add_option("--trials", &options.trials,
                  "calibrate so many rendered benches and print the errors as JSON")
      .within(0, 1000000);
  verb.add_option("--check", &options.check, "calibration.json: has the camera moved since? (exit code 1)")
      .named("FILE");
  verb.add_option(
          "--board", &options.board_files,
          "images of the printed board (board.kind), or a video of it, tilted this way and that: they give "
          "the lens, the dish gives the place")
      .named("FILE...");
  verb.add_option("--print-board", &options.print_board, "write the board to print").named("PNG");
  add_calibrate_coils(verb);
  add_calibrate_field(verb);
}

}  // namespace lodestone::apps
