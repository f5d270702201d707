#include "lodestone/exports/policy_torchscript.h"

#include <fmt/core.h>

#include <cmath>
#include <vector>

#include "lodestone/control/policy_controller.h"

namespace lodestone::exports {
namespace {

using Layout = MemoryLayout;

/// Placeholders are constants of a policy; values are [batch, n].
constexpr const char* kStallMethods = R"PY(
def near(self, one, other):
    apart = one - other
    close = torch.norm(apart[:, 0:2], 2, 1, True) < {still_m}
    return torch.logical_and(close, torch.cos(apart[:, 2:3]) > {still_cos})

def alike(self, actions, drives):
    asked = torch.unsqueeze(actions, 2)
    had = torch.unsqueeze(drives, 1)
    stronger = torch.maximum(torch.norm(asked, 2, 3), torch.norm(had, 2, 3))
    return torch.any(torch.norm(asked - had, 2, 3) < {alike} * stronger, 2)

def with_highest(self, scores, actions):
    best = torch.unsqueeze(torch.argmax(scores, 1, True), 2)
    return torch.squeeze(torch.gather(actions, 1, best.expand([-1, -1, 2])), 1)
)PY";

constexpr const char* kChoice = R"PY(
    before = memory[:, {pose}:{action}]
    last = memory[:, {action}:{place}]
    place = memory[:, {place}:{stalled}]
    drives = memory[:, {stalled}:].reshape([-1, {stalls}, 2])
    driven = torch.logical_and(memory[:, 0:1] > 0.5, torch.norm(last, 2, 1, True) > 0.0)
    elsewhere = torch.logical_and(driven, torch.logical_not(self.near(before, place)))
    place = torch.where(elsewhere, before, place)
    drives = torch.where(torch.unsqueeze(elsewhere, 2), torch.zeros_like(drives), drives)
    here = self.near(pose, place)
    newest = torch.unsqueeze(last, 1)
    fresh = torch.logical_and(torch.logical_and(driven, here), torch.logical_not(self.alike(newest, drives)))
    drives = torch.where(torch.unsqueeze(fresh, 2), torch.cat([newest, drives[:, :-1]], 1), drives)

    triples = x[:, 0:{scores}].reshape([-1, {proposals}, 3])
    direction = triples[:, :, 0:2]
    strength = {most_strength} * torch.sigmoid(triples[:, :, 2:3])
    length = torch.clamp_min(torch.norm(direction, 2, 2, True), {least_direction})
    proposed = torch.clamp(strength * direction / length, -1.0, 1.0)
    scores = x[:, {scores}:]
    best = self.with_highest(scores, torch.cat([proposed, torch.zeros_like(proposed[:, 0:1])], 1))
    stalled = torch.logical_and(here, self.alike(proposed, drives))
    usable = torch.logical_and(torch.norm(proposed, 2, 2) > 0.0, torch.logical_not(stalled))
    others = torch.where(usable, scores[:, 0:{proposals}], torch.full_like(scores[:, 0:{proposals}], -3.4e38))
    resting = torch.logical_not(torch.norm(best, 2, 1, True) > 0.0)
    none = torch.logical_not(torch.any(usable, 1, True))
    action = torch.where(torch.logical_or(resting, none), best, self.with_highest(others, proposed))
    anew = torch.logical_and(none, torch.logical_not(resting))
    drives = torch.where(torch.unsqueeze(anew, 2), torch.zeros_like(drives), drives)
)PY";

/// As Python reads it as a float.
std::string float_literal(double value) { return fmt::format("{:.9e}", value); }

/// The elements of the network's input.
std::vector<std::string> encoded_parts(const task::EncoderConfig& encoder) {
  const std::string length = float_literal(encoder.length_scale_m);
  std::vector<std::string> parts = {"position / " + length};
  const auto put = [&](const std::string& part) { parts.push_back(part); };
  if (encoder.heading == task::HeadingEncoding::kAngle) put("heading");
  if (encoder.heading == task::HeadingEncoding::kSineCosine) put("torch.sin(heading), torch.cos(heading)");
  if (encoder.target) put("target / " + length);
  if (encoder.relative_target && encoder.fine_distance_m > 0.0) {
    const double fine_m = encoder.fine_distance_m;
    const std::string fine = "((target - position) / " + float_literal(fine_m) + ")";
    const std::string distance = "torch.norm(" + fine + ", 2, 1, True)";
    put(fine + " / torch.sqrt(" + distance + " * " + distance + " + 1.0)");
    put("torch.log1p(" + distance + ") / " + float_literal(std::log1p(encoder.length_scale_m / fine_m)));
  } else if (encoder.relative_target) {
    put("(target - position) / " + length);
  }
  if (encoder.target_heading) put("torch.sin(target_heading - heading), torch.cos(target_heading - heading)");
  if (encoder.memory)
    put(fmt::format("memory[:, {0}:{1}], memory[:, 0:1] * (position - memory[:, {2}:{3}]) / {4}",
                    Layout::kAction, Layout::kPlace, Layout::kPose, Layout::kPose + 2,
                    float_literal(encoder.displacement_scale_m)));
  if (encoder.drive_gain) put("drive_gain");
  return parts;
}

