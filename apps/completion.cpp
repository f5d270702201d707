#include "verbs.h"

#include <algorithm>
#include <cstdio>

namespace lodestone::apps {
namespace {

/// Walks the words typed so far down to the verb, then offers what stands in the three tables. Where they
/// hold nothing bash completes file names.
constexpr const char* kFunction = R"BASH(
_lodestone() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=lodestone i
  for ((i = 1; i < COMP_CWORD; i++)); do
    [[ -n ${_lodestone_words["$verb ${COMP_WORDS[i]}"]} ]] && verb="$verb ${COMP_WORDS[i]}"
  done
  COMPREPLY=()
  if [[ $before == --set ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${_lodestone_keys["$verb"]}" -S = -- "$word")
    compopt -o nospace 2> /dev/null
  elif [[ -n ${_lodestone_values["$verb $before"]} ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${_lodestone_values["$verb $before"]}" -- "$word")
  elif [[ $before != --* || $word == --* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${_lodestone_words["$verb"]}" -- "$word")
  fi
}
complete -o default -F _lodestone lodestone
)BASH";

/// Lines of bash's associative arrays; paths begin with the program's name.
struct Tables {
  std::string words;   ///< path: verbs and options
  std::string values;  ///< path and option: what may stand behind it
  std::string keys;    ///< path: keys of the configuration
};

std::string entry(const std::string& key, const std::string& words) {
  return "  [\"" + key + "\"]=\"" + words + "\"\n";
}

void add_word(std::string& words, const std::string& word) { words += (words.empty() ? "" : " ") + word; }

/// The words that the configuration allows for the key an option is named after.
std::string choices(const std::vector<common::ConfigRow>& rows, std::string option) {
  std::replace(option.begin(), option.end(), '-', '_');
  for (const common::ConfigRow& row : rows) {
    if (row.key != option || row.bounds.find(" | ") == std::string::npos) continue;
    std::string words = row.bounds;
    for (std::size_t bar = 0; (bar = words.find(" | ")) != std::string::npos;) words.replace(bar, 3, " ");
    return words;
  }
  return "";
}

/// `rows`: the configuration of the verb above, for those that have none of their own.
void fill(const Verb& verb, const std::string& path, std::vector<common::ConfigRow> rows, Tables& tables) {
  if (verb.configuration) rows = verb.configuration();
  std::string words;
  for (const Verb& each : verb.verbs) {
    add_word(words, each.name);
    fill(each, path + " " + each.name, rows, tables);
  }
  add_word(words, "--help");
  for (const Option& option : verb.options) {
    if (option.name.rfind("--", 0) != 0) continue;
    add_word(words, option.name);
    const std::string values = choices(rows, option.name.substr(2));
    if (!values.empty()) tables.values += entry(path + " " + option.name, values);
  }
  tables.words += entry(path, words);
  std::string keys;
  for (const common::ConfigRow& row : rows) add_word(keys, row.key);
  if (!keys.empty()) tables.keys += entry(path, keys);
}

std::string bash_completion(const Verb& program) {
  Tables tables;
  fill(program, "lodestone", {}, tables);
  std::string verbs;
  for (const std::string& path : configured_verbs(program))
    if (path.find(' ') == std::string::npos) add_word(verbs, path);
  tables.values += entry("lodestone config --print", verbs);
  return "# Completion of lodestone for bash: source <(lodestone completion)\n"
         "declare -gA _lodestone_words=(\n" +
         tables.words + ")\ndeclare -gA _lodestone_values=(\n" + tables.values +
         ")\ndeclare -gA _lodestone_keys=(\n" + tables.keys + ")" + kFunction;
}

}  // namespace

void add_completion(Verb& program) {
  Verb& verb = program.add_verb("completion", "print completion for bash: source <(lodestone completion)");
  verb.run = [&program] { std::printf("%s", bash_completion(program).c_str()); };
}

}  // namespace lodestone::apps
