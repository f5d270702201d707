#include "lodestone/console/jobs.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <fstream>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/child_process.h"
#include "lodestone/common/error.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::console {
namespace {

using common::Json;

constexpr double kListen_s = 0.2;
constexpr std::size_t kMostText = 4000;  // of what a job says, the last

/// The last of what was written: whole lines, and of one that was painted over only what it became.
std::string tail(const std::string& text) {
  std::string shown;
  for (const char letter : text) {
    if (letter == '\r')
      shown.erase(shown.rfind('\n') == std::string::npos ? 0 : shown.rfind('\n') + 1);
    else
      shown += letter;
  }
  return shown.size() > kMostText ? shown.substr(shown.size() - kMostText) : shown;
}

}  // namespace

struct Jobs::State final : session::Dialogue {
  State(Bench& of, std::vector<JobKind> of_kinds, std::string folder,
        std::function<void(const std::string&)> teller)
      : bench(of), kinds(std::move(of_kinds)), runs(std::move(folder)), tell(std::move(teller)) {}

  Bench& bench;
  std::vector<JobKind> kinds;
  std::string runs;
  std::function<void(const std::string&)> tell;
  mutable std::mutex mutex;  // of what follows
  std::condition_variable changed;
  bool busy = false, ending = false;
  std::atomic<bool> somebody_is_there{true};
  std::string verb, text, out;
  std::optional<runs::RunState> progress;
  std::optional<std::string> asked;
  std::optional<bool> answered;
  common::ChildProcess* child = nullptr;
  std::string stop_file;
  std::thread thread;

  void say(const std::string& line) override {
    const std::lock_guard<std::mutex> lock(mutex);
    text = tail(text + line);
  }
  bool confirm(const std::string& question) override {
    std::unique_lock<std::mutex> lock(mutex);
    asked = question;
    answered.reset();
    changed.wait(lock, [this] { return ending || answered; });
    asked.reset();
    const bool yes = !ending && answered.value_or(false);
    text = tail(text + question + (yes ? " yes\n" : " no\n"));
    return yes;
  }
  bool attended() const override { return somebody_is_there; }

  bool to_end() const {
    const std::lock_guard<std::mutex> lock(mutex);
    return ending;
  }

  void run(const JobKind& kind) {
    somebody_is_there = kind.attended;
    tell(kind.verb + " begins");
    std::string outcome = "done";
    try {
      if (kind.needs_the_rig) release(kind.verb);
      if (to_end()) throw common::Error("ended by the operator");
      if (kind.walk)
        kind.walk(*this);
      else
        run_program(kind);
    } catch (const std::exception& error) {  // one job ends no console
      outcome = error.what();
    }
    if (kind.needs_the_rig) bench.take_up();
    say(outcome + "\n");
    tell(kind.verb + ": " + outcome);
    const std::lock_guard<std::mutex> lock(mutex);
    busy = false;
  }

  void release(const std::string& reason) {
    const auto released = std::make_shared<std::promise<std::string>>();
    std::future<std::string> why_not = released->get_future();
    bench.let_go("the rig is in use: " + reason,
                 [released](const std::string& said) { released->set_value(said); });
    if (const std::string said = why_not.get(); !said.empty()) throw common::Error(said);
  }

  /// Here, and not where pages ask: that is for each of them, and often.
  void note_progress() {
    std::optional<runs::RunState> found;
    try {
      found = runs::find_run(out);
    } catch (const common::Error&) {
      return;  // just being written
    }
    const std::lock_guard<std::mutex> lock(mutex);
    progress = std::move(found);
  }

  void run_program(const JobKind& kind) {
    std::vector<std::string> words = kind.command;
    for (std::string& word : words)
      if (const std::size_t at = word.find("{out}"); at != std::string::npos) word.replace(at, 5, out);
    common::ChildProcess running(words);
    {
      const std::lock_guard<std::mutex> lock(mutex);
      child = &running;
      if (ending) running.interrupt();
    }
    while (const auto part = running.read(kListen_s)) {
      if (!part->empty()) say(*part);
      note_progress();
    }
    {
      const std::lock_guard<std::mutex> lock(mutex);
      child = nullptr;
    }
    const int code = running.finish();
    note_progress();
    if (code != 0)
      throw common::Error(to_end() ? "ended by the operator"
                                   : "ended with exit code " + std::to_string(code));
  }
};

Jobs::Jobs(Bench& bench, std::vector<JobKind> kinds, std::string runs,
           std::function<void(const std::string&)> tell)
    : state_(std::make_unique<State>(bench, std::move(kinds), std::move(runs), std::move(tell))) {}

Jobs::~Jobs() {
  end();
  if (state_->thread.joinable()) state_->thread.join();
}

std::vector<std::string> Jobs::verbs() const {
  std::vector<std::string> verbs;
  for (const JobKind& kind : state_->kinds) verbs.push_back(kind.verb);
  return verbs;
}

std::string Jobs::start(const std::string& verb) {
  State& state = *state_;
  const auto kind =
      std::find_if(state.kinds.begin(), state.kinds.end(), [&](const JobKind& k) { return k.verb == verb; });
  if (kind == state.kinds.end()) return "there is no job " + verb;
  const Mode mode = state.bench.state().mode;
  if (kind->needs_the_rig && (mode == Mode::kRunning || mode == Mode::kStopped))
    return mode == Mode::kRunning ? "a run is under way: end it first"
                                  : "the bench is stopped: re-arm it first";
  const std::lock_guard<std::mutex> lock(state.mutex);
  if (state.busy) return state.verb + " is under way: end it first";
  if (state.thread.joinable()) state.thread.join();
  state.busy = true;
  state.ending = false;
  state.verb = verb;
  state.text.clear();
  state.progress.reset();
  state.stop_file = kind->stop_file;
  std::remove(state.stop_file.c_str());
  std::string name = verb + "-" + common::utc_now();
  std::replace(name.begin(), name.end(), ' ', '-');
  std::replace(name.begin(), name.end(), ':', '-');
  state.out = state.runs + "/" + name;
  state.thread = std::thread([&state, of = *kind] { state.run(of); });
  return "";
}

std::string Jobs::end() {
  State& state = *state_;
  const std::lock_guard<std::mutex> lock(state.mutex);
  if (!state.busy) return "no job runs";
  state.ending = true;
  if (state.child != nullptr) state.child->interrupt();
  if (!state.stop_file.empty()) std::ofstream(state.stop_file) << "stop\n";
  state.changed.notify_all();
  return "";
}

std::string Jobs::answer(bool yes) {
  State& state = *state_;
  const std::lock_guard<std::mutex> lock(state.mutex);
  if (!state.asked) return "nothing is asked";
  state.answered = yes;
  state.changed.notify_all();
  return "";
}

Json Jobs::now() const {
  const State& state = *state_;
  const std::lock_guard<std::mutex> lock(state.mutex);
  if (state.verb.empty()) return nullptr;
  const runs::RunState run = state.progress.value_or(runs::RunState{});
  return {{"verb", state.verb}, {"running", state.busy}, {"done", run.done},
          {"total", run.total}, {"note", run.note},      {"text", state.text}};
}

Json Jobs::question() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->asked ? Json(*state_->asked) : Json();
}

}  // namespace lodestone::console
