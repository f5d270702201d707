#include "bindings.h"
#include "lodestone/common/build_facts.h"
#include "lodestone/common/json.h"

PYBIND11_MODULE(_lodestone, module) {
  module.doc() = "The part of the package lodestone that is C++; use the package.";
  module.def("version",
             [] { return lodestone::common::build_and_host_facts().at("lodestone").get<std::string>(); });
  module.def("pybind11_version",
             [] { return pybind11::make_tuple(PYBIND11_VERSION_MAJOR, PYBIND11_VERSION_MINOR); });
  module.def(
      "plain_json",
      [](const std::string& text, const std::string& source) {
        return lodestone::common::parse_json(text, source, lodestone::common::JsonComments::kAllowed).dump();
      },
      pybind11::arg("text"), pybind11::arg("source"), "Without its comments.");
  lodestone::python::bind_errors();
  lodestone::python::bind_dynamics(module);
  lodestone::python::bind_controllers(module);
  lodestone::python::bind_transitions(module);
  lodestone::python::bind_environments(module);
  lodestone::python::bind_rig(module);
}
