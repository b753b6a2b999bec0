// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks a question about each kind of source in each form, and compares every answer with one that is composed by hand.

#include "combinations/enqueued.hpp"
#include "support/product.hpp"
#include "support/same_answer.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/deadline.hpp>
#include <clearance/volume/sphere.hpp>

namespace combinations {

using clearance::host;

/// Does an answer about points that may be elsewhere, but by nothing, say what one about points says? No point is
/// certainly anywhere.
template <class Result>
bool same_but_vague(Result vague, Result sure) {
  using clearance::state;
  const auto doubted = [](state& s) {
    if (s == state::collision) s = state::possible;
  };
  if constexpr (std::is_same_v<Result, clearance::collision_result>) {
    if (sure.state == state::collision)  // the first certain pair: the first possible one may be another
      vague.cloud = sure.cloud, vague.point = sure.point, vague.part = sure.part;
    doubted(sure.state);
  }
  if constexpr (std::is_same_v<Result, clearance::in_collisions_result>) std::ranges::for_each(sure.of, doubted);
  return same_answer(vague, sure);
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
    if constexpr (requires(Q its) { its.radii.clear(); }) check_radii();
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

  void same_vague(const result& vague, const result& sure, const std::string& what) {
    v_.require(same_but_vague(vague, sure), name_, ": ", what);
  }

  template <class S>
  void check_kind() {
    const result its = once(one<S>());
    if constexpr (std::is_same_v<S, image> && is_among<listed_samples>(kinds_asked()))
      same(its, once(one<listed_samples>()), "an image and its points");
    if constexpr (std::is_same_v<S, balls>) same_vague(its, once(one<points>()), "balls without a radius and points");
    if constexpr (std::is_same_v<S, uncertain_image>)
      same_vague(its, once(one<image>()), "an image that is not uncertain");
    if constexpr (std::is_same_v<S, uncertain_room>) same_vague(its, once(one<room>()), "a room that is not uncertain");
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
    constexpr bool enqueued = clearance::why_not<Q, decltype(all), form::enqueued>() == nullptr;
    static_assert(enqueued == (clearance::writing_question<Q> && !clearance::planning_question<Q>));
    if constexpr (enqueued)
      v_.require(writes_the_same(host{}, prepared, poses_, all, q_, expected, robot_.size(), count_points(all)), name_,
                 ": enqueued");
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

  /// Parts that may be elsewhere are parts whose surfaces are less well known.
  void check_radii() {
    Q bare = q_, wide = q_;
    const std::vector<double> radii{0.01, 0.03, 0.02};
    bare.radii = {}, wide.radii = radii;
    std::vector<std::remove_cvref_t<decltype(robot_.parts()[0])>> parts(robot_.parts().begin(), robot_.parts().end());
    for (std::size_t k = 0; k < parts.size(); ++k) parts[k].facts = clearance::widened(parts[k].facts, radii[k]);
    const clearance::model widened(parts);
    const auto all = before_.all(kinds_asked(), [](std::size_t) { return true; }, 0.02f);
    const auto of = [&](const auto& robot, const Q& q) { return result(ask(host{}, robot, poses_, all, q)); };
    same(of(robot_, wide), of(widened, bare), "radii of parts and tolerances");
    wide.radii = {0};
    same(of(robot_, wide), of(robot_, bare), "radii of parts that are 0");
  }

  const char* name_;
  Q q_;
  const Robot& robot_;
  std::vector<Eigen::Isometry3d> poses_;
  const scene_before_a_robot& before_;
  verdict v_;
};

/// About a robot of inner spheres, whose poses are those of so many configurations.
template <class Q>
void check_cells(const char* name, const Q& q, std::size_t configurations = 1) {
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  cells_of(name, q, robot, before.configurations(configurations), before).check();
}

}  // namespace combinations
