// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"

#include <clearance/visitor/any_within.hpp>
#include <clearance/visitor/nearest.hpp>

namespace visitors_test {

using namespace testing;
using clearance::any_within, clearance::nearest;

TEST_CASE("Nearest obeys the laws of visitors") {
  const auto same = [](auto a, auto b) { return same_bits(a.distance, b.distance) && a.primitive == b.primitive; };
  for (const real within : {infinity, 1.0f, 0.5f, 0.0f, -0.25f, -1.0f})
    check_visitor_laws(nearest{.within = within}, same);
}

TEST_CASE("Any-within obeys the laws of visitors") {
  const auto same = [](bool a, bool b) { return a == b; };
  for (const real margin : {infinity, 1.0f, 0.5f, 0.0f, -0.25f, -1.0f})
    check_visitor_laws(any_within{.margin = margin}, same);
}

TEST_CASE("Nearest takes the lowest id of equally near ones, and nothing beyond its limit") {
  nearest q{.within = 2};
  CHECK(q.result().primitive == nearest::none);
  q.offer(7, 2.5f);
  CHECK(q.result().primitive == nearest::none);
  q.offer(6, 2);
  CHECK(q.result().primitive == 6);
  q.offer(9, 1);
  q.offer(4, 1);
  q.offer(5, 1);
  CHECK(q.result().primitive == 4);
  CHECK(q.result().distance == 1);
  q.offer(0, clearance::not_a_number);
  CHECK(q.result().primitive == 4);
}

TEST_CASE("Any-within counts its margin, and then wants nothing more") {
  any_within q{.margin = 1};
  q.offer(0, std::nextafter(1.0f, 2.0f));
  q.offer(0, clearance::not_a_number);
  CHECK_FALSE(q.result());
  CHECK(q.reach() == 1);
  q.offer(0, 1);
  CHECK(q.result());
  CHECK(q.reach() == -infinity);
}

}  // namespace visitors_test
