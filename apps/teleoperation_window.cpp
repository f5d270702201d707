#include "teleoperation_window.h"

#include <SDL.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

#include "lodestone/common/error.h"

namespace lodestone::apps {

namespace {

constexpr int kWidth = 960;
constexpr int kHeight = 540;
constexpr int kImageWidth = 640;
constexpr int kImageHeight = 512;
constexpr int kMapSide = 280;
constexpr double kDeadZone = 0.12;  // of a stick that nobody touches
constexpr std::array<SDL_Keycode, 4> kArrows = {SDLK_LEFT, SDLK_RIGHT, SDLK_DOWN, SDLK_UP};

const cv::Scalar kBack(40, 36, 32);
const cv::Scalar kText(235, 235, 235);
const cv::Scalar kDim(120, 116, 110);
const cv::Scalar kWarm(80, 160, 250);

void write(cv::Mat& canvas, const std::string& text, int x, int y, const cv::Scalar& colour = kText) {
  cv::putText(canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.5, colour, 1, cv::LINE_AA);
}

void paint_map(cv::Mat& canvas, const PilotView& view, int left, int top) {
  const std::int64_t most =
      view.visits.empty() ? 0 : *std::max_element(view.visits.begin(), view.visits.end());
  const double cell = static_cast<double>(kMapSide) / kPilotGrid;
  const auto place = [&](const geometry::Vector2& point_m) {
    return cv::Point(left + static_cast<int>((point_m.x() / view.dish_radius_m + 1.0) * 0.5 * kMapSide),
                     top + static_cast<int>((1.0 - point_m.y() / view.dish_radius_m) * 0.5 * kMapSide));
  };
  for (int row = 0; row < kPilotGrid; ++row) {
    for (int column = 0; column < kPilotGrid; ++column) {
      const auto at = static_cast<std::size_t>(row * kPilotGrid + column);
      const double fraction =
          most > 0 ? std::sqrt(static_cast<double>(view.visits[at]) / static_cast<double>(most)) : 0.0;
      const cv::Point corner(left + static_cast<int>(column * cell),
                             top + static_cast<int>((kPilotGrid - 1 - row) * cell));
      cv::rectangle(canvas, corner,
                    corner + cv::Point(static_cast<int>(cell) - 1, static_cast<int>(cell) - 1),
                    kBack + fraction * (kWarm - kBack), cv::FILLED);
    }
  }
  cv::circle(canvas, {left + kMapSide / 2, top + kMapSide / 2}, kMapSide / 2, kDim, 1, cv::LINE_AA);
  if (view.step.estimate.valid) {
    const geometry::Pose2& pose = view.step.estimate.pose;
    if (view.sphere) {
      cv::circle(canvas, place(pose.position_m()), 6, kText, cv::FILLED, cv::LINE_AA);
      return;
    }
    const geometry::Vector2 half(0.008 * std::cos(pose.heading_rad), 0.008 * std::sin(pose.heading_rad));
    cv::arrowedLine(canvas, place(pose.position_m() - half), place(pose.position_m() + half), kText, 2,
                    cv::LINE_AA, 0, 0.35);
  }
}

void paint_current(cv::Mat& canvas, const char* name, double current_A, double max_A, int left, int top) {
  const int middle = left + kMapSide / 2;
  const int length = static_cast<int>(current_A / max_A * kMapSide / 2);
  cv::rectangle(canvas, {left, top}, {left + kMapSide, top + 14}, kDim, 1);
  cv::rectangle(canvas, {middle, top + 1}, {middle + length, top + 13}, kWarm, cv::FILLED);
  char text[64];
  std::snprintf(text, sizeof text, "%s axis %+.1f A", name, current_A);
  write(canvas, text, left, top - 5);
}

}  // namespace

cv::Mat paint_pilot_view(const PilotView& view) {
  cv::Mat canvas(kHeight, kWidth, CV_8UC3, kBack);
  cv::Mat image = canvas(cv::Rect(8, 8, kImageWidth, kImageHeight));
  if (view.image.empty())
    write(image, "no camera", kImageWidth / 2 - 40, kImageHeight / 2, kDim);
  else
    cv::resize(view.image, image, image.size(), 0, 0, cv::INTER_AREA);
  const int left = kImageWidth + 24;
  write(canvas, "where the needle has been", left, 22);
  paint_map(canvas, view, left, 30);
  paint_current(canvas, "x", view.drive.x() * view.max_current_A, view.max_current_A, left, 350);
  paint_current(canvas, "y", view.drive.y() * view.max_current_A, view.max_current_A, left, 394);
  write(canvas, std::to_string(view.steps) + " steps, " + std::to_string(view.episodes) + " episodes saved",
        left, 438);
  write(canvas, view.step.estimate.valid ? "needle seen" : "needle not seen: " + view.step.estimate.reason,
        left, 462, view.step.estimate.valid ? kText : kWarm);
  write(canvas, "arrows, stick: drive  + -: more, less", left, 494, kDim);
  write(canvas, "N: next episode   Esc: finish", left, 516, kDim);
  return canvas;
}

struct TeleoperationWindow::State final : public control::Controller {
  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  SDL_Texture* texture = nullptr;
  SDL_GameController* gamepad = nullptr;
  bool by_gamepad = false;
  double strength = 0.5;
  bool next_episode = false;
  bool quit = false;
  PilotView view;
  physics::CoilDrive drive;
  session::RigSession* bench = nullptr;

