#include "lodestone/exports/policy_header.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "c_source.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/exports/policy_golden.h"
#include "policy_header_text.h"
#include "rounded_layer.h"

namespace lodestone::exports {
namespace {

constexpr std::int64_t kMostArrayBytes = 32'767;  // what an array may have on AVR
constexpr double kLeastRounding = 1e-3;           // of the largest current

std::string define(const std::string& name, const std::string& value) {
  return "#define LODESTONE_" + name + " " + value + "\n";
}

std::string title(const PolicyContract& contract, const std::vector<RoundedLayer>& layers) {
  const std::map<std::string, std::string> metadata = contract.metadata();
  std::string text =
      "A policy of Lodestone " + metadata.at("lodestone") +
      ", for any C99 compiler. It allocates nothing, keeps nothing between calls, and needs the C library "
      "and its "
      "mathematics (-lm).\n\nPoses are in the dish frame: origin at the centre, x to coil +x, y to coil +y, "
      "headings counter-clockwise; metres, radians, ampere. It uses:\n";
  for (const ContractValue& value : contract.inputs())
    if (value.name != "memory") text += "- " + value.name + ": " + value.description + "\n";
  text += "\nIt tests itself: gcc -std=c99 -DLODESTONE_POLICY_TEST -x c policy.h -lm && ./a.out\n";
  if (products(layers) > kMostProducts)
    text += "\nIt is too large for an ATmega2560 with a period of 300 ms.\n";
  text += "\nTask: " + metadata.at("task") + "\nRig: " + metadata.at("rig") +
          "\nMade from: " + metadata.at("provenance");
  return c_comment(text);
}

std::string constants(const PolicyContract& contract, const std::vector<RoundedLayer>& layers) {
  using control::PolicyController;
  std::int64_t widest = layers.front().inputs;
  for (const RoundedLayer& layer : layers) widest = std::max(widest, layer.outputs);
  const std::int64_t proposals = contract.policy().proposals;
  std::string text = define("INPUTS", std::to_string(layers.front().inputs)) +
                     define("WIDEST", std::to_string(widest)) +
                     define("SCALE_A", c_number(contract.scale_A()));
  if (proposals == 0) return text;
  return text + define("PROPOSALS", std::to_string(proposals)) +
         define("STALLS", std::to_string(MemoryLayout::kStalls)) +
         define("STILL_M", c_number(PolicyController::kStill_m)) +
         define("STILL_COS", c_number(std::cos(PolicyController::kStill_rad))) +
         define("ALIKE", c_number(control::StallMemory::kAlikeDrive)) +
         define("MOST_STRENGTH", c_number(kMostStrength)) +
         define("LEAST_DIRECTION", c_number(kLeastDirection));
}

/// What task::ObservationEncoder does.
std::string encode(const PolicyContract& contract) {
  const task::EncoderConfig& encoder = contract.policy().encoder;
  std::string body;
  const auto put = [&](const std::string& expression) { body += "  *y++ = " + expression + ";\n"; };
  const std::string length = c_number(encoder.length_scale_m);
  put("in->x_m / " + length);
  put("in->y_m / " + length);
  if (encoder.heading == task::HeadingEncoding::kAngle) put("in->heading_rad");
  if (encoder.heading == task::HeadingEncoding::kSineCosine) {
    put("sinf(in->heading_rad)");
    put("cosf(in->heading_rad)");
  }
  if (encoder.target) {
    put("in->target_x_m / " + length);
    put("in->target_y_m / " + length);
  }
  if (encoder.relative_target && encoder.fine_distance_m > 0.0) {
    const double fine_m = encoder.fine_distance_m;
    const std::string fine = c_number(fine_m);
    body +=
        "  {\n    const float x = (in->target_x_m - in->x_m) / " + fine +
        ", y_ = (in->target_y_m - in->y_m) / " + fine +
        ";\n    const float distance = sqrtf(x * x + y_ * y_), unit = sqrtf(distance * distance + 1.0f);\n"
        "    *y++ = x / unit;\n    *y++ = y_ / unit;\n    *y++ = logf(1.0f + distance) / " +
        c_number(std::log1p(encoder.length_scale_m / fine_m)) + ";\n  }\n";
  } else if (encoder.relative_target) {
    put("(in->target_x_m - in->x_m) / " + length);
    put("(in->target_y_m - in->y_m) / " + length);
  }
  if (encoder.target_heading) {
    put("sinf(in->target_heading_rad - in->heading_rad)");
    put("cosf(in->target_heading_rad - in->heading_rad)");
  }
  if (encoder.memory) {
    const std::string scale = c_number(encoder.displacement_scale_m);
    put("memory->action[0]");
    put("memory->action[1]");
    put("memory->known * (in->x_m - memory->pose[0]) / " + scale);
    put("memory->known * (in->y_m - memory->pose[1]) / " + scale);
  }
  if (encoder.drive_gain) {
    put("in->log_gain");
    put("in->log_gain_sigma");
  }
  return "\nstatic inline void lodestone_encode(const lodestone_policy_input *in, const "
         "lodestone_policy_memory "
         "*memory,\n                                    float *y)\n{\n  (void)memory;\n" +
         body + "}\n";
}

std::string network(const std::vector<RoundedLayer>& layers) {
  std::string arrays;
  std::string calls;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const RoundedLayer& layer = layers[i];
    const std::string name = "lodestone_l" + std::to_string(i + 1);
    arrays += c_array(name + "_bias", layer.bias) + c_array(name + "_scale", layer.scale);
    calls += fmt::format("  unit = lodestone_round(y, {}, {}, x);\n", layer.inputs, i > 0 ? 1 : 0);
    calls += fmt::format("  LODESTONE_READ(y, LODESTONE_ADDRESS({0}_bias), 0, sizeof {0}_bias);\n", name);
    const std::int64_t rows = kMostArrayBytes / (2 * layer.inputs);
    for (std::int64_t first = 0; first < layer.outputs; first += rows) {
      const std::int64_t count = std::min(rows, layer.outputs - first);
      const std::string part = name + "_from_" + std::to_string(first);
      const auto begin = layer.weight.begin() + first * layer.inputs;
      arrays += c_array(part, std::vector<std::int16_t>(begin, begin + count * layer.inputs));
      calls += fmt::format(
          "  lodestone_add(LODESTONE_ADDRESS({}), LODESTONE_ADDRESS({}_scale), {}, {}, {}, x, unit, y);\n",
          part, name, first, count, layer.inputs);
    }
  }
  return "\n" + arrays +
         "\nstatic inline void lodestone_network(float *y)\n{\n  int16_t x[LODESTONE_WIDEST];\n  float "
         "unit;\n" +
         calls + "}\n";
}

std::string decide(const PolicyContract& contract) {
  const task::ActionConfig& action = contract.policy().action;
  std::string text = kHeaderDecide;
  text += contract.policy().proposals == 0
              ? "  for (axis = 0; axis < 2; ++axis) action[axis] = tanhf(y[axis]);"
              : "  lodestone_choose(pose, memory, y, action);";
  text += kHeaderDecided;
  if (action.dead_band > 0.0)
    text += "  if (sqrtf(action[0] * action[0] + action[1] * action[1]) < " + c_number(action.dead_band) +
            ") action[0] = action[1] = 0.0f;\n";
  if (action.one_axis_at_a_time) text += "  action[fabsf(action[0]) >= fabsf(action[1]) ? 1 : 0] = 0.0f;\n";
  return text + kHeaderCurrents;
}

/// Numbers of an input where a policy has it, else zeros.
void append(const GoldenStep& step, const char* name, std::size_t count, std::vector<float>& numbers) {
  const auto found = step.inputs.find(name);
  if (found == step.inputs.end())
    numbers.insert(numbers.end(), count, 0.0F);
  else
    numbers.insert(numbers.end(), found->second.begin(), found->second.end());
}

double worst_difference_A(const std::vector<GoldenEpisode>& one, const std::vector<GoldenEpisode>& other) {
  double worst_A = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i)
    for (std::size_t step = 0; step < one[i].size(); ++step)
      for (std::size_t coil = 0; coil < 4; ++coil)
        worst_A = std::max<double>(worst_A,
                                   std::abs(one[i][step].current_A[coil] - other[i][step].current_A[coil]));
  return worst_A;
}