std::string layer_lines(std::size_t layers) {
  std::string lines;
  for (std::size_t i = 1; i <= layers; ++i) {
    const std::string sum = fmt::format("torch.addmm(self.l{0}_bias, x, torch.t(self.l{0}_weight))", i);
    lines += "    x = " + (i < layers ? "torch.relu(" + sum + ")" : sum) + "\n";
  }
  return lines;
}

std::string choice_lines(const PolicyContract& contract) {
  using fmt::arg;
  const std::int64_t proposals = contract.policy().proposals;
  if (proposals == 0) return "    action = torch.tanh(x)\n";
  return fmt::format(kChoice, arg("pose", Layout::kPose), arg("action", Layout::kAction),
                     arg("place", Layout::kPlace), arg("stalled", Layout::kStalled),
                     arg("stalls", Layout::kStalls), arg("scores", 3 * proposals),
                     arg("proposals", proposals), arg("most_strength", float_literal(kMostStrength)),
                     arg("least_direction", float_literal(kLeastDirection)));
}

std::string current_lines(const PolicyContract& contract) {
  const task::ActionConfig& action = contract.policy().action;
  std::string lines = "    drive = " + float_literal(contract.scale_A()) + " * action\n";
  if (action.dead_band > 0.0)
    lines += "    strong = torch.norm(action, 2, 1, True) >= " + float_literal(action.dead_band) +
             "\n    drive = torch.where(strong, drive, torch.zeros_like(drive))\n";
  if (action.one_axis_at_a_time)
    lines +=
        "    y_larger = torch.gt(torch.abs(drive[:, 1:2]), torch.abs(drive[:, 0:1]))\n"
        "    acts = torch.cat([torch.logical_not(y_larger), y_larger], 1)\n"
        "    drive = torch.where(acts, drive, torch.zeros_like(drive))\n";
  return lines +
         "    x_A = drive[:, 0:1]\n    y_A = drive[:, 1:2]\n"
         "    current = torch.relu(torch.cat([x_A, -x_A, y_A, -y_A], 1))\n";
}

std::string script_source(const PolicyContract& contract) {
  using control::PolicyController;
  std::string inputs, parts;
  for (const ContractValue& value : contract.inputs()) inputs += ", " + value.name;
  for (const std::string& part : encoded_parts(contract.policy().encoder))
    parts += (parts.empty() ? "" : ", ") + part;
  std::string source;
  if (contract.policy().proposals > 0)
    source = fmt::format(kStallMethods, fmt::arg("still_m", float_literal(PolicyController::kStill_m)),
                         fmt::arg("still_cos", float_literal(std::cos(PolicyController::kStill_rad))),
                         fmt::arg("alike", float_literal(control::StallMemory::kAlikeDrive)));
  source += "\ndef forward(self" + inputs + "):\n    position = pose[:, 0:2]\n    heading = pose[:, 2:3]\n" +
            "    x = torch.cat([" + parts + "], 1)\n" + layer_lines(contract.layers()) +
            choice_lines(contract) + current_lines(contract);
  if (!contract.remembers()) return source + "    return current\n";
  const char* stalls = contract.policy().proposals > 0 ? ", place, torch.flatten(drives, 1)" : "";
  return source + "    next_memory = torch.cat([torch.ones_like(heading), pose, action" + stalls +
         "], 1)\n    return current, next_memory\n";
}

}  // namespace

nets::ScriptModule policy_torchscript(const PolicyContract& contract) {
  nets::ScriptModule script;
  script.source = script_source(contract);
  for (std::size_t i = 1; i <= contract.layers(); ++i) {
    const std::string name = "l" + std::to_string(i);
    for (const char* part : {"weight", "bias"})
      script.constants[name + "_" + part] = contract.policy().weights.at(name + "." + part);
  }
  for (const auto& [key, value] : contract.metadata())
    script.extra_files[key == "lodestone" ? key : key + ".json"] = value;
  return script;
}

}  // namespace lodestone::exports
