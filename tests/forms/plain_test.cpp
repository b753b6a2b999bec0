// SPDX-License-Identifier: BSD-3-Clause
// A traversal of one's own walks under every question, and changes no bit of any answer.
#include "forms/plain.hpp"
#include "support/catch.hpp"

namespace plain_test {

using namespace testing;

namespace {

/// Shows nothing: as if there were no primitive.
struct blind {
  template <clearance::hierarchy H, clearance::visitor Q>
  void operator()(const H&, vec3, Q&) const {}
};

}  // namespace

TEST_CASE("A traversal of one's own walks under every question, and changes no bit") {
  verdict v;
  for (const unsigned threads : {1u, 2u}) check_every_question(host{threads}, v);
}
TEST_CASE("Enqueued, too") {
  verdict v;
  check_enqueued(host{2}, v);
}
TEST_CASE("Images, clouds with radii, and helpers that ask several questions take it, too") {
  verdict v;
  check_what_is_made_of_questions(host{2}, v);
}

TEST_CASE("Nobody but the traversal that was given walks: one that shows nothing finds nothing") {
  moving_frames f(4, 81);
  const auto model = f.model();
  const auto& poses = f.s.poses;
  const plain on{host{2}, blind{}};
  const auto far = [](real d) { return !(d < clearance::infinity); };
  CHECK(std::ranges::all_of(ask(on, model, poses, f.here(), clearance::distances{}).distance, far));
  CHECK(std::ranges::all_of(ask(on, model, poses, f.here(), clearance::distances_per_part{}).distance, far));
  CHECK(ask(on, model, poses, f.here(), clearance::within{{0.5}}).pairs.empty());
  CHECK(ask(on, model, poses, f.here(), clearance::zones{.thresholds = {0.5}}).innermost() == 1);
  CHECK(ask(on, model, poses, f.here(), clearance::in_collision{{0.5}}).state == clearance::state::free);
  CHECK(ask(on, model, poses, f.here(), clearance::self_filter{.padding = {0.1}}).counts.own == 0);
  CHECK(ask(on, model, poses, f.here(), clearance::nearest_k{}).of(0)[0].part == 0);
  CHECK(ask(on, model, poses, f.here(), clearance::nearest_k{}).of(0)[0].cloud == clearance::none);
  CHECK(ask(on, model, poses, f.here(), clearance::min_distance{}).part == clearance::none);
}

TEST_CASE("A tree that is too deep for its stack is refused when a question is made, whatever is asked") {
  verdict v;
  ask_everything([&](const char* name, const auto& q, const auto& model, const moving_frames&) {
    std::string told;
    try {
      clearance::query prepared(plain{host{}, clearance::basic_stack<1>{}}, model, q);
    } catch (const std::invalid_argument& e) {
      told = e.what();
    }
    v.require(told.ends_with("entries, but this traversal has 1; give it a larger capacity or use the recursive one"),
              name, ": told ", told);
  });
}

}  // namespace plain_test
