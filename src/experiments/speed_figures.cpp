#include "speed_figures.h"

#include <cmath>
#include <opencv2/core/mat.hpp>
#include <utility>

#include <ATen/Context.h>
#include <ATen/TensorOperators.h>
#include <ATen/core/grad_mode.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/mm.h>
#include <ATen/ops/randn.h>

#include "lodestone/common/clock.h"
#include "lodestone/common/resource_use.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/control/planner.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/control/rig_identifier.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/nets/tensors.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/rig/rendered_camera.h"
#include "lodestone/rig/virtual_rig.h"
#include "lodestone/rl/flat_network.h"
#include "lodestone/rl/model_gradient_config.h"
#include "lodestone/rl/td3.h"
#include "lodestone/rl/td3_learner.h"
#include "lodestone/segmentation/evaluation.h"
#include "lodestone/task/action.h"
#include "lodestone/vision/localiser.h"

namespace lodestone::experiments {
namespace {

constexpr std::int64_t kObservationSize = 5;  // the paper's networks: state and target
constexpr std::int64_t kActionSize = 2;

/// Calls `work`, which does `units` of work, for at least run_s. The first call of all is not timed: caches,
/// buffers, threads.
template <class Work>
RateFigure timed(const SpeedConfig& config, double units, Work work) {
  return [run_s = config.run_s, units, work = std::move(work), warm = false]() mutable {
    if (!warm) work();
    warm = true;
    const common::SteadyClock clock;
    const double start_s = clock.now_s();
    double done = 0.0;
    double elapsed_s = 0.0;
    do {
      work();
      done += units;
      elapsed_s = clock.now_s() - start_s;
    } while (elapsed_s < run_s);
    return done / elapsed_s;
  };
}

double layer_flop(const std::vector<std::int64_t>& sizes) {
  double flop = 0.0;
  for (std::size_t i = 1; i < sizes.size(); ++i) {
    flop += 2.0 * static_cast<double>(sizes[i - 1]) * static_cast<double>(sizes[i]);
  }
  return flop;
}

inference::DynamicsModel drawn_model(const SpeedConfig& config) {
  const auto seed = static_cast<std::uint64_t>(config.seed);
  inference::DynamicsModel model;
  model.members.push_back(
      dynamics::fold(*dynamics::make_members(model.config, model.info.layout, seed).front()));
  common::RandomStream random(seed, "bench starts");
  model.start_states.resize(3 * 1000);
  for (double& number : model.start_states) number = random.uniform(-0.01, 0.01);
  return model;
}

std::shared_ptr<env::MbsEnv> drawn_environments(const SpeedConfig& config, std::int64_t count,
                                                std::int64_t threads) {
  env::EpisodeSettings settings;
  settings.count = count;
  settings.seed = static_cast<std::uint64_t>(config.seed);
  settings.task.dish_radius_m = config.rig.dish.radius_m;
  settings.encoder.length_scale_m = config.rig.dish.radius_m;
  settings.action.scale = config.rig.coils.max_current_A;
  return std::make_shared<env::MbsEnv>(drawn_model(config), settings, env::MbsConfig{}, threads);
}

constexpr std::int64_t kSize = 256;

struct Operands {
  at::Tensor a = at::randn({kSize, kSize});
  at::Tensor b = at::randn({kSize, kSize});
  at::Tensor c = at::empty({kSize, kSize});
  inference::CacheAligned<float> scratch;
};

/// FLOP/s of `product`, which multiplies one thread's operands.
template <class Product>
RateFigure product_rate(const SpeedConfig& config, std::int64_t threads, const Product& product) {
  constexpr int kProducts = 50;
  auto pool = std::make_shared<common::ThreadPool>(static_cast<std::size_t>(threads));
  auto operands = std::make_shared<std::vector<Operands>>(pool->size());
  const double flop = 2.0 * kSize * kSize * kSize * kProducts * static_cast<double>(pool->size());
  return timed(config, flop, [pool, operands, product] {
    pool->for_each(pool->size(), [&](std::size_t shard) {
      const at::NoGradGuard no_grad;
      for (int i = 0; i < kProducts; ++i) product((*operands)[shard]);
    });
  });
}

}  // namespace

RateFigure sgemm_rate(const SpeedConfig& config, std::int64_t threads) {
  return product_rate(config, threads, [](Operands& my) { at::mm_out(my.c, my.a, my.b); });
}

RateFigure gemm_rate(const SpeedConfig& config, std::int64_t threads) {
  return product_rate(config, threads, [](Operands& my) {
    inference::multiply<float>({my.a.data_ptr<float>(), kSize, kSize}, {my.b.data_ptr<float>(), kSize, kSize},
                               my.scratch, my.c.data_ptr<float>(), {my.b.data_ptr<float>(), true, nullptr});
  });
}

double td3_update_flop(const rl::Td3Config& td3) {
  // Targets forward (actor, twin critics), twin critics forward and backward, and at every second update the
  // actor forward and backward through the first critic.
  const auto sizes = [&](std::int64_t in, std::int64_t out) {
    std::vector<std::int64_t> all{in};
    all.insert(all.end(), td3.hidden.begin(), td3.hidden.end());
    all.push_back(out);
    return all;
  };
  const double actor = layer_flop(sizes(kObservationSize, kActionSize));
  const double critic = layer_flop(sizes(kObservationSize + kActionSize, 1));
  const double policy = (3.0 * actor + 2.0 * critic) / static_cast<double>(td3.policy_frequency);
  return static_cast<double>(td3.batch_size) * (actor + 2.0 * critic + 6.0 * critic + policy);
}

RateFigure td3_rate(const SpeedConfig& config, const rl::Td3Config& td3, std::int64_t threads) {
  constexpr int kUpdates = 20;
  std::shared_ptr<rl::Td3> learner =
      rl::make_td3(td3, kObservationSize, kActionSize, static_cast<std::uint64_t>(config.seed), threads);
  rl::Batch batch(td3.batch_size, kObservationSize, kActionSize);
  at::manual_seed(config.seed);
  for (at::Tensor* tensor : {&batch.observation, &batch.action, &batch.reward, &batch.next_observation}) {
    tensor->uniform_(-1.0, 1.0);
  }
  batch.not_done.fill_(1.0);
  const at::Tensor noise = 0.2 * at::randn({td3.batch_size, kActionSize});
  return timed(config, kUpdates, [learner, batch, noise] {
    for (int i = 0; i < kUpdates; ++i) learner->update(batch, noise);
  });
}

double mbs_step_flop() {
  const inference::DynamicsConfig paper;
  std::vector<std::int64_t> sizes{5};
  sizes.insert(sizes.end(), paper.hidden.begin(), paper.hidden.end());
  sizes.push_back(3);
  return layer_flop(sizes);
}

RateFigure mbs_rate(const SpeedConfig& config, std::int64_t environments, std::int64_t threads) {
  constexpr int kSteps = 10;
  auto env = drawn_environments(config, environments, threads);
  env->reset();
  std::vector<float> actions(static_cast<std::size_t>(environments * kActionSize));
  common::RandomStream random(static_cast<std::uint64_t>(config.seed), "bench actions");
  for (float& action : actions) action = static_cast<float>(random.uniform(-1.0, 1.0));
  return timed(config, static_cast<double>(kSteps * environments), [env, actions] {
    for (int i = 0; i < kSteps; ++i) env->step(actions);
  });
}

RateFigure rig_rate(const SpeedConfig& config, std::int64_t threads) {
  constexpr std::size_t kRigs = 16;
  constexpr int kSteps = 20;
  struct Rigs {
    explicit Rigs(std::size_t threads) : pool(threads) {}
    common::ThreadPool pool;
    std::vector<std::unique_ptr<rig::VirtualRig>> owned;
    std::vector<rig::CoilPulse> pulses = std::vector<rig::CoilPulse>(kRigs);
  };
  auto rigs = std::make_shared<Rigs>(static_cast<std::size_t>(threads));
  const auto seed = static_cast<std::uint64_t>(config.seed);
  for (std::size_t i = 0; i < kRigs; ++i) {
    rigs->owned.push_back(
        std::make_unique<rig::VirtualRig>(config.rig, seed + i, i == 0 ? nullptr : rigs->owned[0]->fields()));
  }
  auto random = std::make_shared<common::RandomStream>(seed, "bench-currents");
  return timed(config, static_cast<double>(kRigs * kSteps),
               [rigs, random, drive = physics::CoilDrive(config.rig)] {
                 for (const auto& rig : rigs->owned) rig->place({0.0, 0.0, random->uniform(-3.0, 3.0)});
                 for (int step = 0; step < kSteps; ++step) {
                   for (rig::CoilPulse& pulse : rigs->pulses) {
                     geometry::Drive drive_A(drive.size());
                     for (double& number_A : drive_A) number_A = random->uniform(-8.0, 8.0);
                     pulse.current_A = drive.current_A(drive_A, geometry::Vector2::Zero());
                     pulse.duration_s = 0.1;
                   }
                   rigs->pool.for_each(kRigs, [&](std::size_t i) {
                     rig::VirtualRig& rig = *rigs->owned[i];
                     const double start_s = rig.clock().now_s();
                     rig.coils().apply(rigs->pulses[i]);
                     rig.clock().sleep_until(start_s + rigs->pulses[i].duration_s + 0.2);
                   });
                 }
               });
}

struct ImageLatency::Bench {
  explicit Bench(const SpeedConfig& config)
      : scenes(scenes_of(config)),
        renderer(imaging::draw_scene(scenes, static_cast<std::uint64_t>(config.seed))),
        localiser(vision::Segmenter::load(config.segmenter), renderer.scene().camera,
                  scenes.bench.dish_radius_m,
                  [&] {
                    vision::LocaliserConfig localiser_config;
                    localiser_config.rod = vision::rod_of(scenes.bench);
                    return localiser_config;
                  }()),
        random(static_cast<std::uint64_t>(config.seed), "bench images") {
    policy.encoder.length_scale_m = config.rig.dish.radius_m;
    policy.action.scale = config.rig.coils.max_current_A;
    rl::Td3Config td3;
    td3.hidden = policy.hidden;
    const std::int64_t inputs = task::ObservationEncoder(policy.encoder).size();
    policy.weights = nets::to_arrays(
        rl::make_td3(td3, inputs, kActionSize, static_cast<std::uint64_t>(config.seed))->actor_weights());
    controller = std::make_unique<control::PolicyController>(policy);
  }
  static imaging::SceneConfig scenes_of(const SpeedConfig& config) {
    imaging::SceneConfig scenes = segmentation::training_scenes(config.segmenter);
    scenes.bench = rig::bench_of(config.rig);
    return scenes;
  }
  imaging::SceneConfig scenes;
  imaging::SceneRenderer renderer;
  vision::Localiser localiser;
  inference::Policy policy;
  std::unique_ptr<control::PolicyController> controller;
  common::RandomStream random;
  std::int64_t image = 0;
};

ImageLatency::ImageLatency(const SpeedConfig& config)
    : config_(config), bench_(std::make_unique<Bench>(config)) {}
ImageLatency::~ImageLatency() = default;

void ImageLatency::measure() {
  constexpr double kPathRadius_m = 0.015;
  constexpr double kStep_rad = 0.13;  // 2 mm from image to image
  const at::NoGradGuard no_grad;
  const common::SteadyClock clock;
  for (std::int64_t i = 0; i < config_.images; ++i, ++bench_->image) {
    const double angle = kStep_rad * static_cast<double>(bench_->image);
    const geometry::Pose2 pose{kPathRadius_m * std::cos(angle), kPathRadius_m * std::sin(angle),
                               geometry::wrap_angle(angle)};
    const cv::Mat image = bench_->renderer.render({{pose}}, bench_->random).image;
    const double start_s = clock.now_s();
    const vision::Localisation found = bench_->localiser.locate(image);
    const double seen_s = clock.now_s();
    task::Observation observation;
    observation.pose = found.pose;
    const auto currents_A =
        physics::opposed_pairs_A(task::drive_of(bench_->controller->act(observation), bench_->policy.action));
    const double commanded_s = clock.now_s();
    if (!found.found || !std::isfinite(currents_A[0])) ++missed;
    pose_ms.push_back(1e3 * (seen_s - start_s));
    command_ms.push_back(1e3 * (commanded_s - start_s));
  }
}

struct DecisionLatency::Deciders {
  explicit Deciders(const SpeedConfig& config)
      : seed(static_cast<std::uint64_t>(config.seed)),
        random(seed, "bench decisions"),
        simulator(std::make_shared<const control::LearnedSimulator>(best_model(config))),
        identifier(simulator, control::IdentificationConfig{}, 1.0),
        planner(simulator, control::PlannerConfig{}, seed),
        policy(best_policy(config)) {}

