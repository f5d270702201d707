#include "verbs.h"

#include <algorithm>

namespace lodestone::apps {
namespace {

void add_configured(const Verb& verb, const std::string& path, std::vector<std::string>& paths) {
  if (verb.configuration) paths.push_back(path);
  for (const Verb& each : verb.verbs)
    add_configured(each, path.empty() ? each.name : path + " " + each.name, paths);
}

}  // namespace

void add_verbs(Verb& program) {
  for (const auto& add :
       {add_collect, add_import, add_train_segmenter, add_train_dynamics, add_train_policy, add_deploy,
        add_console, add_adapt,  add_evaluate,        add_export,         add_calibrate,    add_rig,
        add_qualify, add_bench,  add_report,          add_compare,        add_figures,      add_status,
        add_check,   add_plan,   add_sweep,           add_config})
    add(program);
}

std::vector<std::string> configured_verbs(const Verb& program) {
  std::vector<std::string> paths;
  add_configured(program, "", paths);
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace lodestone::apps
