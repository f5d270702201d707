#include "lodestone/exports/policy_onnx.h"

#include <cmath>
#include <limits>

#include "lodestone/control/policy_controller.h"
#include "onnx_columns.h"

namespace lodestone::exports {
namespace {

using Layout = MemoryLayout;

/// Builds the graph, from inputs to outputs.
class PolicyGraph {
 public:
  PolicyGraph(const PolicyContract& contract, inference::OnnxModel& model)
      : contract_(contract), policy_(contract.policy()), model_(model), g_(model) {
    for (const ContractValue& value : contract.inputs())
      model.input({value.name, {"batch", value.size()}, inference::ElementType::kFloat32, value.description});
    position_ = g_.columns("pose", 0, 2);
    heading_ = g_.columns("pose", 2, 1);
  }

  void build() {
    const std::string numbers = network(encoded());
    const std::string said = policy_.proposals == 0 ? g_.op("Tanh", {numbers}) : chosen(numbers);
    current(said);
    if (contract_.remembers()) next_memory(said);
    for (const ContractValue& value : contract_.outputs())
      model_.output(
          {value.name, {"batch", value.size()}, inference::ElementType::kFloat32, value.description});
  }

 private:
  /// Places where the needle lies still, and what moved nothing there.
  struct Stalls {
    std::string place, drives;  ///< [batch, 3], [batch, kStalls, 2]
    std::string here;           ///< whether the needle lies there now, [batch, 1]
  };

  /// What task::ObservationEncoder makes of it.
  std::string encoded() {
    const task::EncoderConfig& encoder = policy_.encoder;
    const auto divided = [&](const std::string& value, double scale) {
      return g_.op("Div", {value, g_.number(scale)});
    };
    std::vector<std::string> parts = {divided(position_, encoder.length_scale_m)};
    const auto put = [&](const std::string& part) { parts.push_back(part); };
    if (encoder.heading == task::HeadingEncoding::kAngle) put(heading_);
    if (encoder.heading == task::HeadingEncoding::kSineCosine) put_angle(heading_, parts);
    if (encoder.target) put(divided("target", encoder.length_scale_m));
    if (encoder.relative_target) put_relative(g_.op("Sub", {"target", position_}), parts);
    if (encoder.target_heading) put_angle(g_.op("Sub", {"target_heading", heading_}), parts);
    if (encoder.memory) {
      put(g_.columns("memory", Layout::kAction, 2));
      const std::string moved = g_.op("Sub", {position_, g_.columns("memory", Layout::kPose, 2)});
      put(divided(g_.op("Mul", {known(), moved}), encoder.displacement_scale_m));
    }
    if (encoder.drive_gain) put("drive_gain");
    return g_.row(parts);
  }

  void put_angle(const std::string& angle, std::vector<std::string>& parts) {
    parts.push_back(g_.op("Sin", {angle}));
    parts.push_back(g_.op("Cos", {angle}));
  }

  void put_relative(const std::string& vector, std::vector<std::string>& parts) {
    const double length_m = policy_.encoder.length_scale_m;
    const double fine_m = policy_.encoder.fine_distance_m;
    if (fine_m <= 0.0) {
      parts.push_back(g_.op("Div", {vector, g_.number(length_m)}));
      return;
    }
    const std::string fine = g_.op("Div", {vector, g_.number(fine_m)});  // in units of it
    const std::string distance = g_.length(fine);
    const std::string one = g_.number(1.0);
    const std::string squares = g_.op("Add", {g_.op("Mul", {distance, distance}), one});
    parts.push_back(g_.op("Div", {fine, g_.op("Sqrt", {squares})}));
    parts.push_back(g_.op(
        "Div", {g_.op("Log", {g_.op("Add", {distance, one})}), g_.number(std::log1p(length_m / fine_m))}));
  }

