// SPDX-License-Identifier: BSD-3-Clause
#include "option_table.hpp"

#include "command_line.hpp"

#include <CLI/CLI.hpp>

#include <span>

namespace {

/// The names that a rule's word stands for, of the options that are given.
std::vector<std::string> given_of(const CLI::App& app, std::string_view word) {
  std::vector<std::string> names;
  for (const declared_option& option : option_table) {
    if (option.name != word && !(word == doubts && option.is == option_is::doubt)) continue;
    const CLI::Option* known = app.get_option_no_throw(std::string(option.name));
    if (known && known->count() > 0) names.emplace_back(option.name);
  }
  return names;
}

bool is_any_given(const CLI::App& app, std::span<const std::string_view> names) {
  return std::ranges::any_of(names, [&](std::string_view name) { return !given_of(app, name).empty(); });
}

void check_needs(const CLI::App& app) {
  for (const need_rule& rule : need_rules) {
    const bool asked = rule.beside[0].empty() || is_any_given(app, rule.beside);
    if (asked && !given_of(app, rule.option).empty() && !is_any_given(app, rule.of))
      throw usage_error(std::string(rule.option), rule.why);
  }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> given_alike(const CLI::App& app) {
  std::vector<std::pair<std::string, std::string>> given;
  for (const declared_option& option : option_table) {
    if (option.is == option_is::course || option.is == option_is::file) continue;
    auto& [name, values] = given.emplace_back(option.name, "");
    const CLI::Option* known = app.get_option_no_throw(name);
    if (known && known->count() > 0)
      for (const std::string& value : known->results()) values += value + '\n';
  }
  return given;
}

std::vector<std::string> check_together(const CLI::App& app) {
  check_needs(app);
  std::vector<std::string> notes;
  for (const meeting_rule& rule : meeting_rules) {
    if (rule.how == meeting::changes) continue;
    const auto first = given_of(app, rule.first), second = given_of(app, rule.second);
    if (first.empty() || second.empty()) continue;
    if (!rule.beside.empty() && given_of(app, rule.beside).empty()) continue;
    const std::string beside = rule.beside.empty() ? "" : " and " + std::string(rule.beside);
    if (rule.how == meeting::refused)
      throw usage_error(first[0], "cannot be mixed with " + second[0] + beside + ": " + rule.why);
    for (const std::string& name : second) notes.push_back(first[0] + ": " + name + " is not in it: " + rule.why);
  }
  return notes;
}
