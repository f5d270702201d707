#include "member.h"

#include <catch2/catch.hpp>

#include "dynamics/sample_rows.h"
#include "lodestone/common/error.h"

namespace lodestone::dynamics {
namespace {

using inference::DynamicsForm;

/// A member that learns 300 rows, one in ten of them for validation.
Member small_member(const TrainingConfig& config, std::int64_t index = 0) {
  const tests::Rows rows = tests::sample_rows(data::StateLayout::kPosition, 300, 1);
  const auto network =
      make_members(tests::config_of(DynamicsForm::kDelta, false), data::StateLayout::kPosition, 1).front();
  network->fit_normalisers(rows.state, rows.action, rows.next_state);
  const auto part = [&rows](std::int64_t first, std::int64_t count) {
    return RowTensors{rows.state.narrow(0, first, count), rows.action.narrow(0, first, count),
                      rows.next_state.narrow(0, first, count)};
  };
  return Member(network, part(0, 270), part(270, 30), config, 1, index);
}

TEST_CASE("epochs lower both losses, and another member sees the rows in another order", "[unit]") {
  Member member = small_member({});
  member.run_epoch(0);
  const double first = member.validation_loss();
  for (std::int64_t epoch = 1; epoch < 20; ++epoch) member.run_epoch(epoch);
  CHECK(member.validation_loss() < 0.5 * first);
  CHECK(member.best_validation_loss() <= member.validation_loss());
  Member other = small_member({}, 1);
  other.run_epoch(0);
  CHECK(other.validation_loss() != first);  // the same weights at the start
}

TEST_CASE("a member that is restored goes on bitwise", "[unit]") {
  for (const auto optimiser : {Optimiser::kSgd, Optimiser::kAdam, Optimiser::kAdamW}) {
    CAPTURE(common::name_of(optimiser));
    TrainingConfig config;
    config.optimiser = optimiser;
    config.weight_decay = 1e-3;
    Member whole = small_member(config);
    whole.run_epoch(0);
    Member resumed = small_member(config);
    resumed.restore(whole.tensors(), whole.facts(), "test");
    whole.run_epoch(1);
    resumed.run_epoch(1);
    CHECK(whole.facts() == resumed.facts());
    nets::NamedTensors tensors = whole.tensors();
    for (const auto& [name, tensor] : resumed.tensors()) CHECK(at::equal(tensor, tensors.at(name)));
    tensors.erase("second_moment");
    CHECK_THROWS_AS(resumed.restore(tensors, whole.facts(), "test"), common::CheckpointError);
  }
}

TEST_CASE("a member that diverges stops at the step where it did", "[unit]") {
  TrainingConfig config;
  config.optimiser = Optimiser::kSgd;
  config.learning_rate = 10.0;
  Member member = small_member(config);
  const auto learn = [&] {
    for (std::int64_t epoch = 0; epoch < 100; ++epoch) member.run_epoch(epoch);
  };
  CHECK_THROWS_WITH(learn(), Catch::Contains("diverged at step "));
}

TEST_CASE("a member out of patience stands still", "[unit]") {
  TrainingConfig config;
  config.learning_rate = 1e-30;  // nothing gets better
  config.patience = 2;
  Member member = small_member(config);
  for (std::int64_t epoch = 0; epoch < 3; ++epoch) {
    CHECK_FALSE(member.stopped());
    member.run_epoch(epoch);
  }
  CHECK(member.stopped());
  const common::Json facts = member.facts();
  member.run_epoch(3);
  CHECK(member.facts() == facts);
}

}  // namespace
}  // namespace lodestone::dynamics