  std::string network(std::string x) {
    std::int64_t inputs = task::ObservationEncoder(policy_.encoder).size();
    for (std::size_t i = 1; i <= contract_.layers(); ++i) {
      const std::string layer = "l" + std::to_string(i);
      const std::vector<float> bias = contract_.weights(layer + ".bias");
      const auto outputs = static_cast<std::int64_t>(bias.size());
      const std::string weight =
          model_.constant(layer + ".weight", {contract_.weights(layer + ".weight"), {outputs, inputs}});
      x = g_.op("Gemm", {x, weight, model_.constant(layer + ".bias", {bias, {outputs}})},
                {{"transB", std::int64_t{1}}});
      if (i < contract_.layers()) x = g_.op("Relu", {x});
      inputs = outputs;
    }
    return x;
  }

  /// Of what the network proposes, what control::PolicyController gives.
  std::string chosen(const std::string& numbers) {
    const std::int64_t proposals = policy_.proposals;
    const std::string actions = proposed(numbers);
    const std::string scores = g_.columns(numbers, 3 * proposals, proposals + 1);
    const std::string best = with_highest(scores, actions);
    stalls_ = stalls();
    const std::string drives =
        g_.op("Slice", {actions, g_.indices({0}), g_.indices({proposals}), g_.indices({1})});
    const std::string stalled = g_.op("And", {stalls_.here, alike(drives, stalls_.drives)});
    const std::string usable =
        g_.op("And", {g_.op("Not", {stalled}), g_.above(g_.length(drives, false), 0.0)});
    const std::string usable_scores =
        g_.where(usable, g_.columns(scores, 0, proposals), g_.number(std::numeric_limits<float>::lowest()));
    const std::string resting = g_.op("Not", {g_.above(g_.length(best), 0.0)});
    const std::string none = g_.op("Not", {g_.any(usable, true)});
    const std::string tried_anew = g_.op("And", {g_.op("Not", {resting}), none});
    stalls_.drives = g_.where(g_.reshaped(tried_anew, {0, 1, 1}), g_.number(0.0), stalls_.drives);
    return g_.where(g_.op("Or", {resting, none}), best, with_highest(usable_scores, drives));
  }

  /// [batch, proposals + 1, 2], the last of them resting.
  std::string proposed(const std::string& numbers) {
    const std::int64_t proposals = policy_.proposals;
    const std::string triples = g_.reshaped(g_.columns(numbers, 0, 3 * proposals), {0, proposals, 3});
    const auto part = [&](std::int64_t first, std::int64_t last) {
      return g_.op("Slice", {triples, g_.indices({first}), g_.indices({last}), g_.indices({2})});
    };
    const std::string direction = part(0, 2);
    const std::string strength = g_.scaled(g_.op("Sigmoid", {part(2, 3)}), kMostStrength);
    const std::string length = g_.op("Max", {g_.length(direction), g_.number(kLeastDirection)});
    const std::string along = g_.op("Div", {g_.op("Mul", {strength, direction}), length});
    const std::string cut = g_.op("Clip", {along, scalar(-1.0F), scalar(1.0F)});
    const std::string first = g_.op("Slice", {cut, g_.indices({0}), g_.indices({1}), g_.indices({1})});
    return g_.row({cut, g_.scaled(first, 0.0)});
  }

  std::string scalar(float value) { return g_.constant({value}, {}); }

  /// Of actions [batch, n, 2] the one with the highest of the scores [batch, n], the first of several.
  std::string with_highest(const std::string& scores, const std::string& actions) {
    const std::string index = g_.op("ArgMax", {scores}, {{"axis", std::int64_t{1}}});
    const std::string at = g_.reshaped(index, {0, 1, 1});
    const std::string both = g_.op("Concat", {at, at}, {{"axis", std::int64_t{2}}});
    return g_.reshaped(g_.op("GatherElements", {actions, both}, {{"axis", std::int64_t{1}}}), {0, 2});
  }

