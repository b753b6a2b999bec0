// SPDX-License-Identifier: BSD-3-Clause
// The `clearance` command: how far a robot is from everything a depth sensor sees.
#include "command_line.hpp"

#include <clearance/config.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <iostream>
#include <new>

namespace {

constexpr int failure = 1;

/// CLI11 takes "-.5" for an option; "--camera-pose -.5,..." is handed to it as one word.
std::vector<std::string> with_negative_values(int argc, char** argv, const CLI::App& app) {
  std::vector<std::string> words;
  const CLI::App* sub = nullptr;
  for (int i = 1; i < argc; ++i) {
    std::string word = argv[i];
    for (const CLI::App* each : app.get_subcommands({}))
      if (!sub && each->check_name(word)) sub = each;
    const CLI::Option* option = sub && word.starts_with("--") ? sub->get_option_no_throw(word) : nullptr;
    if (option && option->get_expected_max() > 0 && i + 1 < argc) {
      const std::string_view next = argv[i + 1];
      if (next.size() > 1 && next[0] == '-' && std::string_view(".0123456789").find(next[1]) != next.npos) {
        word += '=' + std::string(next);
        ++i;
      }
    }
    words.push_back(word);
  }
  std::reverse(words.begin(), words.end());  // as CLI11 wants them
  return words;
}

/// CLI11 would only say that a subcommand is missing.
void check_subcommand(int argc, char** argv, const CLI::App& app) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::string names;
  for (const CLI::App* sub : app.get_subcommands({})) {
    if (sub->check_name(argv[1])) return;
    names += (names.empty() ? "" : ", ") + sub->get_name();
  }
  throw usage_error(argv[1], "there is no such subcommand; there are " + names);
}

int fail(std::string why) {
  if (why.starts_with("clearance: ")) why.erase(0, 11);
  for (char& c : why)  // one line, whatever a damaged file has put into it
    if (std::uint8_t(c) < 32 || c == 127) c = '?';
  std::cerr << "clearance: " << why << '\n';
  return failure;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("How far is this robot from everything its depth sensor sees?", "clearance");
  const std::string version = std::to_string(CLEARANCE_VERSION_MAJOR) + '.' + std::to_string(CLEARANCE_VERSION_MINOR) +
                              '.' + std::to_string(CLEARANCE_VERSION_PATCH);
  app.set_version_flag("--version", "clearance " + version);
  app.require_subcommand(1);
  app.footer("Exit codes: 0 done; 1 an error, wrong usage included; 2 --check fails; 3 no valid point.");
  std::vector<subcommand> run;
  for (const auto add : {add_query, add_run, add_pack, add_demo, add_info}) run.push_back(add(app));
  try {
    check_subcommand(argc, argv, app);
    app.parse(with_negative_values(argc, argv, app));
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (!app.get_subcommands({}).at(i)->parsed()) continue;
      const int code = run[i]();
      if (!std::cout.flush()) return fail("the output cannot be written");
      return code;
    }
    return failure;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::string help = "clearance";
    for (const CLI::App* sub : app.get_subcommands()) help += ' ' + sub->get_name();
    return fail(std::string(error.what()) + " (" + help + " --help says more)");
  } catch (const std::bad_alloc&) {
    return fail("there is not enough memory");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
