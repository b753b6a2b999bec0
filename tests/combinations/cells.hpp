// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks a question about each kind of source in each form, and compares every answer with one that is composed by hand.

#include "combinations/sources.hpp"
#include "support/product.hpp"
#include "support/same_answer.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/deadline.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/volume/sphere.hpp>

namespace combinations {

using clearance::host;

/// What a question about points says of points that may be elsewhere, but by nothing: no point is certainly anywhere.
template <class Result>
Result as_vague(Result r) {
  using clearance::state;
  const auto doubted = [](state& s) {
    if (s == state::collision) s = state::possible;
  };
  if constexpr (std::is_same_v<Result, clearance::collision_result>) doubted(r.state);
  if constexpr (std::is_same_v<Result, clearance::in_collisions_result>) std::ranges::for_each(r.of, doubted);
  return r;
}

/// The cells of one question about one robot.
template <class Q, class Robot>
class cells_of {
  using result = typename Q::result;
  using part_view = typename decltype(std::declval<const Robot&>().view())::part_type;
  using kinds_asked = asked_here<Q>;

 public:
  cells_of(const char* name, const Q& q, const Robot& robot, std::vector<Eigen::Isometry3d> poses,
           const scene_before_a_robot& before)
      : name_(name), q_(q), robot_(robot), poses_(std::move(poses)), before_(before) {}

  void check() {
    for_each_kind(kinds_asked(), [&]<class S>() { check_kind<S>(); });
    check_several();
    check_forms();
  }

 private:
  template <class Clouds>
  result once(const Clouds& clouds) const {
    return ask(host{}, robot_, poses_, clouds, q_);
  }
  template <class S>
  auto one(real radius = 0) const {
    clouds_of<kinds_asked> made;
    made.emplace_back(before_.template cloud<S>(true, radius));
    return made;
  }
  void same(const result& a, const result& b, const std::string& what) {
    v_.require(same_answer(a, b), name_, ": ", what);
  }

  template <class S>
  void check_kind() {
    const result its = once(one<S>());
    if constexpr (std::is_same_v<S, image> && is_among<listed_samples>(kinds_asked()))
      same(its, once(one<listed_samples>()), "an image and its points");
    if constexpr (std::is_same_v<S, balls>)
      same(its, as_vague(once(one<points>())), "balls without a radius and points");
    if constexpr (std::is_same_v<S, uncertain_image>)
      same(its, as_vague(once(one<image>())), "an image that is not uncertain");
    if constexpr (std::is_same_v<S, uncertain_room>)
      same(its, as_vague(once(one<room>())), "a room that is not uncertain");
  }

  void check_several() {
    const auto all = before_.all(kinds_asked(), [](std::size_t) { return true; }, 0.02f);
    const result whole = once(all);
    if constexpr (clearance::merging_question<Q> || clearance::joining_question<Q>) {
      clearance::detail::joined_of<Q, part_view> joined(q_, clearance::detail::facts_of(robot_));
      std::vector<std::uint32_t> first(all.size()), counts;
      for_each_cloud(all, [&](const auto& s, const auto&) { counts.push_back(std::uint32_t(s.size())); });
      for (std::size_t c = 0; c < all.size(); ++c) {
        std::vector<std::uint32_t> count(all.size());
        count[c] = counts[c];
        joined.add(
            once(before_.all(kinds_asked(), [c](std::size_t k) { return k == c; }, 0.02f)), {first, count, counts});
      }
      same(whole, joined.result(), "several clouds and each by itself");
    }
  }

  void check_forms() {
    const auto all = before_.all(kinds_asked(), [](std::size_t) { return true; }, 0.02f);
    const result expected = once(all);
    clearance::query prepared(host{2}, robot_, q_);
    for (int time = 0; time < 2; ++time) same(expected, prepared(poses_, all), "prepared");
    using by_deadline = asked_here<Q, form::by_deadline>;
    if constexpr (!std::is_same_v<by_deadline, kinds<>>) {
      const auto some = before_.all(by_deadline(), [](std::size_t) { return true; }, 0.02f);
      const auto known = ask_by(prepared, poses_, some, std::chrono::hours(1), q_, {.piece = 200});
      same(once(some), known.result, "by a deadline that is far away");
      v_.require(known.unseen == 0, name_, ": unseen points");
    }
    for_each_kind(asked_here<Q, form::in_chunks>(), [&]<class S>() {
      const auto cloud = before_.template cloud<S>(true, 0.02f);
      clearance::chunked chunks(cloud.source, 1);
      clearance::chunked_query in_chunks(host{}, robot_, q_);
      for (int time = 0; time < 2; ++time)
        same(once(one<S>(0.02f)), in_chunks(poses_, chunks, cloud.pose), std::string(name_of<S>) + " in chunks");
    });
  }

  const char* name_;
  Q q_;
  const Robot& robot_;
  std::vector<Eigen::Isometry3d> poses_;
  const scene_before_a_robot& before_;
  verdict v_;
};

template <class Q>
void check_cells(const char* name, const Q& q) {
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  cells_of(name, q, robot, before.s.poses, before).check();
}

}  // namespace combinations
