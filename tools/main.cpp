// SPDX-License-Identifier: BSD-3-Clause
// The `clearance` command: how far a robot is from everything a depth sensor sees.
#include "command_line.hpp"
#include "messages.hpp"
#include "progress.hpp"

#include <clearance/ground/config.hpp>

#include <CLI/CLI.hpp>

#include <fcntl.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <optional>

namespace {

constexpr int failure = 1;

bool blank(std::string_view text) { return text.find_first_not_of(" \t\r\n\v\f") == text.npos; }

/// The words of the command line as CLI11 needs them. CLI11 would drop an empty value, take the next option for the
/// value of "--cache=", and take "-.5" for an option. So every option with a value becomes one word, "--option=value",
/// and must have a value, unless it may stand alone. A flag must not: CLI11 would take "--flag=false", or a number, as
/// a count.
std::vector<std::string> checked_words(int argc, char** argv, const CLI::App& app) {
  std::vector<std::string> words;
  const CLI::App* sub = nullptr;
  for (int i = 1; i < argc; ++i) {
    std::string word = argv[i];
    if (blank(word)) throw usage_error("the command line", "word " + std::to_string(i) + " of it is empty");
    for (const CLI::App* each : app.get_subcommands({}))
      if (!sub && each->check_name(word)) sub = each;

    const std::string name = word.substr(0, word.find('='));
    const CLI::Option* option = word.starts_with("--") ? (sub ? sub : &app)->get_option_no_throw(name) : nullptr;
    if (option && option->get_expected_max() == 0 && name.size() < word.size())
      throw usage_error(name, "takes no value");
    if (option && option->get_expected_max() > 0) {
      if (name.size() == word.size() && i + 1 < argc) {
        const std::string_view next = argv[i + 1];
        const bool given = !next.starts_with("--");
        if (!given && option->get_expected_min() > 0)
          throw usage_error(name, "has no value, but the next word is " + std::string(next));
        if (given) (word += '=') += argv[++i];
      }
      if (name.size() < word.size() && blank(std::string_view(word).substr(name.size() + 1)))
        throw usage_error(name, "has an empty value (is a variable of the shell not set?)");
    }
    words.push_back(word);
  }

  std::reverse(words.begin(), words.end());  // CLI11 takes them in reverse
  return words;
}

/// Each use of an option has one value; CLI11 would take "[a,b]" and further words for several.
void take_one_value_each(CLI::App& app) {
  for (CLI::App* sub : app.get_subcommands({}))
    for (CLI::Option* option : sub->get_options()) option->allow_extra_args(false);
}

/// For all subcommands that compute.
void add_threads(CLI::App& app, std::string& threads) {
  for (CLI::App* sub : app.get_subcommands({}))
    if (!sub->check_name("info"))
      sub->add_option(
          "--threads", threads,
          "How many threads of the CPU may work, 1 to 1024 (default: as many as it has); no answer depends on it");
}

/// Names a wrong subcommand; CLI11 would only say that one is missing.
void check_subcommand(int argc, char** argv, const CLI::App& app) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::string names;
  for (const CLI::App* sub : app.get_subcommands({})) {
    if (sub->check_name(argv[1])) return;
    names += (names.empty() ? "" : ", ") + sub->get_name();
  }
  throw usage_error(argv[1], "there is no such subcommand; there are " + names);
}

int fail(const std::string& why) {
  say("clearance", without_prefix(why));
  return failure;
}

/// Flushes the output; if that fails, the exit code says so.
int finish(int code) {
  std::cout.flush();
  return !std::cout || std::fflush(stdout) != 0 || std::ferror(stdout) ? fail("the output cannot be written") : code;
}

/// Keeps files opened later from taking the number of a closed standard stream. A file that grows too large becomes an
/// error instead of a signal.
void hold_streams() {
  std::signal(SIGXFSZ, SIG_IGN);
  for (int stream = 0; stream < 3; ++stream)
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY);  // so that using it fails
}

#if defined(__AVX2__) && defined(__FMA__)
/// Refuses a processor without wide vectors (CLEARANCE_THIS_PROCESSOR), before anything uses them.
__attribute__((constructor(101), target("no-avx"))) void refuse_other_processors() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return;
  std::fputs("clearance: this was built for processors with AVX2 and FMA, and this one lacks them: build it here\n",
             stderr);
  std::_Exit(failure);
}
#endif

}  // namespace

int main(int argc, char** argv) {
  hold_streams();
  CLI::App app("How far is this robot from everything its depth sensor sees?", "clearance");
  const std::string version = std::to_string(CLEARANCE_VERSION_MAJOR) + '.' + std::to_string(CLEARANCE_VERSION_MINOR) +
                              '.' + std::to_string(CLEARANCE_VERSION_PATCH);
  app.set_version_flag("--version", "clearance " + version);
  app.require_subcommand(1);
  app.footer(exit_codes);

  std::vector<subcommand> run;
  for (const auto& [place, add] : listed_subcommand::all()) run.push_back(add(app));
  std::string threads;
  add_threads(app, threads);
  take_one_value_each(app);

  try {
    auto words = checked_words(argc, argv, app);
    check_subcommand(argc, argv, app);
    app.parse(words);
    std::optional<tbb::global_control> at_most;
    if (!threads.empty())
      at_most.emplace(tbb::global_control::max_allowed_parallelism, whole_number("--threads", threads, 1024));
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (!app.get_subcommands({}).at(i)->parsed()) continue;
      return finish(run[i]());
    }
    return failure;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return finish(app.exit(error));
    std::string help = "clearance";
    for (const CLI::App* sub : app.get_subcommands()) help += ' ' + sub->get_name();
    return fail(std::string(error.what()) + " (" + help + " --help says more)");
  } catch (const std::bad_alloc&) {
    return fail("there is not enough memory" + (progress::doing().empty() ? "" : " for " + progress::doing()));
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
