#include <pybind11/numpy.h>

#include <algorithm>

#include "arrays.h"
#include "bindings.h"
#include "lodestone/data/dataset_file.h"

namespace lodestone::python {
namespace {

/// Columns of all recorded steps, one row each.
struct Columns {
  std::vector<double> state, action, next_state;
  std::vector<std::uint8_t> terminated, truncated, zero_current;
  std::vector<std::int64_t> episode;
};

Columns columns_of(const data::Dataset& dataset) {
  const auto size = static_cast<std::ptrdiff_t>(data::state_size(dataset.info.layout));
  Columns columns;
  std::int64_t index = 0;
  for (const data::Episode& episode : dataset.episodes) {
    const auto& seen = episode.observations;
    columns.state.insert(columns.state.end(), seen.begin(), seen.end() - size);
    columns.next_state.insert(columns.next_state.end(), seen.begin() + size, seen.end());
    columns.action.insert(columns.action.end(), episode.actions.begin(), episode.actions.end());
    const auto append = [](std::vector<std::uint8_t>& to, const std::vector<std::uint8_t>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(columns.terminated, episode.terminations);
    append(columns.truncated, episode.truncations);
    append(columns.zero_current, episode.zero_current);
    columns.episode.insert(columns.episode.end(), episode.terminations.size(), index++);
  }
  return columns;
}

py::array flags(const std::vector<std::uint8_t>& values) {
  return array_of(values, {static_cast<py::ssize_t>(values.size())}).attr("view")(py::dtype::of<bool>());
}

py::dict read_transitions(const std::string& path) {
  data::DatasetInfo info;
  Columns columns;
  {
    const py::gil_scoped_release released;
    const data::Dataset dataset = data::read_any_dataset(path);
    info = dataset.info;
    columns = columns_of(dataset);
  }
  const auto rows = static_cast<py::ssize_t>(columns.episode.size());
  const py::ssize_t size = data::state_size(info.layout);
  py::dict out;
  out["state"] = array_of(std::move(columns.state), {rows, size});
  out["action"] = array_of(std::move(columns.action), {rows, info.action_size});
  out["next_state"] = array_of(std::move(columns.next_state), {rows, size});
  out["terminated"] = flags(columns.terminated);
  out["truncated"] = flags(columns.truncated);
  out["zero_current"] = flags(columns.zero_current);
  out["episode"] = array_of(std::move(columns.episode), {rows});
  out["facts"] = data::info_to_json(info).dump();
  return out;
}

}  // namespace

void bind_transitions(py::module_& module) {
  module.def("read_transitions", &read_transitions, py::arg("path"));
}

}  // namespace lodestone::python
