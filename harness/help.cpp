// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/help.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <string_view>
#include <vector>

#include "harness/version.h"
#include "scenes/near_words.h"

namespace plumbline {
namespace {

/// Lines of examples for each command: what to type, and what it does.
using Examples = std::vector<std::pair<std::string, std::string>>;

const std::map<std::string, Examples>& all_examples() {
  static const std::map<std::string, Examples> examples = {
      {"nightly",
       {{"plumbline nightly", "everything once, then more rays; report in out/"},
        {"plumbline nightly --resume", "go on after a kill or a power cut"},
        {"plumbline nightly --shard 2/4 --seed 7 --out part2", "the second of four machines"}}},
      {"run",
       {{"plumbline run transforms", "the conformance test of a feature"},
        {"plumbline run hits.aimed_edges --rays 100000", "one ray family, deeper"},
        {"plumbline run '*.creature' --seed 7", "everything on one scene, repeatable"}}},
      {"list",
       {{"plumbline list --features", "what can be run by name"},
        {"plumbline list --section 6 --long", "cases of the paper's section 6, with axes"},
        {"plumbline list '*.nested' --json", "for programs"},
        {"plumbline list --ctest out/cases", "for CTest, which has them as tests: ctest --preset cases"}}},
      {"check",
       {{"plumbline check scene.obj", "your own scene, no camera or lights needed"},
        {"plumbline check 'my scenes/a.gltf' --rays 1000000", "deeper"}}},
      {"explain",
       {{"plumbline explain scene.obj --pixel 256,256", "why this pixel hit what it hit"},
        {"plumbline explain sphereflake:3 --ray 2.1,1.3,1.7,-2.1,-1.3,-1.7", "one ray: origin, direction"}}},
      {"bake", {{"plumbline bake scene.obj -o tree.exr", "the geometry image"}}},
      {"verify", {{"plumbline verify tree.exr --scene scene.obj", "every link and bound, without a ray"}}},
      {"inspect", {{"plumbline inspect scene.obj --out tree", "figures, pictures and a page to walk through"}}},
      {"render", {{"plumbline render sphereflake:3 -o flake.png --frames 64", "the reference's picture"}}},
      {"history",
       {{"plumbline history", "the last thirty runs"},
        {"plumbline history hits.camera.creature", "every answer of one case"}}},
      {"report",
       {{"plumbline report out", "write the pages again"},
        {"plumbline report --diff yesterday out", "what changed; 1 if a case fails newly"}}},
      {"merge", {{"plumbline merge part1 part2 part3 part4 --out out", "one run of four shards"}}},
      {"bench", {{"plumbline bench --quick --json bench.json", "speed against Embree"}}},
      {"faults",
       {{"plumbline faults", "what catches each fault on purpose"},
        {"plumbline faults --pictures --fault aperture", "a lens 3 % too wide: which cases of the nightly see it"},
        {"plumbline faults --mutants triangle.glsl", "every operator, constant and swizzle of a shader changed"}}},
      {"completion", {{"plumbline completion > ~/.local/share/bash-completion/completions/plumbline", "for bash"}}},
      {"manual", {{"plumbline manual > plumbline.1", "then: man ./plumbline.1"}}},
  };
  return examples;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// "--out", "-o": all names of a command's options.
std::set<std::string> options_of(const CLI::App& app) {
  std::set<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.insert("--" + name);
    for (const std::string& name : option->get_snames()) names.insert("-" + name);
  }
  return names;
}

/// Text in which troff sees no commands of its own.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\\' ? std::string("\\e") : c == '-' ? std::string("\\-") : std::string(1, c);
  return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}

}  // namespace

std::string words_alike(const std::string& word, const std::set<std::string>& words) {
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const std::string& other : words)
    if (const std::size_t d = edit_distance(word, other); d <= 1 + (word.size() + 1) / 4) near.emplace_back(d, other);
  std::sort(near.begin(), near.end());
  std::string text;
  for (std::size_t i = 0; i < near.size() && i < 3; ++i) text += (i ? ", " : "") + near[i].second;
  return text;
}