  /// As configs/best has them, with weights as drawn: the time does not depend on what was learned.
  static inference::DynamicsModel best_model(const SpeedConfig& config) {
    inference::DynamicsModel model;
    model.config.form = inference::DynamicsForm::kDelta;
    model.config.batch_norm = false;
    model.config.members = 4;
    model.config.components = 3;
    model.info.workspace_radius_m = config.rig.dish.radius_m;
    model.info.action_scale = config.rig.coils.max_current_A;
    for (const auto& member :
         dynamics::make_members(model.config, model.info.layout, static_cast<std::uint64_t>(config.seed)))
      model.members.push_back(dynamics::fold(*member));
    return model;
  }
  static inference::Policy best_policy(const SpeedConfig& config) {
    inference::Policy policy;
    policy.encoder.length_scale_m = config.rig.dish.radius_m;
    policy.encoder.drive_gain = policy.encoder.target_ahead = policy.encoder.memory = true;
    policy.action.scale = config.rig.coils.max_current_A;
    policy.proposals = rl::ModelGradientConfig{}.proposals;
    policy.hidden = rl::ModelGradientConfig{}.hidden;
    std::vector<std::int64_t> widths{task::ObservationEncoder(policy.encoder).size()};
    widths.insert(widths.end(), policy.hidden.begin(), policy.hidden.end());
    widths.push_back(inference::Actor::outputs(kActionSize, policy.proposals));
    rl::FlatNetwork<float> network(widths);
    common::RandomStream random(static_cast<std::uint64_t>(config.seed), "bench policy");
    network.initialise(random);
    policy.weights = nets::to_arrays(network.named(network.parameters(), ""));
    return policy;
  }

