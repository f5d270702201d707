#include "lodestone/console/console.h"

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <future>
#include <mutex>
#include <set>
#include <utility>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/common/priority_mutex.h"
#include "lodestone/console/access.h"
#include "lodestone/console/drawn_path.h"
#include "lodestone/console/feed.h"
#include "lodestone/console/jobs.h"
#include "lodestone/console/live_view.h"
#include "lodestone/console/messages.h"
#include "lodestone/console/recording.h"
#include "lodestone/console/run_list.h"
#include "lodestone/console/seat.h"
#include "lodestone/console/served_files.h"
#include "lodestone/console/session_log.h"
#include "lodestone/console/web_server.h"
#include "lodestone/console/worker.h"
#include "lodestone/rig/rendered_camera.h"
#include "page_files.h"

namespace lodestone::console {
namespace {

using common::Json;
using geometry::Vector2;

constexpr std::size_t kMostSamples = 300;  // of a greeting

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);  // names of files are any bytes
}

}  // namespace

struct Console::State {
  explicit State(ConsoleParts given)
      : parts(std::move(given)),
        recordings(parts.folder + "/recordings"),
        view(parts.bench.config.rig, parts.bench.config.safety),
        token(is_loopback(parts.address) ? "" : draw_token()),
        files({{kRuns, parts.runs}, {kRecordings, recordings}}) {
    try {
      serve();  // first: where the port is taken, nothing has been written
      log = std::make_unique<SessionLog>(parts.folder);
      common::make_folders(recordings);
      begin();
      ready = true;
    } catch (...) {
      constructed.set_value();
      throw;
    }
    constructed.set_value();
  }

  void serve() {
    WebServerHandlers handlers;
    handlers.pages = [this](const RequestHead& head) { return page(head); };
    handlers.opened = [this](PageId page) { opened(page); };
    handlers.text = [this](PageId page, const std::string& text) { heard(page, text); };
    handlers.closed = [this](PageId page) { closed(page); };
    handlers.farewell = [](const std::string& why) { return text_of({{"kind", "bye"}, {"text", why}}); };
    WebServerConfig config;
    config.address = parts.address;
    config.port = parts.port;
    config.max_message_bytes = kMostMessageBytes;
    server = std::make_unique<WebServer>(config, Access(!token.empty(), token), std::move(handlers));
  }

  void begin() {
    parts.bench.tell = [this](const BenchEvent& event) { tell(event); };
    bench = std::make_unique<Bench>(parts.bench);
    jobs = std::make_unique<Jobs>(*bench, parts.jobs, parts.runs,
                                  [this](const std::string& text) { tell(BenchEvent::Level::kInfo, text); });
    Feed::Source source;
    source.image = [this] { return bench->image(); };
    source.now_s = [this] { return bench->state().now_s; };
    source.send_image = [this](PageId page, const auto& image) { send(page, image); };
    source.send_state = [this](PageId page) { send_state(page); };
    feed = std::make_unique<Feed>(std::move(source));
  }

  ~State() {
    {
      const std::lock_guard<common::PriorityMutex> lock(hearing);
      listens = false;
    }
    if (bench->state().mode == Mode::kRunning) bench->stop("the console ends");
    feed->end();  // which asks all that follows
    clerk.end();
    recording.reset();
    jobs.reset();
    bench->end();  // stops a run; what it tells is on record, and sent
    server.reset();
  }

  ConsoleParts parts;
  std::string recordings;
  LiveView view;
  std::string token;  // empty on the loopback
  std::unique_ptr<SessionLog> log;
  ServedFiles files;
  common::SteadyClock wall;
  common::PriorityMutex mutex;  // of what follows
  Seat seat;
  std::set<PageId> pages;
  std::optional<Goal> planned;
  std::unique_ptr<Recording> recording;
  std::atomic<bool> ready{false};
  common::PriorityMutex hearing;  // held while a page is heard
  bool listens = true;
  std::promise<void> constructed;
  std::shared_future<void> is_constructed{constructed.get_future()};
  std::unique_ptr<Bench> bench;
  std::unique_ptr<Jobs> jobs;
  std::unique_ptr<Feed> feed;
  std::unique_ptr<WebServer> server;
  Worker clerk;  // reads and writes files