void add_examples(CLI::App& app) {
  for (CLI::App* sub : app.get_subcommands([](CLI::App*) { return true; })) {
    const auto found = all_examples().find(sub->get_name());
    if (found == all_examples().end()) continue;
    std::string text = "Examples:\n";
    for (const auto& [command, what] : found->second) text += "  " + command + "\n      " + what + "\n";
    sub->footer(text);
  }
}

std::string meant(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2) return "";
  const std::string word = argv[1];
  std::set<std::string> names;
  for (const CLI::App* sub : commands_of(app)) names.insert(sub->get_name());
  if (!names.contains(word)) return words_alike(word, names);
  const CLI::App* sub = app.get_subcommand(word);
  const std::set<std::string> options = options_of(*sub);
  for (int i = 2; i < argc; ++i) {
    const std::string option = std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
    if (option.size() > 2 && option.starts_with("--") && !options.contains(option)) return words_alike(option, options);
  }
  return "";
}

std::string completion_script(const CLI::App& app) {
  std::string names, options;
  for (const CLI::App* sub : commands_of(app)) {
    names += (names.empty() ? "" : " ") + sub->get_name();
    std::string words;
    for (const std::string& option : options_of(*sub)) words += (words.empty() ? "" : " ") + option;
    options += "    " + sub->get_name() + ") words='" + words + "' ;;\n";
  }
  return "# bash completion for plumbline, written by `plumbline completion`\n"
         "_plumbline() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} words=\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    COMPREPLY=($(compgen -W '" +
         names +
         " --help --version' -- \"$current\"))\n"
         "    return\n"
         "  fi\n"
         "  case $command in\n" +
         options +
         "  esac\n"
         "  case $current in\n"
         "    -*) COMPREPLY=($(compgen -W \"$words\" -- \"$current\")) ;;\n"
         "    *) case $command in\n"
         "      run|list) COMPREPLY=($(compgen -W \"$(\"${COMP_WORDS[0]}\" list --names 2>/dev/null)\" -- "
         "\"$current\")) ;;\n"
         "      *) COMPREPLY=($(compgen -f -- \"$current\")) ;;\n"
         "    esac ;;\n"
         "  esac\n"
         "}\n"
         "complete -o filenames -F _plumbline plumbline ./plumbline\n";
}

std::string manual_page(const CLI::App& app, const std::string& version) {
  std::string page = ".TH PLUMBLINE 1 \"\" \"plumbline " + troff(version) +
                     "\"\n.SH NAME\nplumbline \\- tells whether a GPU ray tracer is right\n"
                     ".SH SYNOPSIS\n.B plumbline\n.I COMMAND\n[ARGUMENTS]\n.SH DESCRIPTION\n" +
                     troff(app.get_description()) + "\n.SH COMMANDS\n";
  for (const CLI::App* sub : commands_of(app)) {
    page += ".SS " + troff(sub->get_name()) + "\n" + troff(sub->get_description()) + ".\n";
    for (const CLI::Option* option : sub->get_options())
      page += ".TP\n.B " + troff(option->get_name(false, true)) + "\n" + troff(option->get_description()) + "\n";
    const auto found = all_examples().find(sub->get_name());
    if (found == all_examples().end()) continue;
    page += ".PP\nExamples:\n";
    for (const auto& [command, what] : found->second) page += ".TP\n.B " + troff(command) + "\n" + troff(what) + "\n";
  }
  return page +
         ".SH EXIT STATUS\n0 all passed, 1 a case failed or was left out, 2 wrong usage or input, 3 wrong "
         "environment.\n"
         ".SH ENVIRONMENT\n.TP\n.B PLUMBLINE_DATA\nFolder of real scenes that the nightly examines too.\n";
}

void add_help_commands(CLI::App& app, Commands& commands) {
  CLI::App* completion = app.add_subcommand("completion", "Print the completion of these commands for bash");
  commands.emplace_back(completion, [&app] {
    std::fputs(completion_script(app).c_str(), stdout);
    return 0;
  });
  CLI::App* manual = app.add_subcommand("manual", "Print the manual page");
  commands.emplace_back(manual, [&app] {
    std::fputs(manual_page(app, version()).c_str(), stdout);
    return 0;
  });
}

}  // namespace plumbline
