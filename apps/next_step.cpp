#include "next_step.h"

#include <filesystem>
#include <vector>

namespace lodestone::apps {
namespace {

using Given = std::map<std::string, std::string>;

struct Follower {
  const char* verb;
  const char* step;         ///< {--x} is the value of an option or key, {beside --x} the folder around it
  const char* where = "";   ///< a key that must be true
  const char* before = "";  ///< a key that must not be given yet
};

/// The first of a verb's lines whose options were all given is the one that is said.
constexpr Follower kFollowers[] = {
    {"collect", "lodestone train-dynamics --set data={--out}/transitions.h5 --out {beside --out}/dynamics"},
    {"import", "lodestone train-dynamics --set data={--out} --out {beside --out}/dynamics"},
    {"train-dynamics",
     "lodestone train-policy --set dynamics={--out}/checkpoint --out {beside --out}/policy"},
    {"train-policy",
     "lodestone deploy --policy {--out}/checkpoint --set dynamics={dynamics} --task all --out {beside "
     "--out}/deploy",
     "encoder.drive_gain"},
    {"train-policy", "lodestone deploy --policy {--out}/checkpoint --task all --out {beside --out}/deploy"},
    {"train-segmenter", "look through {--out}/labels.html: what was told of {frames.source}", "",
     "frames.labels"},
    {"train-segmenter", "lodestone evaluate segmenter --checkpoint {--out}/checkpoint"},
    {"deploy", "lodestone report --run {run of --out}"},
    {"calibrate", "lodestone calibrate --check {--out}/calibration.json --camera {--camera}"},
    {"calibrate", "look at {--out}/overlay.png: its lines must lie on the edges"},
    {"calibrate coils", "lodestone collect --config {--config} --out runs/bench/collect"},
    {"rig check", "lodestone calibrate coils --config {--config} --out runs/coils.json"},
    {"qualify", "open {--out}/report.html in a browser; it needs no network"},
    {"rig field", "hold {--out} against what a gaussmeter shows"},
    {"bench speed", "scripts/update-readme {--out}/speed.json"},
    {"bench paper", "open {--out}/report.html in a browser; it needs no network"},
    {"bench tasks", "open {--out}/report.html in a browser; it needs no network"},
    {"evaluate dynamics", "lodestone train-policy --set dynamics={--checkpoint} --out runs/policy"},
    {"evaluate segmenter", "lodestone collect --set sensor.segmenter={--checkpoint} --out runs/collect"},
    {"report", "open {--out} in a browser; it needs no network"},
    {"report", "open {--run}/report.html in a browser; it needs no network"},
};

std::string value_of(std::string name, const Given& given) {
  const bool beside = name.rfind("beside ", 0) == 0;
  const bool run = name.rfind("run of ", 0) == 0;
  const auto found = given.find(beside || run ? name.substr(name.find("--")) : name);
  if (found == given.end()) return "";
  const std::filesystem::path value = found->second;
  // A run's deployment lies in RUN/deploy; one of its own is a run.
  if (!value.empty() && (beside || (run && value.filename() == "deploy")))
    return value.has_parent_path() ? value.parent_path().string() : ".";
  return value.string();
}

/// Empty when an option that the step names was not given.
std::string filled(std::string step, const Given& given) {
  for (std::size_t open = 0; (open = step.find('{', open)) != std::string::npos;) {
    const std::size_t close = step.find('}', open);
    const std::string value = value_of(step.substr(open + 1, close - open - 1), given);
    if (value.empty()) return "";
    step.replace(open, close - open + 1, value);
    open += value.size();
  }
  return step;
}

}  // namespace

std::string next_step(const std::string& verb, const std::map<std::string, std::string>& given) {
  for (const Follower& follower : kFollowers) {
    if (verb != follower.verb) continue;
    const auto where = given.find(follower.where);
    if (*follower.where != '\0' && (where == given.end() || where->second != "true")) continue;
    const auto before = given.find(follower.before);
    if (*follower.before != '\0' && before != given.end() && !before->second.empty()) continue;
    std::string step = filled(follower.step, given);
    if (!step.empty()) return step;
  }
  return "";
}

}  // namespace lodestone::apps
