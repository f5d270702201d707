#include <catch2/catch.hpp>

#include "../../src/report/paper_page.h"
#include "report/kept_paper.h"

using namespace lodestone;
using tests::Kept;

TEST_CASE("losses of several seeds have an interval") {
  Kept made;
  for (const int seed : {1, 2}) {
    runs::DynamicsEvaluation& evaluation =
        made.add("dynamics/paper/" + std::to_string(seed)).dynamics.emplace();
    evaluation.normalised_l2 = seed == 1 ? 0.06 : 0.062;
  }
  report::PaperPage page(made.kept);
  report::add_dynamics(page);
  CHECK(page.markdown.find("| as the paper's | 0.033, 0.045 | – | 0.061 (0.048 to 0.074) |") !=
        std::string::npos);
}

TEST_CASE("losses stand beside the paper's, and how often somebody placed the needle is told") {
  Kept made;
  runs::DynamicsEvaluation& evaluation = made.add("dynamics/paper/1").dynamics.emplace();
  evaluation.training.emplace().validation_loss = 0.07;
  evaluation.normalised_l2 = 0.063;
  evaluation.one_step.position_rms_mm = 4.5;
  evaluation.baselines.emplace().no_motion.position_rms_mm = 15.0;
  evaluation.baselines->nearest_neighbours.position_rms_mm = 4.7;
  runs::CellRecord& likely = made.add("dynamics/best/1");
  likely.preset = {{"model", {{"components", 3}}}};
  likely.dynamics = evaluation;
  likely.dynamics->training->validation_loss = -2.3;
  runs::CollectionFacts& facts = made.add("data/paper").collected.emplace();
  facts.transitions = 34742;
  facts.placements = 2495;
  report::PaperPage page(made.kept);
  report::add_dynamics(page);
  CHECK(page.markdown.find("| as the paper's | 0.033, 0.045 | 0.070 | 0.063 | 4.50 | 15.00 | 4.70 |") !=
        std::string::npos);
  CHECK(page.markdown.find("| ours | – | – | 0.063 |") != std::string::npos);  // a likelihood is no distance
  CHECK(page.markdown.find("34742 pulses the paper's way, 2495 placements") != std::string::npos);
}

TEST_CASE("zones are drawn where pulses were recorded") {
  Kept made;
  data::Mobility& mobility = made.add("data/best").mobility.emplace();
  mobility.workspace_radius_m = 0.0425;
  mobility.cell_m = 0.004;
  mobility.cells.resize(2);
  mobility.cells[0].pulses = 10;
  mobility.cells[0].moved = 0.5;
  report::PaperPage page(made.kept);
  report::add_zones(page);
  REQUIRE(page.drawings.size() == 2);
  CHECK(page.drawings[0].first != page.drawings[1].first);
  for (const auto& [file, drawing] : page.drawings)
    CHECK((file == "zones_moved_best" || file == "zones_way_best"));
  CHECK(page.html.render().find("1 of 2 squares had none") != std::string::npos);
}
