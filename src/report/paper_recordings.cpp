#include <tuple>

#include "lodestone/report/dish_svg.h"
#include "lodestone/report/html.h"
#include "paper_page.h"

namespace lodestone::report {

void add_dynamics(PaperPage& page) {
  PaperTable table{{"learned simulator", "paper: validation and test loss", "validation loss", "test loss",
                    "one step, position RMS (mm)", "if nothing moved (mm)", "ten nearest neighbours (mm)",
                    "heading RMS (degrees)", "seeds"}};
  table.text_columns = 1;
  for (const auto& [key, name, published] : {std::tuple{"paper", "as the paper's", "0.033, 0.045"},
                                             {"ReLU on the input", "the same, with ReLU on its input", "–"},
                                             {"best", "ours", "–"}}) {
    const runs::PooledDynamics* f = find(page.result.dynamics, key);
    if (f == nullptr) {
      table.add_missing({name, published});
      continue;
    }
    table.cells.push_back(
        {name, published, with_interval("%.3f", f->validation_loss, f->validation_loss_interval),
         with_interval("%.3f", f->test_loss, f->test_loss_interval),
         with_interval("%.2f", f->position_rms_mm, f->position_rms_interval_mm),
         or_dash("%.2f", f->no_motion_mm), or_dash("%.2f", f->neighbours_mm),
         with_interval("%.1f", f->heading_rms_deg, f->heading_rms_interval_deg), seeds_text(f->origin)});
    table.add_commits(f->origin);
  }
  std::string data;
  for (const auto& [id, name] : {std::pair{"data/paper", "the paper's way"}, {"data/best", "our explorer"}}) {
    const auto found = page.kept.records.find(id);
    if (found == page.kept.records.end() || !found->second.collected) continue;
    const runs::CollectionFacts& facts = *found->second.collected;
    data += std::to_string(facts.transitions) + " pulses " + name + ", " +
            std::to_string(facts.placements.value_or(0)) + " placements of the needle by hand. ";
  }
  page.add_part("dynamics", "Section V-A, recordings and learned simulators",
                data +
                    "Each row is of the test pulses of its own recording, which are not equally hard: "
                    "compare it with what nothing, and ten recorded neighbours, foretell of the same pulses. "
                    "Losses are distances in units of the data's spread; ours learns a likelihood, whose "
                    "validation loss is none. Intervals: 95 %, Student's over seeds.",
                {{"", table}});
}

void add_zones(PaperPage& page) {
  std::string panels;
  for (const auto& [id, name] : {std::pair{"data/paper", "the paper's way"}, {"data/best", "our explorer"}}) {
    const auto found = page.kept.records.find(id);
    if (found == page.kept.records.end() || !found->second.mobility) continue;
    const data::Mobility& mobility = *found->second.mobility;
    std::vector<MapCell> moved, ways;
    std::size_t empty = 0;
    for (const data::MobilityCell& cell : mobility.cells) {
      if (cell.pulses == 0) {
        ++empty;
        continue;
      }
      moved.push_back({1e3 * cell.x_m, 1e3 * cell.y_m, 100.0 * cell.moved});
      ways.push_back({1e3 * cell.x_m, 1e3 * cell.y_m, cell.mean_mm});
    }
    const auto draw = [&](const std::vector<MapCell>& cells, double high, const char* legend,
                          const std::string& file) {
      DishSvg svg(1e3 * mobility.workspace_radius_m);
      svg.map(cells, 1e3 * mobility.cell_m, 0.0, high, legend, 0);
      const std::string drawn = svg.svg(std::string(legend) + ", recorded " + name);
      page.drawings.emplace_back(file, drawn);
      return drawn;
    };
    const std::string suffix = std::string(id).substr(5);
    panels += "<div class=\"panel\">" +
              draw(moved, 100.0, "pulses that move it, %", "zones_moved_" + suffix) + "<b>" + escape(name) +
              "</b><br>share of pulses of at least " + formatted("%.1f A", mobility.strong_A) +
              " that moved the needle; " + std::to_string(empty) + " of " +
              std::to_string(mobility.cells.size()) + " squares had none</div>" + "<div class=\"panel\">" +
              draw(ways, 30.0, "mean way of a pulse, mm", "zones_way_" + suffix) + "<b>" + escape(name) +
              "</b><br>how far they took it</div>";
  }
  if (panels.empty()) return;
  page.html.add_section(
      "zones", "Fig. 2: control zones",
      figure("<div class=\"panels\">" + panels + "</div>",
             "<b>Fig. 2.</b> Zones as recorded, in squares of 4 mm by where a pulse began. "
             "White: the needle was never there, as in what the paper calls dead "
             "zones (A), which it cannot access. In its zone B, in the middle, control is "
             "most stable; outside of it a near coil moves the needle too fast, or a far one "
             "too weakly."));
}

}  // namespace lodestone::report