  ~State() override {
    if (gamepad != nullptr) SDL_GameControllerClose(gamepad);
    if (texture != nullptr) SDL_DestroyTexture(texture);
    if (renderer != nullptr) SDL_DestroyRenderer(renderer);
    if (window != nullptr) SDL_DestroyWindow(window);
    SDL_Quit();
  }

  [[noreturn]] static void fail(const std::string& what) {
    throw common::HardwareError("collect --by: " + what + ": " + SDL_GetError());
  }

  void reset() override {
    next_episode = false;
    if (view.steps > 0) ++view.episodes;
    if (quit) std::raise(SIGINT);  // ends as Ctrl-C does
  }
  geometry::Drive act(const task::Observation& observation) override {
    listen();
    return drive.along(view.drive, observation.pose.position_m());
  }

  /// Whatever has happened at keyboard, gamepad and window since the last look.
  void listen() {
    SDL_Event event;
    while (SDL_PollEvent(&event) != 0) {
      if (event.type == SDL_QUIT) quit = true;
      if (event.type == SDL_CONTROLLERDEVICEREMOVED && by_gamepad)
        quit = true;  // nobody holds the drive any more
      if (event.type == SDL_CONTROLLERBUTTONDOWN && event.cbutton.button == SDL_CONTROLLER_BUTTON_A)
        next_episode = true;
      if (event.type != SDL_KEYDOWN && event.type != SDL_KEYUP) continue;
      const SDL_Keycode key = event.key.keysym.sym;
      const bool down = event.type == SDL_KEYDOWN;
      for (std::size_t i = 0; i < kArrows.size(); ++i)
        if (key == kArrows[i]) held[i] = down;
      if (!down) continue;
      if (key == SDLK_PLUS || key == SDLK_KP_PLUS || key == SDLK_EQUALS)
        strength = std::min(1.0, strength + 0.1);
      if (key == SDLK_MINUS || key == SDLK_KP_MINUS) strength = std::max(0.1, strength - 0.1);
      next_episode = next_episode || key == SDLK_n;
      quit = quit || key == SDLK_ESCAPE;
    }
    view.drive = geometry::Vector2(strength * (held[1] - held[0]), strength * (held[3] - held[2]));
    if (gamepad != nullptr) {
      const auto axis = [this](SDL_GameControllerAxis which) {
        const double value = SDL_GameControllerGetAxis(gamepad, which) / 32767.0;
        return std::abs(value) < kDeadZone ? 0.0 : std::clamp(value, -1.0, 1.0);
      };
      view.drive = geometry::Vector2(axis(SDL_CONTROLLER_AXIS_LEFTX), -axis(SDL_CONTROLLER_AXIS_LEFTY));
    }
    next_episode = next_episode || quit;  // what was driven so far is saved first
  }

