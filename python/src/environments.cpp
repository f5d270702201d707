#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <optional>

#include "arrays.h"
#include "bindings.h"
#include "environment_config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/thread_pool.h"

namespace lodestone::python {
namespace {

/// Numbers of `owner` as a read-only array of numpy, which keeps the owner.
template <class Number>
py::array view_of(const std::vector<Number>& numbers, const std::vector<py::ssize_t>& shape,
                  const py::dtype& type, const std::shared_ptr<const void>& owner) {
  auto held = std::make_unique<std::shared_ptr<const void>>(owner);
  const py::capsule base(held.release(),
                         [](void* kept) { delete static_cast<std::shared_ptr<const void>*>(kept); });
  py::array array(type, shape, numbers.data(), base);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// N copies of the learned simulator as one batch. What reset() and step() give are views of its buffers. Any
/// thread may step; one waits for the other.
class Environments {
 public:
  Environments(const Dynamics& dynamics, const std::string& config, std::int64_t count, std::uint64_t seed,
               std::uint64_t first_stream, std::int64_t threads)
      : model_(dynamics.model),
        config_(common::config_from_json<EnvironmentConfig>(common::parse_json(config, "environment"),
                                                            "environment")),
        threads_(threads) {
    env::adopt_data(model_->info, config_.task, config_.encoder, config_.action);
    if (config_.task.within == task::Within::kReachable)
      settings_.region = std::make_shared<const task::Region>(model_->recorded_moves, config_.region);
    settings_.count = count;
    settings_.first_stream = first_stream;
    settings_.task = config_.task;
    settings_.encoder = config_.encoder;
    settings_.action = config_.action;
    const py::gil_scoped_release released;
    begin(seed);
  }

  std::int64_t count() const { return settings_.count; }
  std::int64_t observation_size() const { return task::ObservationEncoder(config_.encoder).size(); }
  std::int64_t action_size() const { return config_.action.size; }
  std::string contract() const { return contract_of(config_, model_->info.rig).dump(); }

  /// New episodes everywhere, with a seed from its beginning: the observations.
  py::array reset(std::optional<std::uint64_t> seed) {
    check_process();
    const std::unique_lock<std::mutex> lock = alone();
    {
      const py::gil_scoped_release released;
      const common::DenormalsFlushed flushed;
      if (seed)
        begin(*seed);
      else
        observation_ = &environments_->reset();
    }
    return view(*observation_, observation_size());
  }

  /// The observations as they are: where an episode has ended, already those of the next one.
  py::array observation() {
    const std::unique_lock<std::mutex> lock = alone();
    return view(*observation_, observation_size());
  }

  /// (observation, reward, terminated, truncated, success, final observation, ended), and whether any has.
  py::tuple step(const py::handle& actions) {
    check_process();
    Rows<float> rows = read_rows<float>(actions, "actions", action_size());
    if (rows.count != settings_.count)
      throw py::value_error("actions are of " + std::to_string(rows.count) + " rows, must be [" +
                            std::to_string(settings_.count) + ", " + std::to_string(action_size()) +
                            "]: one for each environment");
    const env::StepResult* result = nullptr;
    bool any = false;
    const std::unique_lock<std::mutex> lock = alone();
    {
      const py::gil_scoped_release released;
      const common::DenormalsFlushed flushed;
      result = &environments_->step(rows.numbers);
      for (std::size_t i = 0; i < ended_->size(); ++i) {
        (*ended_)[i] = result->terminated[i] | result->truncated[i];
        any = any || (*ended_)[i] != 0;
      }
    }
    if (result != viewed_) look_at(*result);
    return any ? views_ended_ : views_;
  }

 private:
  /// Until the caller's views are made: another thread may begin a new seed, and these are of the old one's
  /// buffers. Waited for without the interpreter's lock, which who has this one needs.
  std::unique_lock<std::mutex> alone() {
    const py::gil_scoped_release released;
    return std::unique_lock<std::mutex>(mutex_);
  }

  void begin(std::uint64_t seed) {
    const common::DenormalsFlushed flushed;
    settings_.seed = seed;
    // In a process that was forked off there are no threads to wait for.
    environments_ = std::shared_ptr<env::MbsEnv>(new env::MbsEnv(*model_, settings_, config_.mbs, threads_),
                                                 [here = process_](env::MbsEnv* made) {
                                                   if (getpid() == here) delete made;
                                                 });
    ended_ = std::make_shared<std::vector<std::uint8_t>>(static_cast<std::size_t>(settings_.count));
    observation_ = &environments_->reset();
    viewed_ = nullptr;
  }

  void check_process() const {
    if (getpid() != process_)
      throw common::ConfigError(
          "environment: it was made in another process, and its threads have stayed there; make it in the "
          "process that steps it");
  }

  template <class Number>
  py::array view(const std::vector<Number>& numbers, py::ssize_t columns) const {
    std::vector<py::ssize_t> shape = {settings_.count, columns};
    return view_of(numbers, shape, py::dtype::of<Number>(), environments_);
  }
  py::array flags(const std::vector<std::uint8_t>& numbers, const std::shared_ptr<const void>& owner) const {
    return view_of(numbers, {settings_.count}, py::dtype::of<bool>(), owner);
  }

  void look_at(const env::StepResult& result) {
    const auto views = [&](bool any) {
      return py::make_tuple(view(result.observation, observation_size()),
                            view_of(result.reward, {settings_.count}, py::dtype::of<float>(), environments_),
                            flags(result.terminated, environments_), flags(result.truncated, environments_),
                            flags(result.success, environments_),
                            view(result.final_observation, observation_size()), flags(*ended_, ended_), any);
    };
    views_ = views(false);
    views_ended_ = views(true);
    viewed_ = &result;
  }

  std::shared_ptr<const inference::DynamicsModel> model_;
  EnvironmentConfig config_;
  env::EpisodeSettings settings_;
  std::int64_t threads_;
  pid_t process_ = getpid();
  std::mutex mutex_;
  std::shared_ptr<env::MbsEnv> environments_;
  std::shared_ptr<std::vector<std::uint8_t>> ended_;  ///< [N]
  const std::vector<float>* observation_ = nullptr;
  const env::StepResult* viewed_ = nullptr;  ///< what the views show
  py::tuple views_, views_ended_;
};

}  // namespace

void bind_environments(py::module_& module) {
  py::class_<Environments>(module, "Environments")
      .def(py::init<const Dynamics&, const std::string&, std::int64_t, std::uint64_t, std::uint64_t,
                    std::int64_t>(),
           py::arg("dynamics"), py::arg("config"), py::arg("count"), py::arg("seed"), py::arg("first_stream"),
           py::arg("threads"))
      .def_property_readonly("count", &Environments::count)
      .def_property_readonly("observation_size", &Environments::observation_size)
      .def_property_readonly("action_size", &Environments::action_size)
      .def("contract", &Environments::contract)
      .def("observation", &Environments::observation)
      .def("reset", &Environments::reset, py::arg("seed"))
      .def("step", &Environments::step, py::arg("actions"));
}

}  // namespace lodestone::python
