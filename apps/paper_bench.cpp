#include "paper_bench.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "lodestone/common/clock.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/run_folder.h"
#include "lodestone/report/paper_report.h"
#include "models.h"
#include "paper_cells.h"

namespace lodestone::apps {
namespace {

namespace fs = std::filesystem;

struct PaperOptions {
  std::string scale = "quick";
  std::string only;
  bool list = false;
  bool report = false;
};

/// A cell as it stands on the disk.
class CellFolder {
 public:
  CellFolder(const std::string& out, const Cell& cell)
      : cell_(cell), out_(out), path_(out + "/cells/" + cell.id) {}

  bool done() const { return fs::exists(path_ + "/done.json"); }
  const std::string& path() const { return path_; }
  std::string log() const { return path_ + ".log"; }

  /// The command line, without the program.
  std::vector<std::string> arguments(std::int64_t threads) const {
    std::vector<std::string> out = {cell_.verb, "--config", shipped_folder("configs") + "/" + cell_.config};
    if (!cell_.rig_file.empty()) out.insert(out.end(), {"--rig", cell_.rig_file});
    for (const std::string& setting : cell_.settings) {
      out.push_back("--set");
      out.push_back(resolve(setting));
    }
    for (const std::string& more :
         {std::string("--seed"), std::to_string(cell_.seed), std::string("--threads"),
          std::to_string(threads), std::string("--out"), path_})
      out.push_back(more);
    return out;
  }

  /// Makes room for a run: what was interrupted is gone on with where the verb can do that, or begun again.
  /// True when the run shall resume.
  bool prepare() const {
    const bool resumable = fs::exists(path_ + "/state.json") || fs::exists(path_ + "/training") ||
                           fs::exists(path_ + "/coverage.json") ||
                           (cell_.verb != "deploy" && fs::exists(path_ + "/result.json"));
    if (!resumable) fs::remove_all(path_);
    common::make_folders(fs::path(path_).parent_path().string());
    return resumable;
  }

  void mark_done(double seconds, const std::vector<std::string>& arguments) const {
    std::string command = "lodestone";
    for (const std::string& argument : arguments) command += " " + argument;
    const common::Json facts = {{"id", cell_.id},
                                {"command", command},
                                {"seconds", seconds},
                                {"machine", common::build_and_host_facts()}};
    // What only a resumption would need is not kept.
    fs::remove_all(path_ + "/training");
    common::write_file_atomically(path_ + "/done.json", facts.dump(1) + "\n");
  }

 private:
  /// Replaces {ID} by the folder of that cell.
  std::string resolve(std::string text) const {
    for (std::size_t open = text.find('{'); open != std::string::npos; open = text.find('{', open)) {
      const std::size_t close = text.find('}', open);
      text.replace(open, close - open + 1, out_ + "/cells/" + text.substr(open + 1, close - open - 1));
    }
    return text;
  }

  const Cell& cell_;
  std::string out_;
  std::string path_;
};

/// A lock that the child inherits: it is free only once both have gone, however they went.
class CellLock {
 public:
  explicit CellLock(const std::string& file) : descriptor_(open(file.c_str(), O_CREAT | O_RDWR, 0644)) {
    if (descriptor_ < 0)
      throw common::IoError("cannot open " + file + ": check the folder and the space on the disk");
    held_ = flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  }
  ~CellLock() { close(descriptor_); }
  CellLock(const CellLock&) = delete;
  CellLock& operator=(const CellLock&) = delete;
  bool held() const { return held_; }

