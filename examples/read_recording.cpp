// Reads a recording and holds a learned simulator against it: the figures of `lodestone evaluate dynamics`.
//
//   build/examples/read_recording runs/collect/transitions.h5 models/dynamics_best
#include <cmath>
#include <cstdio>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/inference/dynamics.h"

using namespace lodestone;

/// Of the positions, which lead each row.
double rms_mm(const std::vector<double>& predicted, const data::TransitionTable& rows) {
  double sum_m2 = 0.0;
  for (std::size_t i = 0; i < predicted.size(); i += static_cast<std::size_t>(rows.state_size))
    for (const std::size_t k : {i, i + 1}) sum_m2 += std::pow(predicted[k] - rows.next_state[k], 2);
  return 1e3 * std::sqrt(sum_m2 / static_cast<double>(rows.size()));
}

int main(int count, char** words) try {
  if (count != 3) throw common::ConfigError("usage: read_recording TRANSITIONS.h5 DYNAMICS");
  const data::Dataset recording = data::read_any_dataset(words[1]);
  const inference::DynamicsModel dynamics = inference::load_dynamics(words[2]);
  if (recording.info.layout != dynamics.info.layout ||
      recording.info.action_size != dynamics.info.action_size)
    throw common::DataError("recording and simulator are of different robots");

  const data::TransitionTable rows = data::flatten(recording);  // without those that nothing was applied to
  std::vector<double> next(rows.state.size()), one_member;
  inference::FoldedDynamics::Workspace workspace;
  inference::predict_mean(dynamics.members, rows.state.data(), rows.action.data(), rows.size(), next.data(),
                          one_member, workspace);
  std::printf("pulses %lld in %zu episodes, drives in %s\n", static_cast<long long>(rows.size()),
              recording.episodes.size(), recording.info.action_unit.c_str());
  std::printf("simulator %.6f mm RMS, a needle that stays %.6f mm\n", rms_mm(next, rows),
              rms_mm(rows.state, rows));
} catch (const common::Error& error) {
  std::fprintf(stderr, "read_recording: %s\n", error.what());
  return 1;
}
