#include "lodestone/runs/resumable_run.h"

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/progress.h"

namespace lodestone::runs {
namespace {

constexpr double kUpdatePeriod_s = 2.0;  // of run.json

/// One process's part of a run.
class Loop {
 public:
  Loop(RunFolder& folder, ResumableWork& work, const RunText& text)
      : folder_(folder),
        work_(work),
        text_(text),
        earlier_s_(folder.state().seconds),
        start_s_(clock_.now_s()) {}

  double run() {
    const bool going_on = folder_.state().checkpoint.has_value();
    if (going_on) work_.load(folder_.path());
    common::MetricsLog metrics(folder_.path(), going_on ? work_.progress().done : common::kNoStep, earlier_s_,
                               folder_.config());
    common::Progress bar(text_.label, work_.progress().total);
    saved_s_ = shown_s_ = clock_.now_s();
    checkpoint_ = folder_.state().checkpoint;
    Progress now = work_.progress();
    while (!now.finished) {
      try {
        work_.step(metrics);
      } catch (const common::Interrupted&) {
        stop();  // the last checkpoint counts: nobody knows what a step left half-done
      } catch (const common::ConfigError&) {
        if (work_.progress().done == 0) folder_.abandon();
        throw;
      }
      now = work_.progress();
      bar.update(now.done, now.note);
      if (now.finished) break;
      if (common::interrupted()) {
        save();
        stop();
      }
      if (!checkpoint_ || clock_.now_s() - saved_s_ >= text_.checkpoint_every_s)
        save();
      else if (clock_.now_s() - shown_s_ >= kUpdatePeriod_s)
        show();
    }
    bar.update(now.done, now.note);
    bar.finish(now.note);
    save();
    return folder_.state().seconds;
  }

 private:
  void save() {
    work_.save(folder_.path());
    saved_s_ = clock_.now_s();
    checkpoint_ = work_.progress().done;
    show();
  }

  void show() {
    const Progress now = work_.progress();
    RunState state = folder_.state();
    state.unit = text_.unit;
    state.done = now.done;
    state.total = now.total;
    state.note = now.note;
    state.seconds = earlier_s_ + clock_.now_s() - start_s_;
    if (checkpoint_) state.checkpoint = checkpoint_;
    folder_.update(state);
    shown_s_ = clock_.now_s();
  }

  [[noreturn]] void stop() {
    const Progress now = work_.progress();
    RunState state = folder_.state();
    state.unit = text_.unit;
    state.total = now.total;
    state.done = checkpoint_.value_or(0);  // where it goes on
    folder_.update(state);
    throw common::Interrupted(folder_.verb() + ": stopped after " + std::to_string(state.done) + " of " +
                              std::to_string(now.total) + " " + text_.unit +
                              "; the same command with --resume goes on in " + folder_.path());
  }

  RunFolder& folder_;
  ResumableWork& work_;
  const RunText& text_;
  common::SteadyClock clock_;
  double earlier_s_;
  double start_s_;
  double saved_s_ = 0.0;
  double shown_s_ = 0.0;
  std::optional<std::int64_t> checkpoint_;
};

}  // namespace

void show_result(const RunFolder& folder, const common::Json& result) {
  common::MetricsLog(folder.path()).write_result(folder.state().done, result);
}

double run_resumably(RunFolder& folder, ResumableWork& work, const RunText& text) {
  folder.begin();
  return Loop(folder, work, text).run();
}

}  // namespace lodestone::runs
