// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// All questions, and which forms each has, read from what it declares.

#include "solid/shapes.hpp"
#include "support/frames.hpp"
#include "support/same_answer.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/deadline.hpp>
#include <clearance/make_model.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/solid/mesh_solid.hpp>
#include <clearance/volume/aabb.hpp>

namespace testing {

template <class Q>
struct forms_of {
  static constexpr bool in_pieces = clearance::merging_question<Q> || clearance::joining_question<Q>;
  static constexpr bool enqueued = clearance::writing_question<Q> || requires { typename Q::searched; };
  static constexpr bool by_deadline = in_pieces && clearance::partial_question<Q>;
};

/// Asks a robot on a backend in each form after one call, in turn: prepared, twice; by a deadline that is far away; in
/// chunks, twice. Each has the bits of the host's one call about `model`, which is `expected`.
template <class On, class Robot, class Model, class Q>
void check_forms(const On& on, const Robot& robot, const Model& model, const Q& q, const moving_frames& f,
                 const typename Q::result& expected, verdict& v, const std::string& what) {
  clearance::query prepared(on, robot, q);
  v.require(same_answer(expected, typename Q::result(prepared(f.s.poses, f.here()))), what, ": prepared");
  v.require(same_answer(expected, typename Q::result(prepared(f.s.poses, f.here(), q))), what, ": asked again");
  if constexpr (forms_of<Q>::by_deadline) {
    auto known = ask_by(prepared, f.s.poses, f.here(), std::chrono::hours(1), q, {.piece = 999});
    v.require(known.unseen == 0 && same_answer(expected, known.result), what, ": by a deadline");
  }
  if constexpr (forms_of<Q>::in_pieces) {
    const auto cloud = clearance::point_span(f.points[0]);
    const auto of_one = ask(clearance::host{}, model, f.s.poses, cloud, f.here()[0].pose, q);
    clearance::chunked chunks(cloud, 4096);
    clearance::chunked_query by_chunks(on, robot, q);
    for (const char* time : {"first", "second"})
      v.require(same_answer(of_one, by_chunks(f.s.poses, chunks, f.here()[0].pose)), what, ": in chunks, the ", time,
                " time");
  }
}

/// Calls `f(name, question)` for each question about inner spheres.
template <class F>
void for_each_question(const F& f) {
  f("min_distance", clearance::min_distance{});
  f("min_distance_per_part", clearance::min_distance_per_part{});
  f("certain_distance", clearance::certain_distance{});
  f("min_distance_supported", clearance::min_distance_supported{.min_points = 2, .radius = 0.05});
  f("distances", clearance::distances{.d_max = 0.6, .which = true});
  f("distances_per_part", clearance::distances_per_part{.d_max = 0.5});
  f("in_collision", clearance::in_collision{{0.05}, {0.03}});
  f("within", clearance::within{{0.1}});
  f("nearest_k", clearance::nearest_k{.k = 7});
  f("zones", clearance::zones{.thresholds = {0.05, 0.2, 0.6}, .radii = {0.02}});
  f("self_filter", clearance::self_filter{.padding = {0.05}});
  f("min_distances", clearance::min_distances{.d_max = 0.3, .radii = {0.02}});
  f("min_distances_per_part", clearance::min_distances_per_part{.d_max = 0.3});
  f("in_collisions", clearance::in_collisions{{0.02}});
}
/// And those about closed meshes.
template <class F>
void for_each_question_of_meshes(const F& f) {
  f("signed_distances", clearance::signed_distances{.d_max = 0.6, .which = true});
}

/// A robot of closed boxes.
inline auto closed_boxes(std::size_t parts) {
  const auto box = shapes::box({0, 0, 0}, {0.2, 0.3, 0.25});
  const auto part = clearance::make_part<clearance::aabb>(clearance::close_mesh(box));
  return clearance::model(std::vector(parts, part));
}

/// Calls `f(name, question, made, frames)` for all of them, in each of some frames; `made` is what `make` makes of a
/// model.
template <class F, class Make = std::identity>
void ask_everything(const F& f, const Make& make = {}) {
  moving_frames frames(4, 77);
  const auto spheres = make(frames.model());
  const auto meshes = make(closed_boxes(4));
  for (; frames.there(); frames.next()) {
    for_each_question([&](const char* name, const auto& q) { f(name, q, spheres, frames); });
    for_each_question_of_meshes([&](const char* name, const auto& q) { f(name, q, meshes, frames); });
    f("min_distance", clearance::min_distance{}, meshes, frames);
    f("in_collision", clearance::in_collision{{0.02}}, meshes, frames);
    f("min_distances", clearance::min_distances{}, meshes, frames);
  }
}

/// The same robot with fields, with cells, or with both.
template <class Model>
Model with_near_maps(Model model, bool fields = true, bool cells = true) {
  if (fields) model = clearance::with_fields(clearance::host{}, std::move(model), {1 << 15}).model;
  if (cells) model = clearance::with_cells(clearance::host{}, std::move(model), {1 << 23, 0.3}).model;
  return model;
}
/// A robot, and the same one in all three ways.
template <class Model>
struct with_and_without {
  Model bare, mapped[3];

  explicit with_and_without(const Model& model)
      : bare(model), mapped{with_near_maps(model, true, false), with_near_maps(model, false), with_near_maps(model)} {}
};
/// Asks `once(robot, question, frames)` about robots with near maps and without: the answers must be the same bits.
template <class Once>
void check_near_maps_change_nothing(verdict& v, const Once& once) {
  std::size_t asked = 0;
  ask_everything(
      [&](const char* name, const auto& q, const auto& robots, const moving_frames& f) {
        const auto bare = once(robots.bare, q, f);
        for (int maps = 0; maps < 3; ++maps) {
          const auto view = robots.mapped[maps].view();
          v.require((view.fields != nullptr) == (maps != 1) && (view.cells != nullptr) == (maps != 0), name,
                    ": no map");
          v.require(same_answer(bare, once(robots.mapped[maps], q, f)), name, ", frame ", f.number, ": with maps ",
                    maps);
        }
        ++asked;
      },
      [](const auto& model) { return with_and_without(model); });
  v.require(asked == 6 * 18, asked, " questions");
}

}  // namespace testing