  // ---- What pages are told ----

  void tell(const BenchEvent& event) {
    const Json json = log->add(event);
    if (ready) broadcast(json);
  }
  void tell(BenchEvent::Level level, const std::string& text) { tell({level, bench->state().now_s, text}); }

  /// What the thread of the heartbeats tells: it may not wait for the disk on which that is kept.
  void note(const std::string& text) {
    const auto told = [this, text] { tell(BenchEvent::Level::kInfo, text); };
    if (!clerk.ask(told)) told();
  }

  /// Nothing before the server is there.
  template <class Content>
  void send(PageId page, const Content& content) {
    if (ready) server->send(page, content);
  }

  void broadcast(const Json& json) {
    std::vector<PageId> all;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      all.assign(pages.begin(), pages.end());
    }
    const std::string text = text_of(json);
    for (const PageId page : all) send(page, text);
  }

  void answer(PageId page, const char* to, const std::string& why_not) {
    send(page, text_of({{"kind", "answer"}, {"to", to}, {"ok", why_not.empty()}, {"text", why_not}}));
  }
  Bench::Done answer_to(PageId page, const char* to) {
    return [this, page, to](const std::string& why_not) { answer(page, to, why_not); };
  }

  Json hello(PageId page) const {
    const experiments::DeploymentConfig& config = parts.bench.config;
    Json controllers = Json::array();
    for (const auto& source : parts.bench.sources) controllers.push_back(source.name);
    Json samples = Json::array();
    const std::vector<BenchSample> kept = bench->samples();
    const std::size_t step = kept.size() / kMostSamples + 1;  // this thread carries heartbeats
    for (std::size_t i = 0; i < kept.size(); i += step) samples.push_back(LiveView::json(kept[i]));
    const auto image = bench->image();
    return {
        {"kind", "hello"},
        {"you", page},
        {"version", common::build_and_host_facts()["lodestone"]},
        {"rig", {{"name", parts.rig_name}, {"kind", parts.rig_kind}}},
        {"image",
         {{"width_px", image ? image->image.cols : 1280}, {"height_px", image ? image->image.rows : 1024}}},
        {"controllers", controllers},
        {"shapes", {"centre", "square", "circle", "suture"}},
        {"jobs", jobs->verbs()},
        {"period_s", config.loop.period_s()},
        {"coils", coil_names()},
        {"max_current_A", config.rig.coils.max_current_A},
        {"dish_radius_mm", geometry::kMmPerM * config.rig.dish.radius_m},
        {"samples", samples},
        {"events", log->last()}};
  }

  std::vector<std::string> coil_names() const {
    const physics::CoilsDescription& coils = parts.bench.config.rig.coils;
    std::vector<std::string> names;
    for (std::size_t coil = 0; coil < coils.count(); ++coil) names.push_back(coils.name(coil));
    return names;
  }

  void send_state(PageId page) {
    Json json = view.json(bench->state());
    json["job"] = jobs->now();
    json["question"] = jobs->question();
    std::string seated;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      seated = settle();
      const auto number = [](const std::optional<PageId>& id) { return id ? Json(*id) : Json(); };
      json["you_operate"] = seat.operates(page);
      json["operator"] = number(seat.operating());
      json["asking"] = number(seat.asking());
      json["asking_left_s"] = seat.asking() ? Json(seat.answer_left_s(wall.now_s())) : Json();
      json["viewers"] = pages.size();
      json["recording"] = recording != nullptr;
    }
    send(page, text_of(json));
    if (!seated.empty()) note(seated);
  }

  /// Under the mutex: who asked for the seat and waited long enough has it. What there is to tell of it.
  std::string settle() {
    const std::optional<PageId> before = seat.operating();
    if (!seat.settle(wall.now_s())) return "";
    bench->handed_over(seat.operating().has_value());
    return seated_instead_of(before, "did not answer");
  }
  std::string seated_instead_of(const std::optional<PageId>& before, const char* why) const {
    const std::optional<PageId> now = seat.operating();
    const std::string reason = before ? fmt::format(": page {} {}", *before, why) : "";
    return now ? fmt::format("page {} operates{}", *now, reason) : "nobody operates" + reason;
  }

  // ---- What pages ask for ----

  Response page(const RequestHead& head) {
    if (auto file = files.find(head)) return *std::move(file);
    const std::string path = head.target.substr(0, head.target.find('?'));
    for (const PageFile& file : page_files())
      if (path == file.path || (path == "/" && std::string(file.path) == "/index.html")) {
        Response response;
        response.content_type = file.content_type;
        response.body = file.content;
        return response;
      }
    return told(404, "there is nothing here");
  }

  void opened(PageId page) {
    is_constructed.wait();  // a page may be quicker than our constructor
    const std::lock_guard<common::PriorityMutex> hear(hearing);
    if (!ready || !listens) return;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      pages.insert(page);
    }
    send(page, text_of(hello(page)));
  }

  void closed(PageId page) {
    const std::lock_guard<common::PriorityMutex> hear(hearing);
    if (!ready || !listens) return;
    feed->forget(page);
    std::string seated;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      pages.erase(page);
      const bool operated = seat.operates(page);
      seat.leave(page, wall.now_s());
      if (operated) {
        bench->handed_over(seat.operating().has_value());
        seated = seated_instead_of(page, "is gone");
      }
    }
    if (!seated.empty()) note(seated);
  }

  void heard(PageId page, const std::string& text) {
    const std::lock_guard<common::PriorityMutex> hear(hearing);
    if (!ready || !listens) return;
    std::optional<Message> message;
    try {
      message = parse_message(text);
    } catch (const common::DataError& error) {
      if (ready) server->close(page, text_of({{"kind", "bye"}, {"text", error.what()}}));
      return;
    }
    if (needs_the_seat(*message)) {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      if (!seat.operates(page)) {
        answer(page, name_of(*message), "another page operates: ask for it first");
        return;
      }
    }
    std::visit([this, page](const auto& said) { obey(page, said); }, *message);
  }

  void obey(PageId page, const WantsImage&) {
    bench->watched();
    feed->want_image(page);
  }
  void obey(PageId page, const WantsState&) {
    bench->watched();
    feed->want_state(page);
  }
  void obey(PageId page, const Beat& beat) {
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      seat.beat(page, wall.now_s());
      if (!seat.operates(page)) return;
    }
    bench->beat(beat.visible, beat.focused);
  }
  void obey(PageId page, const StopAsked& stop) {
    bench->stop(fmt::format("page {} said stop ({})", page, stop.by));
    jobs->end();
    answer(page, StopAsked::kWord, "");
  }
  void obey(PageId page, const Operate&) {
    bool granted = false;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      const bool before = seat.operates(page);
      granted = seat.ask(page, wall.now_s());
      if (granted && !before) bench->handed_over(true);
    }
    answer(page, Operate::kWord, granted ? "" : "the operator is asked");
    if (granted) note(fmt::format("page {} operates", page));
  }
  void obey(PageId page, const Yield&) {
    std::string seated;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      seat.yield(page, wall.now_s());
      bench->handed_over(seat.operating().has_value());
      seated = seated_instead_of(page, seat.operating() ? "handed over" : "got up");
    }
    note(seated);
  }
  void obey(PageId page, const Refuse&) {
    std::optional<PageId> asked;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      asked = seat.asking();
      seat.refuse(page);
    }
    if (asked) answer(*asked, Operate::kWord, "the operator keeps the seat");
  }
  void obey(PageId page, const Arm&) { bench->arm(answer_to(page, Arm::kWord)); }
  void obey(PageId page, const Disarm&) { bench->disarm(answer_to(page, Disarm::kWord)); }
  void obey(PageId page, const Rearm& rearm) {
    bench->rearm(rearm.reason, rearm.clears, answer_to(page, Rearm::kWord));
  }
  void obey(PageId page, const ChooseController& choice) {
    answer(page, ChooseController::kWord, bench->choose(choice.name));
  }
  void obey(PageId page, const Unattended& wish) {
    answer(page, Unattended::kWord, bench->set_unattended(wish.on));
  }

  void obey(PageId page, const Go& go) {
    const BenchState now = bench->state();
    if (!now.camera)
      return answer(page, Go::kWord, "the camera is not calibrated yet: nobody knows where that is");
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      planned.reset();  // it is no longer shown
    }
    const ImageMap map(*now.camera);
    Goal goal;
    goal.task = "point";
    goal.target_m = map.to_dish(go.to);
    if (go.towards && !parts.bench.config.rig.needle.is_sphere()) {
      const Vector2 along_m = map.to_dish(*go.towards) - goal.target_m;
      goal.heading_rad = std::atan2(along_m.y(), along_m.x());
    }
    begin(page, Go::kWord, goal);
  }

  void begin(PageId page, const char* word, const Goal& goal) {
    if (!goal.path)
      if (const std::string why_not = reachable().why_not(goal.target_m); !why_not.empty())
        return answer(page, word, why_not);
    answer(page, word, bench->drive(goal));
  }

  Reachable reachable() const {
    const experiments::DeploymentConfig& config = parts.bench.config;
    return {config.rig, config.safety.geofence * config.rig.dish.radius_m, parts.region,
            bench->state().keep_out};
  }

  void obey(PageId page, const DrawnStroke& stroke) {
    const BenchState now = bench->state();
    if (!now.camera)
      return answer(page, DrawnStroke::kWord, "the camera is not calibrated yet: nobody knows where that is");
    const ImageMap map(*now.camera);
    std::vector<Vector2> points_m;
    for (const ImagePlace& place : stroke.points) points_m.push_back(map.to_dish(place));
    plan(page, [&] { return path_goal(smoothed(points_m, stroke.closed), parts.bench.config); });
  }
  void obey(PageId page, const DrawnCsv& csv) {
    ask_clerk(page, DrawnCsv::kWord, [this, page, text = csv.text] {
      plan(page, [&] {
        const std::string file = parts.folder + "/drawn.csv";
        common::write_file_atomically(file, text);
        return path_goal(geometry::Path::from_csv(file), parts.bench.config);
      });
    });
  }
  void obey(PageId page, const DrawnShape& shape) {
    const experiments::DeploymentConfig& config = parts.bench.config;
    if (shape.name == "centre") {
      Goal goal;
      goal.task = "centre";
      return begin(page, DrawnShape::kWord, goal);
    }
    if (shape.name == "square")
      return plan(page,
                  [&] { return path_goal(geometry::Path::square(config.trials.square_side_m), config); });
    if (shape.name == "circle")
      return plan(page,
                  [&] { return path_goal(geometry::Path::circle(config.trials.circle_radius_m), config); });
    if (shape.name == "suture") return plan(page, [&] { return suture_goal(config); });
    answer(page, DrawnShape::kWord, "there is no such shape");
  }

  /// Checks the path of a goal and shows it as it would be followed.
  template <class Make>
  void plan(PageId page, const Make& make) {
    Json told = {
        {"kind", "plan"}, {"ok", false}, {"text", ""}, {"points", Json::array()}, {"bad", Json::array()}};
    std::optional<Goal> goal;
    try {
      goal = make();
    } catch (const common::Error& error) {
      told["text"] = error.what();
    }
    if (goal) {
      const geometry::Path& path = *goal->path;
      const PathObjection objection = object_to(path, reachable());
      const BenchState now = bench->state();
      told["ok"] = objection.why_not.empty();
      told["text"] = objection.why_not;
      told["length_mm"] = geometry::kMmPerM * path.length_m();
      const experiments::DeploymentConfig& config = parts.bench.config;
      told["seconds"] =
          path.length_m() / (goal->stitches.empty() ? config.reference.speed_m_s : config.suture.speed_m_s);
      if (now.camera) {
        const ImageMap map(*now.camera);
        told["points"] = map.json(path.points_m());
        told["bad"] = map.json(objection.bad_m);
      }
      if (!objection.why_not.empty()) goal.reset();
    }
    bench->show_plan(goal ? goal->path : std::nullopt);
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      planned = std::move(goal);
    }
    send(page, text_of(told));
  }

  void obey(PageId page, const Follow&) {
    std::optional<Goal> goal;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      goal = planned;
    }
    if (!goal) return answer(page, Follow::kWord, "draw a path first");
    begin(page, Follow::kWord, *goal);
  }
  void obey(PageId page, const Hand& hand) {
    if (const std::string why_not = bench->hold(hand.drive); !why_not.empty())
      answer(page, Hand::kWord, why_not);
  }
  void obey(PageId page, const EndRun&) { answer(page, EndRun::kWord, bench->end_run()); }
  void obey(PageId page, const PlaceNeedle&) { bench->place(answer_to(page, PlaceNeedle::kWord)); }

  void obey(PageId page, const Record& record) {
    ask_clerk(page, Record::kWord, [this, page, on = record.on] {
      std::string why_not;
      try {
        on ? begin_recording() : end_recording();
      } catch (const common::Error& error) {
        why_not = error.what();
      }
      answer(page, Record::kWord, why_not);
    });
  }
  /// What nobody thought of, on a disk, ends one wish and no console.
  void ask_clerk(PageId page, const char* word, std::function<void()> action) {
    const auto guarded = [this, page, word, action = std::move(action)] {
      try {
        action();
      } catch (const std::exception& error) {
        common::log_warning(std::string("console: ") + word + ": " + error.what());
        answer(page, word, error.what());
      }
    };
    if (!clerk.ask(guarded)) answer(page, word, "too much is asked for at once");
  }
  void begin_recording() {
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      if (recording) return;
    }
    auto made = start_recording();
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      recording = std::move(made);
    }
    tell(BenchEvent::Level::kInfo, "recording");
  }
  void end_recording() {
    std::unique_ptr<Recording> ended;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      ended = std::move(recording);
    }
    if (!ended) return;
    ended.reset();  // closes the film
    tell(BenchEvent::Level::kInfo, "the recording is kept");
  }
  std::unique_ptr<Recording> start_recording() {
    Recording::Source source;
    source.state = [this] { return bench->state(); };
    source.image = [this] { return bench->image(); };
    source.bench = rig::bench_of(parts.bench.config.rig);
    source.max_current_A = parts.bench.config.rig.coils.max_current_A;
    source.failed = [this](const std::string& why) {
      tell(BenchEvent::Level::kWarning, "the recording has ended: " + why);
      clerk.ask([this] { end_recording(); });
    };
    return std::make_unique<Recording>(recordings, new_recording_name(recordings), std::move(source));
  }

  void obey(PageId page, const ListRuns&) {
    ask_clerk(page, ListRuns::kWord, [this, page] { list_runs(page); });
  }
  void list_runs(PageId page) {
    try {
      send(page, text_of({{"kind", "runs"},
                          {"runs", run_list(parts.runs)},
                          {"recordings", recording_list(recordings)}}));
    } catch (const common::Error& error) {
      answer(page, ListRuns::kWord, error.what());
    }
  }
  void obey(PageId page, const Replay& replay) {
    ask_clerk(page, Replay::kWord, [this, page, name = replay.name] { send_recording(page, name); });
  }
  void send_recording(PageId page, const std::string& name) {
    try {
      const Json samples = read_recording(recordings, name);
      const bool film = std::filesystem::exists(recordings + "/" + name + ".mp4");
      send(page, text_of({{"kind", "replay"},
                          {"name", name},
                          {"video", film ? Json(kRecordings + name + ".mp4") : Json()},
                          {"samples", samples}}));
    } catch (const common::Error& error) {
      answer(page, Replay::kWord, error.what());
    }
  }
  void obey(PageId page, const StartJob& job) {
    answer(page, StartJob::kWord, job.verb ? jobs->start(*job.verb) : jobs->end());
  }
  void obey(PageId page, const Answer& given) { answer(page, Answer::kWord, jobs->answer(given.yes)); }
};

Console::Console(ConsoleParts parts) : state_(std::make_unique<State>(std::move(parts))) {}

Console::~Console() = default;

std::uint16_t Console::port() const { return state_->server->port(); }

BenchState Console::state() const { return state_->bench->state(); }

std::string Console::url() const {
  const std::string& token = state_->token;
  const std::string& address = state_->parts.address;
  std::string name = address.find(':') == std::string::npos ? address : "[" + address + "]";
  if (address == "0.0.0.0" || address == "::") {  // all of this machine's addresses
    std::array<char, 256> host{};
    if (gethostname(host.data(), host.size() - 1) == 0) name = host.data();
  }
  return fmt::format("http://{}:{}/{}", name, state_->server->port(), token.empty() ? "" : "?token=" + token);
}

}  // namespace lodestone::console
