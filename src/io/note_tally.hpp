// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Collects what a reader has to tell its user, each kind of thing in one sentence.

#include <clearance/io/error.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace clearance::io {

/// Adds a sentence to notes, if it is not there.
inline void note_once(std::vector<std::string>& notes, const std::string& sentence) {
  if (std::ranges::find(notes, sentence) == notes.end()) notes.push_back(sentence);
}

/// What a reader skips or assumes about a file, to show to a user: one sentence per kind, however often it happened.
class note_tally {
 public:
  /// If `strict`, every note is thrown as a std::runtime_error that names `file`.
  explicit note_tally(std::string file = {}, bool strict = false) : file_(std::move(file)), strict_(strict) {}

  /// `who`: where it happened, such as link "arm". `what`: the rest, such as "has no collision geometry".
  void add(const std::string& what, const std::string& who, std::size_t line = 0) {
    if (strict_) refuse(file_, who + ": " + what, line);
    const auto known = std::ranges::find(kinds_, what, &kind::what);
    if (known == kinds_.end() && kinds_.size() == most_kinds) {
      ++more_;
      return;
    }
    kind& it = known == kinds_.end() ? kinds_.emplace_back(what) : *known;
    if (++it.count <= shown) it.who.push_back(who);
  }

  /// In the order of their first occurrence.
  std::vector<std::string> sentences() const {
    std::vector<std::string> all;
    for (const kind& each : kinds_) {
      std::string where;
      for (const std::string& who : each.who) where += (where.empty() ? "" : ", ") + sentence(who, 80);
      all.push_back(where + (each.count > shown ? ", ..." : "") + ": " + each.what +
                    (each.count > 1 ? " (" + std::to_string(each.count) + " times)" : ""));
    }
    if (more_ > 0) all.push_back("and " + std::to_string(more_) + " more of other kinds");
    return all;
  }

 private:
  static constexpr std::size_t shown = 3, most_kinds = 50;
  struct kind {
    std::string what;
    std::size_t count = 0;
    std::vector<std::string> who{};
  };
  std::string file_;
  bool strict_;
  std::vector<kind> kinds_;
  std::size_t more_ = 0;
};

}  // namespace clearance::io
