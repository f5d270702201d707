#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lodestone::rl {

/// Passes written out on up to two threads, or plain LibTorch with autograd, the readable reference.
enum class Td3Backend { kFused, kAutograd };
inline std::vector<std::string> names_of(Td3Backend) { return {"fused", "autograd"}; }

/// What the matrix products of the fused backend are computed in.
enum class Td3Products { kFloat32, kBfloat16 };
inline std::vector<std::string> names_of(Td3Products) { return {"float32", "bfloat16"}; }

/// Hyperparameters of TD3; defaults are those of Fujimoto et al. (2018), learning rate as the paper (IV-B2).
struct Td3Config {
  Td3Backend backend = Td3Backend::kFused;
  Td3Products products = Td3Products::kFloat32;
  double discount = 0.99;
  double polyak_tau = 0.005;
  double learning_rate = 3e-4;
  double policy_noise = 0.2;
  double noise_clip = 0.5;
  std::int64_t policy_frequency = 2;
  std::int64_t batch_size = 256;
  std::vector<std::int64_t> hidden = {256, 256};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("backend", backend, "",
            "who computes an update: written-out passes on up to two threads, or plain LibTorch with "
            "autograd, the "
            "readable reference; both agree to rounding");
    v.field(
        "products", products, "",
        "matrix products of the fused backend; bfloat16: operands are rounded to 8 bits of mantissa, sums "
        "are float32, where this processor is at least 1.5 times as fast so, else float32");
    v.field("discount", discount, "", "discount per step", {0.0, 1.0});
    v.field("polyak_tau", polyak_tau, "",
            "fraction of the network that moves into its target per policy update", {0.0, 1.0});
    v.field("learning_rate", learning_rate, "", "Adam's step size, actor and critics", {0.0, 1.0});
    v.field("policy_noise", policy_noise, "action units",
            "standard deviation of the target policy's smoothing noise", {0.0, 2.0});
    v.field("noise_clip", noise_clip, "action units", "bound of the smoothing noise", {0.0, 2.0});
    v.field("policy_frequency", policy_frequency, "updates", "critic updates per policy and target update",
            {1, 1000});
    v.field("batch_size", batch_size, "transitions", "transitions per update", {2, 1 << 20});
    v.field("hidden", hidden, "", "width of each hidden layer, actor and critics", {1, 8192});
  }
};

}  // namespace lodestone::rl