  /// control::StallMemory after the last pulse.
  Stalls stalls() {
    const std::int64_t count = Layout::kStalls;
    const std::string before = g_.columns("memory", Layout::kPose, 3);
    const std::string action = g_.columns("memory", Layout::kAction, 2);
    const std::string place = g_.columns("memory", Layout::kPlace, 3);
    const std::string drives = g_.reshaped(g_.columns("memory", Layout::kStalled, 2 * count), {0, count, 2});
    const std::string driven = g_.op("And", {g_.above(known(), 0.5), g_.above(g_.length(action), 0.0)});
    const std::string elsewhere = g_.op("And", {driven, g_.op("Not", {near(before, place)})});
    Stalls now;
    now.place = g_.where(elsewhere, before, place);
    now.here = near("pose", now.place);
    now.drives = g_.where(g_.reshaped(elsewhere, {0, 1, 1}), g_.number(0.0), drives);
    const std::string newest = g_.reshaped(action, {0, 1, 2});
    const std::string fresh =
        g_.op("And", {g_.op("And", {driven, now.here}), g_.op("Not", {alike(newest, now.drives)})});
    const std::string others =
        g_.op("Slice", {now.drives, g_.indices({0}), g_.indices({count - 1}), g_.indices({1})});
    now.drives = g_.where(g_.reshaped(fresh, {0, 1, 1}), g_.row({newest, others}), now.drives);
    return now;
  }

  /// Whether two poses [batch, 3] are one place, [batch, 1].
  std::string near(const std::string& one, const std::string& other) {
    const std::string from = g_.op("Sub", {one, other});
    const std::string close =
        g_.op("Less", {g_.length(g_.columns(from, 0, 2)), g_.number(control::PolicyController::kStill_m)});
    const std::string turned = g_.op("Cos", {g_.columns(from, 2, 1)});
    return g_.op("And", {close, g_.above(turned, std::cos(control::PolicyController::kStill_rad))});
  }

  /// Which of actions [batch, n, 2] are like one of the drives [batch, kStalls, 2]: [batch, n].
  std::string alike(const std::string& actions, const std::string& drives) {
    const std::string asked = g_.op("Unsqueeze", {actions, g_.indices({2})});
    const std::string had = g_.op("Unsqueeze", {drives, g_.indices({1})});
    const std::string stronger = g_.op("Max", {g_.length(asked, false), g_.length(had, false)});
    const std::string apart = g_.length(g_.op("Sub", {asked, had}), false);
    return g_.any(g_.op("Less", {apart, g_.scaled(stronger, control::StallMemory::kAlikeDrive)}), false);
  }

  /// What task::drive_of and physics::opposed_pairs_A make of an action.
  void current(const std::string& action) {
    std::string drive = action;
    if (policy_.action.dead_band > 0.0) {
      const std::string weak = g_.op("Less", {g_.length(drive), g_.number(policy_.action.dead_band)});
      drive = g_.where(weak, g_.number(0.0), drive);
    }
    if (policy_.action.one_axis_at_a_time) {
      const std::string size = g_.op("Abs", {drive});
      const std::string y_larger = g_.op("Greater", {g_.columns(size, 1, 1), g_.columns(size, 0, 1)});
      const std::string second = g_.as_float(y_larger);
      drive = g_.op("Mul", {drive, g_.row({g_.op("Sub", {g_.number(1.0), second}), second})});
    }
    const auto most_A = static_cast<float>(contract_.scale_A());
    const std::string coils = g_.constant({most_A, -most_A, 0.0F, 0.0F, 0.0F, 0.0F, most_A, -most_A}, {2, 4});
    model_.node("Relu", {g_.op("MatMul", {drive, coils})}, {}, "current");
  }

  void next_memory(const std::string& action) {
    const std::string one = g_.op("Add", {g_.scaled(heading_, 0.0), g_.number(1.0)});
    std::vector<std::string> parts = {one, "pose", action};
    if (policy_.proposals > 0) {
      parts.push_back(stalls_.place);
      parts.push_back(g_.reshaped(stalls_.drives, {0, 2 * Layout::kStalls}));
    }
    model_.node("Concat", parts, {{"axis", std::int64_t{1}}}, "next_memory");
  }

  std::string known() { return g_.columns("memory", Layout::kKnown, 1); }

  const PolicyContract& contract_;
  const inference::Policy& policy_;
  inference::OnnxModel& model_;
  OnnxColumns g_;
  std::string position_, heading_;
  Stalls stalls_;
};

}  // namespace

std::string policy_onnx(const PolicyContract& contract) {
  inference::OnnxModel model("lodestone_policy");
  for (const auto& [key, value] : contract.metadata()) model.metadata(key, value);
  PolicyGraph(contract, model).build();
  return model.encode();
}

}  // namespace lodestone::exports
