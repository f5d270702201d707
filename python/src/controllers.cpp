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
#include "lodestone/physics/rig_description.h"
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
  geometry::Drive action;
  {
    const py::gil_scoped_release released;
    action = controller.act({at[0], at[1], at[2]}, {to[0], to[1]}, target_heading);
  }
  return array_of(std::vector<double>(action.begin(), action.end()), {action.size()});
}

/// How the coils of the rig are driven that a policy or simulator was made for; found out when it is asked.
class RigDrive {
 public:
  /// Currents [coils] or [N, coils] for actions, of a needle at a position, or (None) at the dish centre.
  py::array drives(const task::ActionConfig& config, const common::Json& rig, const py::handle& action,
                   const py::handle& position) {
    const Rows<double> actions = read_rows<double>(action, "action", config.size);
    const std::vector<double> at_m =
        position.is_none() ? std::vector<double>{0.0, 0.0} : read_row(position, "position", 2);
    if (!drive_) drive_ = drive_of(rig);
    std::vector<double> drives;
    for (std::size_t i = 0; i < actions.numbers.size(); i += static_cast<std::size_t>(config.size)) {
      const physics::PerCoil current_A = drive_->current_A(
          task::drive_of(geometry::as_drive(&actions.numbers[i], config.size), config), {at_m[0], at_m[1]});
      for (std::size_t coil = 0; coil < drive_->coils(); ++coil) drives.push_back(current_A[coil]);
    }
    const auto coils = static_cast<py::ssize_t>(drive_->coils());
    return array_of(std::move(drives), actions.single ? std::vector<py::ssize_t>{coils}
                                                      : std::vector<py::ssize_t>{actions.count, coils});
  }

 private:
  static physics::CoilDrive drive_of(const common::Json& rig) {
    if (!rig.is_object() || rig.empty()) return {};
    return physics::CoilDrive(common::config_from_json<physics::RigDescription>(
        physics::completed_rig(rig), "the rig that it was made for"));
  }

  std::optional<physics::CoilDrive> drive_;
};

class Policy {
 public:
  explicit Policy(const std::string& folder)
      : policy_(inference::load_policy(folder)),
        actor_(policy_.actor("checkpoint " + folder)),
        controller_(std::make_unique<control::PolicyController>(policy_), policy_.action.size) {}

  static std::unique_ptr<Policy> load(const std::string& folder) {
    const py::gil_scoped_release released;
    return std::make_unique<Policy>(folder);
  }
  void reset() { controller_.reset(); }
  py::array decide(const py::handle& pose, const py::handle& target, std::optional<double> target_heading) {
    return python::decide(controller_, pose, target, target_heading);
  }
  py::array drives(const py::handle& action, const py::handle& position) {
    return drive_.drives(policy_.action, policy_.rig, action, position);
  }

  py::array act(const py::handle& observation) const {
    const Rows<float> rows = read_rows<float>(observation, "observation", actor_.observation_size());
    const auto numbers = static_cast<py::ssize_t>(actor_.action_size());
    std::vector<float> actions(static_cast<std::size_t>(numbers * rows.count));
    {
      const py::gil_scoped_release released;
      inference::Actor::Workspace workspace;
      if (rows.count > 0) actor_.act(rows.numbers.data(), rows.count, actions.data(), workspace);
    }
    return array_of(std::move(actions), rows.single ? std::vector<py::ssize_t>{numbers}
                                                    : std::vector<py::ssize_t>{rows.count, numbers});
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
  RigDrive drive_;
};

class Planner {
 public:
  Planner(const Dynamics& dynamics, const std::string& config, std::uint64_t seed)
      : simulator_(std::make_shared<const control::LearnedSimulator>(*dynamics.model)),
        controller_(std::make_unique<control::Planner>(simulator_,
                                                       common::config_from_json<control::PlannerConfig>(
                                                           common::parse_json(config, "planner"), "planner"),
                                                       seed),
                    simulator_->action.size),
        rig_(dynamics.model->info.rig) {}
  void reset() { controller_.reset(); }
  py::array decide(const py::handle& pose, const py::handle& target, std::optional<double> target_heading) {
    return python::decide(controller_, pose, target, target_heading);
  }
  py::array drives(const py::handle& action, const py::handle& position) {
    return drive_.drives(simulator_->action, rig_, action, position);
  }

 private:
  std::shared_ptr<const control::LearnedSimulator> simulator_;
  RememberingController controller_;
  common::Json rig_;
  RigDrive drive_;
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
      .def("drives", &Policy::drives, py::arg("action"), py::arg("position"));
  py::class_<Planner>(module, "Planner")
      .def(py::init<const Dynamics&, const std::string&, std::uint64_t>(), py::arg("dynamics"),
           py::arg("config"), py::arg("seed"))
      .def("reset", &Planner::reset)
      .def("decide", &Planner::decide, py::arg("pose"), py::arg("target"), py::arg("target_heading"))
      .def("drives", &Planner::drives, py::arg("action"), py::arg("position"));
  module.def("save_policy", &save_policy, py::arg("folder"), py::arg("layers"), py::arg("contract"));
}

}  // namespace lodestone::python
