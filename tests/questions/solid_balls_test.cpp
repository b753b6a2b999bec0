// SPDX-License-Identifier: BSD-3-Clause
// Every question of balls takes full ones: without radii they are points, a cloud's gap is a gap of all parts, and in
// pieces they have the answer of one call.
#include "points/solid_balls_scenes.hpp"
#include "questions/uncertain_forms.hpp"

#include <clearance/motion_clearance.hpp>
#include <clearance/points/solid_balls.hpp>
#include <clearance/points/uncertain.hpp>

namespace solid_balls_questions_test {

using namespace testing;
using clearance::balls_of, clearance::chunked, clearance::host, clearance::placed, clearance::point_span,
    clearance::state;

namespace {

/// A wall of balls before the arm, of which some are large.
struct wall_of_full_balls {
  std::vector<vec3> points;
  std::vector<real> radii;

  explicit wall_of_full_balls(std::size_t n) : points(wall(n)) {
    dice d(29);
    radii = ball_radii_of(d, n, 0.6);
  }
  auto source(double gap = 0) const { return balls_of(points, radii, gap); }
};

/// The same robot, each of whose parts has `gap` more.
template <class Model>
Model with_gap(const Model& model, real gap) {
  auto parts = model.parts();
  for (auto& part : parts) part.facts.gap += gap;
  return Model(parts);
}

/// What a list says is certain of its pairs, and the rest of it.
template <class R>
auto of_pairs(const R& r) {
  if constexpr (requires { r.certain.lower(r.pairs[0]); }) {
    std::vector<real> lower;
    for (const auto& pair : r.pairs) lower.push_back(r.certain.lower(pair));
    return lower;
  } else {
    return 0;
  }
}

}  // namespace

TEST_CASE("Balls without radii are points, and their gap is a gap of all parts, for every question") {
  verdict v;
  const auto model = arm();
  const auto pose = shifted(0.1, 0, 0);
  const wall_of_full_balls w(6000);
  const std::vector<real> nothing(w.points.size());
  const real gap = 0.0625f;
  for_each_question_of_balls(arm_poses, [&]<class Q>(const char* name, const Q& q, const auto& poses) {
    v.require(same_answer(ask(host{}, model, poses, point_span(w.points), pose, q),
                          ask(host{}, model, poses, balls_of(w.points, nothing), pose, q)),
              name, ": balls without radii are not points");
    const auto lower = ask(host{}, model, poses, w.source(gap), pose, q),
               by_parts = ask(host{}, with_gap(model, gap), poses, w.source(), pose, q);
    if constexpr (std::is_same_v<Q, clearance::certain_distance>)
      v.require(std::abs(lower.lower - by_parts.lower) < 1e-5 && same_bits(lower.upper, by_parts.upper), name,
                ": a gap");
    else if constexpr (requires { lower.pairs; })
      v.require(of_pairs(lower) == of_pairs(by_parts) && lower.pairs.size() == by_parts.pairs.size(), name, ": a gap");
    else if constexpr (requires { lower.certain; })
      v.require(lower.certain.error.gap == gap, name, ": a gap");
    else
      v.require(same_answer(lower, by_parts), name, ": a gap");
  });
}

TEST_CASE("Full balls in slices, in pieces, in chunks and by a deadline have the answer of one call") {
  verdict v;
  const auto model = arm();
  const auto pose = shifted(0.1, 0, 0);
  for (const std::size_t n : {0, 3, 9000}) {
    const wall_of_full_balls w(n);
    const auto whole = w.source(0.01);
    std::vector<decltype(clearance::piece_of(whole, 0, 1))> pieces;
    for (std::size_t k = 0; k < 3; ++k) pieces.push_back(clearance::piece_of(whole, k, 3));
    const clearance::sharded again(pieces);
    static_assert(clearance::ball_source<std::remove_const_t<decltype(again)>> &&
                  !clearance::vague_source<std::remove_const_t<decltype(again)>>);
    chunked chunks(whole, 2000);
    for_each_question_of_balls(arm_poses, [&]<class Q>(const char* name, const Q& q, const auto& poses) {
      const auto expected = ask(host{}, model, poses, whole, pose, q);
      v.require(same_answer(expected, ask(host{}, model, poses, again, pose, q)), name, ": in pieces, ", n);
      clearance::chunked_query ask_it(host{}, model, q);
      chunks.forget();
      for (int round = 0; round < 2; ++round)
        v.require(same_answer(expected, ask_it(poses, chunks, pose)), name, ": in chunks, ", n);
      if constexpr (clearance::partial_question<Q>) {
        clearance::query query(host{}, model, q);
        v.require(
            same_answer(expected,
                        ask_by(query, poses, placed{whole, pose}, std::chrono::hours(1), q, {.piece = 999}).result),
            name, ": by a deadline, ", n);
      }
    });
  }
}

TEST_CASE("A motion towards a full ball has an upper end, and uncertain balls have none") {
  const auto model = arm();
  const std::vector<inner_sphere> balls{{{0, 0, 2}, 0.3f}};
  std::vector<Eigen::Isometry3d> to = arm_poses;
  for (auto& at : to) at = shifted(0, 0, 1) * at;
  const clearance::straight_motion motion(arm_poses, to);
  const auto full = motion_clearance(host{}, model, motion, balls_of(balls, 0.01));
  const auto end = ask(host{}, model, to, balls_of(balls, 0.01), clearance::min_distance{});
  CHECK((full.lower > 0 && full.lower <= end.lower && end.upper <= full.upper && full.upper < end.upper + 0.01));
  const clearance::uncertain may_be(balls_of(balls, 0.01));
  CHECK(motion_clearance(host{}, model, motion, may_be).upper == infinity);
}

}  // namespace solid_balls_questions_test
