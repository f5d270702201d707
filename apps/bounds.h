#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/experiments/bounded_figure.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::apps {

/// Prints a line for each figure from the `first` on.
void print_bounds(const std::vector<experiments::BoundedFigure>& figures, std::size_t first = 0);

/// Throws HardwareError, naming the first, where bounds are broken; `verb` begins the message.
void check_bounds(const std::string& verb, const std::vector<experiments::BoundedFigure>& figures);

/// One part of a bench: what is measured, and how that is printed.
template <class Bench, class Result>
struct MeasuredPart {
  void (Bench::*measure)();
  void (*print)(const Result& result);
};

/// Measures part by part, prints each with its bounds, writes the result and ends the run. Throws as
/// check_bounds().
template <class Bench, class Result, std::size_t parts>
void measure(Bench& bench, const MeasuredPart<Bench, Result> (&each)[parts], runs::RunFolder& run) {
  run.begin();
  const Result& result = bench.result();
  for (const MeasuredPart<Bench, Result>& part : each) {
    const std::size_t before = result.figures.size();
    (bench.*part.measure)();
    part.print(result);
    print_bounds(result.figures, before);
  }
  common::write_artefact(run.file(Result::kFile), result);
  run.finish();
  check_bounds(run.verb(), result.figures);
}

}  // namespace lodestone::apps
