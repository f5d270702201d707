#include <pybind11/numpy.h>

#include "arrays.h"
#include "bindings.h"

namespace lodestone::python {
namespace {

Dynamics load(const std::string& folder) {
  const py::gil_scoped_release released;
  return {std::make_shared<const inference::DynamicsModel>(inference::load_dynamics(folder))};
}

/// Mean of the ensemble, and each member's mixture: (mean [N, S], weight [M, N, K], component mean and
/// spread [M, N, K, S]), without the axis N for one row.
py::tuple predict(const Dynamics& dynamics, const py::handle& state, const py::handle& action) {
  const inference::DynamicsModel& model = *dynamics.model;
  const std::int64_t size = data::state_size(model.info.layout);
  const Rows<double> states = read_rows<double>(state, "state", size);
  const Rows<double> drives = read_rows<double>(action, "action", model.info.action_size);
  if (states.count != drives.count || states.single != drives.single)
    throw py::value_error("state and action are of " + std::to_string(states.count) + " and " +
                          std::to_string(drives.count) + " rows, must be as many");
  std::vector<double> mean(states.numbers.size());
  std::vector<double> weight, component_mean, spread;
  std::int64_t components = 1;
  {
    const py::gil_scoped_release released;
    inference::FoldedDynamics::Workspace workspace;
    std::vector<double> one_member;
    if (model.members.size() == 1)  // as an MBS of one member steps it
      model.members.front().predict(states.numbers.data(), drives.numbers.data(), states.count, mean.data(),
                                    workspace);
    else
      inference::predict_mean(model.members, states.numbers.data(), drives.numbers.data(), states.count,
                              mean.data(), one_member, workspace);
    for (const inference::FoldedDynamics& member : model.members) {
      const inference::PredictedMixture mixture =
          member.predict_mixture(states.numbers.data(), drives.numbers.data(), states.count, workspace);
      components = mixture.components;
      weight.insert(weight.end(), mixture.weight.begin(), mixture.weight.end());
      component_mean.insert(component_mean.end(), mixture.mean.begin(), mixture.mean.end());
      spread.insert(spread.end(), mixture.spread.begin(), mixture.spread.end());
    }
  }
  std::vector<py::ssize_t> rows = {states.count};
  if (states.single) rows.clear();
  const auto shape = [&](std::vector<py::ssize_t> before, const std::vector<py::ssize_t>& after) {
    before.insert(before.end(), rows.begin(), rows.end());
    before.insert(before.end(), after.begin(), after.end());
    return before;
  };
  const auto members = static_cast<py::ssize_t>(model.members.size());
  return py::make_tuple(array_of(std::move(mean), shape({}, {size})),
                        array_of(std::move(weight), shape({members}, {components})),
                        array_of(std::move(component_mean), shape({members}, {components, size})),
                        array_of(std::move(spread), shape({members}, {components, size})));
}

std::string facts(const Dynamics& dynamics) {
  common::Json facts = data::info_to_json(dynamics.model->info);
  facts["members"] = dynamics.model->members.size();
  facts["components"] = dynamics.model->config.components;
  facts["state_size"] = data::state_size(dynamics.model->info.layout);
  return facts.dump();
}

}  // namespace

void bind_dynamics(py::module_& module) {
  py::class_<Dynamics>(module, "Dynamics")
      .def_static("load", &load, py::arg("folder"))
      .def("facts", &facts)
      .def("predict", &predict, py::arg("state"), py::arg("action"));
}

}  // namespace lodestone::python
