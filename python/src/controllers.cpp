#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/control/planner.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/inference/policy.h"
#include "lodestone/physics/coil_drive.h"
#include "remembering_controller.h"

namespace lodestone::python {
namespace {

/// One decision of a policy or a planner.
py::array decide(RememberingController& controller, const py::handle& pose, const py::handle& target,
                 std::optional<double> target_heading) {
  const std::vector<double> at = read_row(pose, "pose", 3);
  const std::vector<double> to = read_row(target, "target", 2);
  if (target_heading && !std::isfinite(*target_heading))
    throw py::value_error("target_heading is " + std::to_string(*target_heading) +
                          ", must be a finite number");
  geometry::Vector2 action;
  {
    const py::gil_scoped_release released;
    action = controller.act({at[0], at[1], at[2]}, {to[0], to[1]}, target_heading);
  }
  return array_of(std::vector<double>{action.x(), action.y()}, {2});
}

/// Currents [4] or [N, 4] of the coils +x, -x, +y, -y for actions.
py::array drives_of(const task::ActionConfig& config, const py::handle& action) {
  const Rows<double> actions = read_rows<double>(action, "action", 2);
  std::vector<double> drives;
  for (std::size_t i = 0; i < actions.numbers.size(); i += 2)
    for (const double drive :
         physics::opposed_pairs_A(task::axis_drive({actions.numbers[i], actions.numbers[i + 1]}, config)))
      drives.push_back(drive);
  return array_of(std::move(drives),
                  actions.single ? std::vector<py::ssize_t>{4} : std::vector<py::ssize_t>{actions.count, 4});
}

class Policy {
 public:
  explicit Policy(const std::string& folder)
      : policy_(inference::load_policy(folder)),
        actor_(policy_.actor("checkpoint " + folder)),
        controller_(std::make_unique<control::PolicyController>(policy_)) {}

  static std::unique_ptr<Policy> load(const std::string& folder) {
    const py::gil_scoped_release released;
    return std::make_unique<Policy>(folder);
  }
  void reset() { controller_.reset(); }
  py::array decide(const py::handle& pose, const py::handle& target, std::optional<double> target_heading) {
    return python::decide(controller_, pose, target, target_heading);
  }
  py::array drives(const py::handle& action) const { return drives_of(policy_.action, action); }

  py::array act(const py::handle& observation) const {
    const Rows<float> rows = read_rows<float>(observation, "observation", actor_.observation_size());
    std::vector<float> actions(static_cast<std::size_t>(2 * rows.count));
    {
      const py::gil_scoped_release released;
      inference::Actor::Workspace workspace;
      if (rows.count > 0) actor_.act(rows.numbers.data(), rows.count, actions.data(), workspace);
    }
    return array_of(std::move(actions),
                    rows.single ? std::vector<py::ssize_t>{2} : std::vector<py::ssize_t>{rows.count, 2});
  }

  std::string facts() const {
    common::Json facts;
    facts["hidden"] = policy_.hidden;
    facts["proposals"] = policy_.proposals;
    facts["encoder"] = task::encoder_to_json(policy_.encoder);
    facts["action"] = task::action_to_json(policy_.action);
    facts["goal"] = policy_.goal;
    facts["rig"] = policy_.rig;
    facts["observation_size"] = actor_.observation_size();
    return facts.dump();
  }

 private:
  inference::Policy policy_;
  inference::Actor actor_;
  RememberingController controller_;
};

class Planner {
 public:
  Planner(const Dynamics& dynamics, const std::string& config, std::uint64_t seed)
      : simulator_(std::make_shared<const control::LearnedSimulator>(*dynamics.model)),
        controller_(std::make_unique<control::Planner>(simulator_,
                                                       common::config_from_json<control::PlannerConfig>(
                                                           common::parse_json(config, "planner"), "planner"),
                                                       seed)) {}
  void reset() { controller_.reset(); }
  py::array decide(const py::handle& pose, const py::handle& target, std::optional<double> target_heading) {
    return python::decide(controller_, pose, target, target_heading);
  }
  py::array drives(const py::handle& action) const { return drives_of(simulator_->action, action); }

 private:
  std::shared_ptr<const control::LearnedSimulator> simulator_;
  RememberingController controller_;
};

/// Throws ConfigError where `contract`, of an environment, cannot be used.
inference::Policy untrained_policy(const std::string& contract) {
  const std::string what = "save_policy: contract";
  try {
    const common::Json json = common::parse_json(contract, what);
    inference::Policy policy;
    policy.encoder = task::encoder_from_json(json.at("encoder"), what + ".encoder");
    policy.action = task::action_from_json(json.at("action"), what + ".action");
    policy.goal = json.at("goal").get<std::string>();
    policy.rig = json.at("rig");
    return policy;
  } catch (const common::Json::exception& error) {
    throw common::ConfigError(what + " is not that of an environment: " + error.what());
  }
}

/// `layers`: weight and bias of each. Throws ConfigError, CheckpointError, IoError.
void save_policy(const std::string& folder, const std::vector<std::pair<py::object, py::object>>& layers,
                 const std::string& contract) {
  inference::Policy policy = untrained_policy(contract);
  policy.hidden.clear();
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string name = "l" + std::to_string(i + 1);
    auto [weight, weight_shape] = read_array(layers[i].first, name + ".weight");
    auto [bias, bias_shape] = read_array(layers[i].second, name + ".bias");
    if (i + 1 < layers.size()) policy.hidden.push_back(bias_shape.empty() ? 0 : bias_shape.front());
    policy.weights[name + ".weight"] = inference::Array(std::move(weight), std::move(weight_shape));
    policy.weights[name + ".bias"] = inference::Array(std::move(bias), std::move(bias_shape));
  }
  const py::gil_scoped_release released;
  policy.actor("save_policy");  // says what does not fit before anything is written
  inference::save_policy(folder, policy, common::Json::object(), common::Json::object());
}

}  // namespace

void bind_controllers(py::module_& module) {
  py::class_<Policy>(module, "Policy")
      .def_static("load", &Policy::load, py::arg("folder"))
      .def("facts", &Policy::facts)
      .def("reset", &Policy::reset)
      .def("decide", &Policy::decide, py::arg("pose"), py::arg("target"), py::arg("target_heading"))
      .def("act", &Policy::act, py::arg("observation"))
      .def("drives", &Policy::drives, py::arg("action"));
  py::class_<Planner>(module, "Planner")
      .def(py::init<const Dynamics&, const std::string&, std::uint64_t>(), py::arg("dynamics"),
           py::arg("config"), py::arg("seed"))
      .def("reset", &Planner::reset)
      .def("decide", &Planner::decide, py::arg("pose"), py::arg("target"), py::arg("target_heading"))
      .def("drives", &Planner::drives, py::arg("action"));
  module.def("save_policy", &save_policy, py::arg("folder"), py::arg("layers"), py::arg("contract"));
}

}  // namespace lodestone::python
