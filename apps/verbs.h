#pragma once

#include <string>
#include <vector>

#include "verb.h"

namespace lodestone::apps {

// Each declares one verb, its options and what runs.
void add_collect(Verb& program);
void add_import(Verb& program);
void add_train_segmenter(Verb& program);
void add_train_dynamics(Verb& program);
void add_train_policy(Verb& program);
void add_adapt(Verb& program);
void add_deploy(Verb& program);
void add_console(Verb& program);
void add_evaluate(Verb& program);
void add_export(Verb& program);
void add_calibrate(Verb& program);
void add_qualify(Verb& program);
void add_rig(Verb& program);
void add_bench(Verb& program);
void add_report(Verb& program);
void add_check(Verb& program);
void add_status(Verb& program);
void add_compare(Verb& program);
void add_figures(Verb& program);
void add_plan(Verb& program);
void add_sweep(Verb& program);
void add_config(Verb& program);
/// A script that completes the verbs of `program`, their options and, behind --set, the keys of their
/// configuration; written from their declarations.
void add_completion(Verb& program);

void add_bench_console(Verb& bench);
void add_bench_emulation(Verb& bench);
void add_bench_oracle(Verb& bench);
void add_bench_paper(Verb& bench);
void add_bench_rigs(Verb& bench);
void add_bench_speed(Verb& bench);
void add_bench_tasks(Verb& bench);
void add_bench_tracking(Verb& bench);
void add_calibrate_coils(Verb& calibrate);
void add_calibrate_field(Verb& calibrate);
void add_evaluate_field(Verb& evaluate);
void add_rig_check(Verb& rig);
void add_rig_emulate(Verb& rig);
void add_rig_conform(Verb& rig);

/// All verbs that have a configuration, and the program's own options.
void add_verbs(Verb& program);
/// Every key of the configuration that a verb would have with these words ("collect", "--set", ...). Throws
/// ConfigError that begins with `what` where it would not run with them.
std::vector<common::ConfigRow> configuration_rows(const std::vector<std::string>& words,
                                                  const std::string& what);
/// Paths of the verbs with a configuration ("collect", "rig check"), sorted.
std::vector<std::string> configured_verbs(const Verb& program);

}  // namespace lodestone::apps