  void show(const control::StepRecord& step) {
    view.step = step;
    ++view.steps;
    if (step.estimate.valid) {
      const auto cell = [&](double at_m) {
        return std::clamp(static_cast<int>((at_m / view.dish_radius_m + 1.0) * 0.5 * kPilotGrid), 0,
                          kPilotGrid - 1);
      };
      ++view.visits[static_cast<std::size_t>(cell(step.estimate.pose.y_m) * kPilotGrid +
                                             cell(step.estimate.pose.x_m))];
    }
    view.image = bench != nullptr && bench->camera() != nullptr ? bench->camera()->frame().image : cv::Mat();
    const cv::Mat canvas = paint_pilot_view(view);
    SDL_UpdateTexture(texture, nullptr, canvas.data, static_cast<int>(canvas.step));
    SDL_RenderCopy(renderer, texture, nullptr, nullptr);
    SDL_RenderPresent(renderer);
  }

  std::array<bool, 4> held{};
};

TeleoperationWindow::TeleoperationWindow(const std::string& by, const physics::RigDescription& rig)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.by_gamepad = by == "gamepad";
  state.view.max_current_A = rig.coils.max_current_A;
  state.view.dish_radius_m = rig.dish.radius_m;
  state.drive = physics::CoilDrive(rig);
  state.view.sphere = rig.needle.is_sphere();
  state.view.visits.assign(static_cast<std::size_t>(kPilotGrid) * kPilotGrid, 0);
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // Ctrl-C is the program's
  if (SDL_Init(SDL_INIT_VIDEO | SDL_INIT_GAMECONTROLLER) != 0) State::fail("no display");
  // Without a display SDL paints into memory, where nobody sees the needle or presses a key.
  const std::string driver = SDL_GetCurrentVideoDriver();
  if (std::getenv("SDL_VIDEODRIVER") == nullptr && (driver == "offscreen" || driver == "dummy"))
    throw common::HardwareError("collect --by " + by +
                                ": no display; run it on the bench's own screen or through ssh -X, or use "
                                "--by explorer, which needs none");
  if (state.by_gamepad) {
    for (int i = 0; i < SDL_NumJoysticks() && state.gamepad == nullptr; ++i)
      if (SDL_IsGameController(i) == SDL_TRUE) state.gamepad = SDL_GameControllerOpen(i);
    if (state.gamepad == nullptr)
      throw common::HardwareError(
          "collect --by gamepad: no gamepad was found; connect one, or use --by keyboard");
  }
  state.window = SDL_CreateWindow("lodestone collect", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, kWidth,
                                  kHeight, SDL_WINDOW_SHOWN);
  if (state.window == nullptr) State::fail("no window");
  state.renderer = SDL_CreateRenderer(state.window, -1, 0);
  if (state.renderer == nullptr) state.renderer = SDL_CreateRenderer(state.window, -1, SDL_RENDERER_SOFTWARE);
  if (state.renderer == nullptr) State::fail("nothing draws into the window");
  state.texture =
      SDL_CreateTexture(state.renderer, SDL_PIXELFORMAT_BGR24, SDL_TEXTUREACCESS_STREAMING, kWidth, kHeight);
  if (state.texture == nullptr) State::fail("no texture");
}

TeleoperationWindow::~TeleoperationWindow() = default;

experiments::Teleoperator TeleoperationWindow::teleoperator(session::RigSession& bench) {
  state_->bench = &bench;
  experiments::Teleoperator teleoperator;
  teleoperator.controller = state_.get();
  teleoperator.episode_over = [this] {
    state_->listen();
    return state_->next_episode;
  };
  teleoperator.watch = [this](const control::StepRecord& step) { state_->show(step); };
  return teleoperator;
}

}  // namespace lodestone::apps