  std::uint64_t seed;
  common::RandomStream random;
  std::shared_ptr<const control::LearnedSimulator> simulator;
  control::RigIdentifier identifier;
  control::Planner planner;
  control::PolicyController policy;
};

DecisionLatency::DecisionLatency(const SpeedConfig& config)
    : config_(config), deciders_(std::make_unique<Deciders>(config)) {}
DecisionLatency::~DecisionLatency() = default;

void DecisionLatency::measure() {
  constexpr double kWithin_m = 0.02;
  const common::SteadyClock clock;
  const auto decide = [&](control::Controller& controller, std::vector<double>& times_ms) {
    controller.reset();
    deciders_->identifier.reset();
    common::RandomStream& random = deciders_->random;
    const auto drawn = [&] {
      return geometry::Pose2{random.uniform(-kWithin_m, kWithin_m), random.uniform(-kWithin_m, kWithin_m),
                             random.uniform(-geometry::kPi, geometry::kPi)};
    };
    task::Observation observation;
    geometry::Pose2 before = drawn();
    geometry::Drive drive_A = {3.0, 4.0};
    for (std::int64_t i = 0; i < config_.images; ++i) {
      observation.pose = drawn();
      observation.target_m = drawn().position_m();
      deciders_->identifier.expect(before, drive_A);  // while the pulse before was on
      const double start_s = clock.now_s();
      deciders_->identifier.learn({before, drive_A, observation.pose});
      observation.drive_gain = deciders_->identifier.gain();
      observation.last_action = controller.act(observation);
      times_ms.push_back(1e3 * (clock.now_s() - start_s));
      before = observation.pose;
      drive_A = config_.rig.coils.max_current_A * observation.last_action;
    }
  };
  decide(deciders_->planner, planner_ms);
  decide(deciders_->policy, policy_ms);
}

double training_memory_mb(const SpeedConfig& config, std::int64_t threads) {
  rl::LearningConfig learning;  // buffer of a million
  learning.warm_up_steps = learning.buffer_size;
  learning.env_steps = learning.buffer_size + 4 * config.mbs_environments;
  learning.updates_per_step = 0.001;
  const auto environments = drawn_environments(config, config.mbs_environments, threads);
  rl::Td3Learner learner(learning, rl::Td3Config{}, rl::NoiseConfig{},
                         static_cast<std::uint64_t>(config.seed), threads, *environments);
  while (!learner.finished()) learner.step();
  return common::peak_memory_mb();
}

}  // namespace lodestone::experiments
