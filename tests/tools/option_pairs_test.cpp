// SPDX-License-Identifier: BSD-3-Clause
// Every pair of options that change an answer, of `query`, `run` and `plan`: one is in what the other says, or is
// noted, or refused, as tools/option_table.hpp has it; else neither changes what the other says. And random lines.
#include "tools/asked_scene.hpp"

#include <random>
#include <set>

namespace option_pairs_test {

using namespace testing;

TEST_CASE("Every option of query, run, plan and self is declared in the table, once") {
  std::set<std::string_view> names;
  for (const declared_option& option : option_table) CHECK(names.insert(option.name).second);
  std::set<std::string> listed;
  for (const char* command : {"query", "run", "plan", "self"})
    for (const std::string& name : options_of(command)) {
      INFO(command << ' ' << name);
      CHECK(names.contains(name));
      listed.insert(name);
    }
  CHECK(listed.size() == names.size() - (listed.contains("--help") ? 0 : 1));
  for (const need_rule& rule : need_rules) {
    INFO(rule.option);
    CHECK((names.contains(rule.option) && !rule.of[0].empty()));
    for (const std::string_view one : rule.of) CHECK((one.empty() || names.contains(one)));
    for (const std::string_view one : rule.beside) CHECK((one.empty() || names.contains(one)));
  }
}

TEST_CASE("Of every two options, one is in what the other says, or is noted, or refused; or neither changes it") {
  const asked_scene s;
  std::map<std::string, std::size_t> met;
  std::map<std::string, bool> changes;  // of two options that are declared to: in some command
  for (const std::string command : {"query", "run", "plan"}) {
    std::map<std::string, outcome> known;
    const auto ask = [&](const std::string& base, const option_set& options) -> const outcome& {
      const std::string line = base + s.words(options, command);
      const auto [at, is_new] = known.try_emplace(line);
      if (is_new || options.contains("--distances")) at->second = run_command(line);
      return at->second;
    };
    std::vector<std::string> names;
    for (const std::string& name : options_of(command))
      if (is_question(name)) names.push_back(name);
    for (std::size_t i = 0; i < names.size(); ++i)
      for (std::size_t j = i + 1; j < names.size(); ++j) {
        const std::string &a = names[i], &b = names[j];
        const option_set its[] = {s.with(a, command), s.with(b, command)};
        option_set both = its[0];
        both.insert(its[1].begin(), its[1].end());
        INFO(command << ": " << a << " and " << b << ":" << s.words(both, command));
        if (const auto refused = rules_about(both, meeting::refused); !refused.empty()) {
          const outcome o = run_command(s.asks(command)[0] + s.words(both, command));
          INFO(o.err);
          CHECK((o.code == 1 && o.out.empty() && std::ranges::count(o.err, '\n') == 1));
          CHECK(std::ranges::any_of(refused, [&](const meeting_rule& rule) {
            return o.err.find("cannot be mixed with ") != o.err.npos && o.err.find(rule.why) != o.err.npos;
          }));
          ++met["refused"];
          continue;
        }
        const auto notes = rules_about(both, meeting::noted);
        const bool declared = std::ranges::any_of(meeting_rules, [&](const meeting_rule& rule) {
          return rule.how == meeting::changes && is_about(rule, a, b);
        });
        bool changed = false;
        for (const std::string& base : s.asks(command)) {
          const outcome together = ask(base, both);
          INFO(base << " said: " << together.err);
          REQUIRE((together.code != 1 && together.code != -1));
          for (const meeting_rule& rule : notes) CHECK(together.err.find(rule.why) != together.err.npos);
          const json said[] = {said_about(a, command, together, s), said_about(b, command, together, s)};
          for (int k : {0, 1}) {
            const std::string& name = k == 0 ? a : b;
            const outcome alone = ask(base, its[k]);
            INFO(name << " alone: " << alone.err);
            const json before = said_about(name, command, alone, s);
            if (!declared) CHECK(said[k] == before);
            changed = changed || said[k] != before;
          }
        }
        const bool one_needs_the_other = is_doubt(a) && is_doubt(b) && (both == its[0] || both == its[1]);
        if (declared && !one_needs_the_other) changes[std::min(a, b) + " and " + std::max(a, b)] |= changed;
        ++met[!notes.empty() ? "noted" : declared ? "changes" : "apart"];
      }
  }
  for (const auto& [pair, changed] : changes) {
    INFO(pair);
    CHECK(changed);
  }
  for (const char* how : {"refused", "noted", "changes", "apart"}) {
    INFO(how << ' ' << met[how]);
    CHECK(met[how] >= 10);
  }
}

TEST_CASE("Of random options none is without an effect that is told, noted or refused") {
  const asked_scene s;
  std::mt19937_64 dice(20261127);
  const auto roll = [&](std::size_t n) { return std::size_t(dice() % n); };
  std::map<int, std::size_t> codes;
  for (int round = 0; round < 200; ++round) {
    const std::string command = std::vector{"query", "run", "plan"}[roll(3)];
    std::vector<std::string> names;
    for (const declared_option& option : option_table)
      if (is_question(std::string(option.name)) && s.has(command, std::string(option.name)))
        names.emplace_back(option.name);
    std::shuffle(names.begin(), names.end(), dice);
    option_set given;
    std::vector<std::string> chosen(names.begin(), names.begin() + std::ptrdiff_t(std::min(names.size(), 1 + roll(5))));
    for (const std::string& name : chosen) {
      option_set its = s.with(name, command);
      if (roll(3) == 0)  // another value, which may be none
        for (auto& [option, value] : its)
          if (!value.empty())
            value = std::vector{"0", "0.3", "1e9", "-1", "nan", "0.2,0.1", "1,1,1", "3@1e3", "x"}[roll(9)];
      given.insert(its.begin(), its.end());
    }
    std::vector<std::string> asks = s.asks(command);
    const std::string line = asks[roll(asks.size())] + s.words(given, command);
    const outcome o = run_command(line);
    INFO("clearance " << line << " said: " << o.err);
    REQUIRE((o.code >= 0 && o.code <= 3));
    ++codes[o.code];
    CHECK((o.code == 1) == o.out.empty());
    if (o.code == 1) CHECK(std::ranges::count(o.err, '\n') == 1);
    std::istringstream notes(o.err);
    for (std::string each; std::getline(notes, each);) CHECK(each.size() <= 400);
    if (o.code == 1) continue;
    for (const std::string& name : chosen) {
      INFO(name);
      CHECK((name == "--merge" || !said_about(name, command, o, s).empty()));
    }
  }
  CHECK((codes[0] > 10 && codes[1] > 10 && codes[2] > 10));
}

}  // namespace option_pairs_test