 private:
  int descriptor_;
  bool held_ = false;
};

/// This program in a process of its own, its output in a file. It is told to stop when this process dies.
pid_t start(const std::vector<std::string>& arguments, const std::string& log) {
  std::vector<std::string> all = {"lodestone"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& argument : all) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int out = open(log.c_str(), O_CREAT | O_WRONLY | O_APPEND, 0644);
  if (out < 0) throw common::IoError("cannot write " + log + ": check the folder and the space on the disk");
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    close(out);
    execv("/proc/self/exe", argv.data());
    _exit(127);
  }
  close(out);
  if (child < 0) throw common::IoError("cannot start a process for a cell: too many are running");
  return child;
}

/// The last line a failed cell wrote.
std::string last_line(const std::string& log) {
  const std::string text = fs::exists(log) ? common::read_file(log) : "";
  const std::size_t end = text.find_last_not_of("\r\n");
  if (end == std::string::npos) return "it said nothing";
  const std::size_t begin = text.find_last_of("\r\n", end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1,
                     end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

/// Runs cells as soon as what they need is there, as many at a time as there are threads.
class CellRunner {
 public:
  CellRunner(const std::vector<Cell>& cells, const std::string& out, std::int64_t threads)
      : cells_(cells), out_(out), threads_(static_cast<std::size_t>(threads)) {
    for (std::size_t i = 0; i < cells.size(); ++i) index_[cells[i].id] = i;
  }

  CellFolder folder(const Cell& cell) const { return CellFolder(out_, cell); }

  /// Runs those of `wanted` that are not done. Throws Interrupted, and Error when cells failed, after the
  /// others ended.
  void run(const std::set<std::size_t>& wanted) {
    for (const std::size_t i : wanted) {
      if (!folder(cells_[i]).done()) left_.insert(i);
    }
    const std::int64_t all = static_cast<std::int64_t>(left_.size());
    common::Progress progress("bench paper", std::max<std::int64_t>(1, all));
    while ((!left_.empty() || !running_.empty()) && !stopping_) {
      start_what_can();
      reap();
      progress.update(all - static_cast<std::int64_t>(left_.size() + running_.size()), what_runs());
      if (running_.empty() && !started_) break;  // what is left needs something that failed or runs elsewhere
      if (common::interrupted()) stop_all();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    progress.finish();
    if (stopping_) throw common::Interrupted("bench paper: stopped; the same command goes on where it was");
    if (!failed_.empty())
      throw common::Error("bench paper: " + std::to_string(failed_.size()) + " cells failed, the first " +
                          failed_.front());
    if (!left_.empty())
      throw common::Error(
          "bench paper: " + std::to_string(left_.size()) +
          " cells wait for others that another process is running; run this again when it has ended");
  }

  /// A cell and all it needs, however indirectly.
  std::set<std::size_t> with_needs(const std::string& id) const {
    std::set<std::size_t> out;
    std::vector<std::string> open = {id};
    while (!open.empty()) {
      const std::size_t i = index_.at(open.back());
      open.pop_back();
      if (!out.insert(i).second || folder(cells_[i]).done()) continue;
      open.insert(open.end(), cells_[i].needs.begin(), cells_[i].needs.end());
    }
    return out;
  }

 private:
  struct Running {
    std::size_t cell;
    double start_s;
    std::vector<std::string> arguments;
    std::unique_ptr<CellLock> lock;
  };

  bool ready(std::size_t i) const {
    const Cell& cell = cells_[i];
    if (cell.all_threads && !running_.empty()) return false;
    return std::all_of(cell.needs.begin(), cell.needs.end(),
                       [&](const std::string& id) { return folder(cells_[index_.at(id)]).done(); });
  }

  void start_what_can() {
    started_ = false;
    for (auto next = left_.begin(); next != left_.end() && running_.size() < threads_;) {
      const std::size_t i = *next;
      const bool alone = !running_.empty() && cells_[running_.begin()->second.cell].all_threads;
      if (alone) return;
      if (!ready(i) || elsewhere_.count(i) != 0) {
        ++next;
        continue;
      }
      const CellFolder cell = folder(cells_[i]);
      common::make_folders(fs::path(cell.path()).parent_path().string());
      auto lock = std::make_unique<CellLock>(cell.path() + ".lock");
      if (!lock->held()) {
        elsewhere_.insert(i);
        ++next;
        continue;
      }
      const std::int64_t threads = cells_[i].all_threads ? static_cast<std::int64_t>(threads_) : 1;
      std::vector<std::string> arguments = cell.arguments(threads);
      std::vector<std::string> run = arguments;
      if (cell.prepare()) run.push_back("--resume");
      const pid_t child = start(run, cell.log());
      running_[child] = {i, clock_.now_s(), std::move(arguments), std::move(lock)};
      next = left_.erase(next);
      started_ = true;
    }
  }

  void reap() {
    for (auto next = running_.begin(); next != running_.end();) {
      int status = 0;
      if (waitpid(next->first, &status, WNOHANG) != next->first) {
        ++next;
        continue;
      }
      const Running& run = next->second;
      const CellFolder cell = folder(cells_[run.cell]);
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        cell.mark_done(clock_.now_s() - run.start_s, run.arguments);
      } else if (!common::interrupted()) {
        failed_.push_back(cells_[run.cell].id + ": " + last_line(cell.log()));
        common::log_error("cell " + failed_.back() + " (" + cell.log() + ")");
      }
      next = running_.erase(next);
      started_ = true;  // something may have become ready
    }
  }

  void stop_all() {
    stopping_ = true;
    for (const auto& [child, run] : running_) kill(child, SIGTERM);
    for (const auto& [child, run] : running_) waitpid(child, nullptr, 0);
    running_.clear();
  }

  std::string what_runs() const {
    std::string text;
    for (const auto& [child, run] : running_) text += (text.empty() ? "" : ", ") + cells_[run.cell].id;
    return text;
  }

  const std::vector<Cell>& cells_;
  std::string out_;
  std::size_t threads_;
  std::map<std::string, std::size_t> index_;
  std::set<std::size_t> left_;  // in the order of the list
  std::set<std::size_t> elsewhere_;
  std::map<pid_t, Running> running_;
  std::vector<std::string> failed_;
  common::SteadyClock clock_;
  bool started_ = false;
  bool stopping_ = false;
};

void list_cells(const std::vector<Cell>& cells, const CellRunner& runner) {
  for (const Cell& cell : cells) {
    std::string command;
    for (const std::string& argument : runner.folder(cell).arguments(1)) {
      const bool plain = argument.find_first_of(" {}[]\"'") == std::string::npos;
      command += plain ? " " + argument : " '" + argument + "'";
    }
    std::printf("%-4s %s\n         lodestone%s\n", runner.folder(cell).done() ? "done" : "-", cell.id.c_str(),
                command.c_str());
  }
}

/// A folder holds one scale and seed: cells of another would stand in the same places.
void keep_to_one_scale(const std::string& out, const PaperScale& scale) {
  PaperScale deciding = scale;
  deciding.threads = 0;
  const common::Json json = common::config_to_json(deciding);
  const std::string file = out + "/scale.json";
  if (!fs::exists(file)) {
    common::make_folders(out);
    common::write_file_atomically(file, json.dump(1) + "\n");
  } else if (common::read_json_file(file) != json) {
    throw common::ConfigError("bench paper: " + file +
                              " says that this folder holds another scale or seed; name another --out");
  }
}

void bench_paper(CommonOptions options, const PaperOptions& paper) {
  if (paper.scale != "smoke" && paper.scale != "quick" && paper.scale != "full")
    throw common::ConfigError("bench paper: --scale " + paper.scale + " must be smoke, quick or full");
  if (options.out.empty()) options.out = "runs/paper-" + paper.scale;
  if (options.config_files.empty())
    options.config_files = {shipped_folder("configs") + "/bench/paper_" + paper.scale + ".json"};
  const std::string rig_file = std::exchange(options.rig_file, "");  // the cells' own
  const auto scale = resolve_config<PaperScale>(options);
  std::vector<Cell> cells = paper_cells(scale);
  if (!rig_file.empty())
    for (Cell& cell : cells) cell.rig_file = rig_file;
  const std::int64_t threads =
      scale.threads > 0 ? scale.threads : std::max<std::int64_t>(1, std::thread::hardware_concurrency());
  CellRunner runner(cells, options.out, threads);
  if (paper.list) return list_cells(cells, runner);
  const bool known = paper.only.empty() || std::any_of(cells.begin(), cells.end(), [&](const Cell& cell) {
                       return cell.id == paper.only;
                     });
  if (!known)
    throw common::ConfigError("bench paper: there is no cell \"" + paper.only +
                              "\"; --list prints all of them");
  keep_to_one_scale(options.out, scale);
  std::set<std::size_t> wanted;
  for (std::size_t i = 0; i < cells.size(); ++i) wanted.insert(i);
  if (!paper.only.empty()) wanted = runner.with_needs(paper.only);
  if (!paper.report) runner.run(wanted);
  if (!paper.only.empty()) return;
  std::printf("%s", report::write_paper_report(options.out, paper.scale).c_str());
  std::printf("report   %s/report.html\n", options.out.c_str());
}

}  // namespace

void add_bench_paper(CLI::App& bench, ConfigCatalogue& catalogue) {
  CLI::App* verb = bench.add_subcommand(
      "paper", "the experiments of section V beside the paper's tables and figures; resumes when run again");
  auto options = std::make_shared<CommonOptions>();
  auto paper = std::make_shared<PaperOptions>();
  catalogue["bench paper"] = [options] { return describe_resolved<PaperScale>(*options); };
  add_common_options(*verb, *options);
  verb->add_option("--scale", paper->scale,
                   "smoke (about 2 min on 2 cores), quick (20 to 40) or full (overnight)");
  verb->add_flag("--list", paper->list, "print the cells, what is done of them, and the command of each");
  verb->add_flag("--report", paper->report, "run nothing; write the report of what is done so far");
  verb->add_option("--only", paper->only, "run this cell, and what it needs")->type_name("ID");
  verb->callback([options, paper] { bench_paper(*options, *paper); });
}

}  // namespace lodestone::apps