std::string test(const PolicyContract& contract, const std::vector<RoundedLayer>& layers) {
  const std::vector<GoldenEpisode> episodes = golden_episodes(contract);
  const PolicyContract rounded(rounded_policy(contract.policy(), layers));
  const double rounding_A = worst_difference_A(episodes, golden_episodes(rounded));
  std::vector<float> inputs, currents_A;
  for (const GoldenEpisode& episode : episodes) {
    for (const GoldenStep& step : episode) {
      append(step, "pose", 3, inputs);
      append(step, "target", 2, inputs);
      append(step, "target_heading", 1, inputs);
      append(step, "drive_gain", 2, inputs);
      currents_A.insert(currents_A.end(), step.current_A.begin(), step.current_A.end());
    }
  }
  return "\n#ifdef LODESTONE_POLICY_TEST\n" +
         define("GOLDEN_EPISODE", std::to_string(episodes.front().size())) +
         define("GOLDEN_STEPS", std::to_string(episodes.size() * episodes.front().size())) +
         define("ROUNDING_A", c_number(rounding_A + kLeastRounding * contract.scale_A())) +
         c_array("lodestone_golden_input", inputs) + c_array("lodestone_golden_current_A", currents_A) +
         kHeaderTest;
}

}  // namespace

std::string policy_header(const PolicyContract& contract) {
  const std::vector<RoundedLayer> layers = rounded_layers(contract);
  const bool proposes = contract.policy().proposals > 0;
  std::string text =
      title(contract, layers) + kHeaderBegin + constants(contract, layers) + kHeaderInput + kHeaderMemory;
  if (proposes) text += kHeaderStallMemory;
  text += kHeaderNetwork + encode(contract) + network(layers);
  if (proposes) text += kHeaderChoose;
  return text + decide(contract) + test(contract, layers) + "\n#endif /* LODESTONE_POLICY_H */\n";
}

}  // namespace lodestone::exports
