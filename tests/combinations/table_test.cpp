// SPDX-License-Identifier: BSD-3-Clause
// The table of combinations has all questions, and the page has the table.
#include "combinations/table.hpp"
#include "support/catch.hpp"

#include <iostream>

namespace table_test {

using namespace combinations;

TEST_CASE("every question that a header declares is in the table") {
  std::set<std::string> names;
  for_each_question_type([&]<class Q>(const char* name) {
    static_assert(clearance::has_list<Q>, "a question of the library lists what it can: a misspelt member is missed");
    names.insert(name);
  });
  CHECK(names == declared_questions());
}

TEST_CASE("every question takes full balls where it takes the balls of uncertain points") {
  std::map<std::string, std::size_t> taken;
  for (const cell& c : all_cells())
    if (c.clouds == name_of<balls> || c.clouds == name_of<full_balls>)
      taken[c.question + c.poses + c.form + c.backend] += c.why == nullptr ? 1 : 0;
  for (const auto& [which, kinds] : taken) {
    INFO(which);
    CHECK(kinds != 1);
  }
}

TEST_CASE("docs/choosing.md has the table of combinations that the questions declare") {
  const std::string table = page_of(all_cells());
  INFO("the table is:\n" << table);
  CHECK(text_of(testing::checkout("docs/choosing.md")).find(table) != std::string::npos);
}

TEST_CASE("a cell is refused by a sentence, and for a reason that another cell does not have") {
  std::map<std::string, std::size_t> reasons;
  std::size_t asked = 0;
  for (const cell& c : all_cells())
    if (c.why == nullptr)
      ++asked;
    else
      ++reasons[c.why];
  CHECK(asked > 500);
  for (const auto& [why, count] : reasons) {
    INFO(why << " (" << count << " cells)");
    CHECK(why.size() > 40);
    CHECK(why.find_first_of("\"\n") == why.npos);
  }
  CHECK(reasons.size() >= 10);
}

TEST_CASE("prints the table of combinations as JSON", "[.][json]") { std::cout << json_of(all_cells()); }

}  // namespace table_test
