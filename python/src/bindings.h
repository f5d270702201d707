#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "lodestone/inference/dynamics.h"

namespace lodestone::python {

namespace py = pybind11;

/// A learned simulator that planners and environments share.
struct Dynamics {
  std::shared_ptr<const inference::DynamicsModel> model;
};

// What the package lodestone stands on. Each adds its part to the module; configurations and facts cross the
// border as JSON text, which the package turns into dictionaries.

/// Faults of Lodestone become the exceptions of lodestone.errors.
void bind_errors();
void bind_dynamics(py::module_& module);
void bind_controllers(py::module_& module);
void bind_transitions(py::module_& module);
void bind_environments(py::module_& module);
void bind_rig(py::module_& module);

}  // namespace lodestone::python
