#include "bindings.h"
#include "lodestone/common/build_facts.h"

PYBIND11_MODULE(_lodestone, module) {
  module.doc() = "The part of the package lodestone that is C++; use the package.";
  module.def("version",
             [] { return lodestone::common::build_and_host_facts().at("lodestone").get<std::string>(); });
  lodestone::python::bind_errors();
  lodestone::python::bind_dynamics(module);
  lodestone::python::bind_controllers(module);
  lodestone::python::bind_transitions(module);
  lodestone::python::bind_environments(module);
  lodestone::python::bind_rig(module);
}
