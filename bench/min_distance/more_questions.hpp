// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions about one frame of 307,200 points, on any backend, that wait for the answer: prepared, and in one call, by
// the host's clock.
#include "configurations.hpp"

#include <clearance/compacted.hpp>
#include <clearance/gradient.hpp>
#include <clearance/io/jacobian.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/robot/attached.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <benchmark/benchmark.h>

namespace bench {

/// Asks once to allocate memory, then again and again; returns the last answer.
template <class Ask>
auto ask_often(benchmark::State& state, const Ask& ask) {
  auto found = ask();
  for (auto _ : state) found = ask();
  return found;
}

/// The scene's robot moves to the table and up again: every part on its own way from one pose to another.
inline clearance::straight_motion some_motion() {
  const std::size_t parts = the_scene().poses.size();
  const auto path = trajectory(500);
  const auto at = [&](std::size_t c) { return std::span(path).subspan(c * parts, parts); };
  return {at(0), at(60)};
}

inline Eigen::Vector3d origin_of(std::size_t part) { return the_scene().poses[part].translation(); }

/// The cost of gradients, each to compare with its minimum. The least distance: with respect to the pose of its part,
/// and to the joints (only of the KUKA; its stand-in has none). Every part's: one more walk per part.
template <class Add>
void for_each_gradient(const Add& add) {
  add("min_distance, prepared", [](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
    clearance::query query(on, model, clearance::min_distance{});
    state.counters["mm"] = 1e3 * double(ask_often(state, [&] { return query(the_scene().poses, cloud); }).distance);
  });
  add("min_distance and its gradient, prepared",
      [](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
        clearance::query query(on, model, clearance::min_distance{});
        const auto found = ask_often(state, [&] {
          const auto least = query(the_scene().poses, cloud);
          return clearance::gradient(least, origin_of(least.part));
        });
        state.counters["known"] = bool(found);
      });
  add("min_distance and its gradient by joints, prepared",
      [](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
        if (the_scene().name != "kuka") return state.SkipWithError("no joints without the real data");
        const auto robot = load_kuka(CLEARANCE_TEST_DATA);
        clearance::query query(on, model, clearance::min_distance{});
        const auto found = ask_often(state, [&] {
          const auto least = query(the_scene().poses, cloud);
          return clearance::io::joint_gradient(robot, kuka_joints, least.part,
                                               clearance::gradient(least, origin_of(least.part)));
        });
        state.counters["known"] = bool(found);
      });
  add("min_distance_per_part, prepared", [](benchmark::State& state, const auto& on, const auto& model,
                                            const auto& cloud) {
    clearance::query query(on, model, clearance::min_distance_per_part{});
    state.counters["mm"] = 1e3 * double(ask_often(state, [&] { return query(the_scene().poses, cloud).all; }).distance);
  });
  add("min_distance_per_part and every part's gradient, prepared",
      [](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
        clearance::query query(on, model, clearance::min_distance_per_part{});
        clearance::query where(on, model, clearance::part_witnesses{});
        const auto found = ask_often(state, [&] {
          const auto& least = query(the_scene().poses, cloud);
          std::size_t known = 0;
          for (const auto& witness : where(the_scene().poses, cloud, clearance::part_witnesses{least.parts}))
            known += witness.part != clearance::none && clearance::gradient(witness, origin_of(witness.part));
          return known;
        });
        state.counters["known"] = double(found);
      });
}

/// A robot that holds something: attaching it, and the minimum of both, to compare with the robot's alone.
template <class Add>
void for_each_attached(const Add& add) {
  const auto held = [](const auto& on) {
    return clearance::make_model<clearance::sphere>(std::vector{the_scene().packings.back()}).on(on);
  };
  add("attach", [=](benchmark::State& state, const auto& on, const auto& model, const auto&) {
    const auto object = held(on);
    state.counters["parts"] = double(ask_often(state, [&] { return clearance::attach(on, model, object).size(); }));
  });
  add("min_distance with an attached object, prepared",
      [=](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
        const auto object = held(on);
        const auto holding = clearance::attach(on, model, object);
        auto poses = the_scene().poses;
        poses.push_back(poses.back() * Eigen::Translation3d(0, 0, 0.1));
        clearance::query query(on, holding, clearance::min_distance{});
        state.counters["mm"] = 1e3 * double(ask_often(state, [&] { return query(poses, cloud); }).distance);
      });
}

/// Calls `add(name, row)` for each question: `row(state, on, model, cloud)`, with model and cloud on the backend.
template <class Add>
void for_each_question(const Add& add) {
  const auto both = [&](const std::string& name, const auto& question, const auto& count) {
    add(name + ", prepared", [=](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
      clearance::query query(on, model, question);
      state.counters["found"] = double(count(ask_often(state, [&] { return query(the_scene().poses, cloud); })));
    });
    add(name + ", one call", [=](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
      state.counters["found"] = double(
          count(ask_often(state, [&] { return clearance::ask(on, model, the_scene().poses, cloud, question); })));
    });
  };
  both("zones of 10, 20 and 40 cm", clearance::zones{.thresholds = {0.1, 0.2, 0.4}}, [](const auto& found) {
    std::uint64_t points = 0;
    for (std::size_t k = 0; k < found.zones.size() / found.per_part; ++k)
      points += found.of(k, found.per_part - 1).points;
    return points;
  });
  const auto listed = [](const auto& found) { return found.pairs.size(); };
  both("within 10 cm", clearance::within{{0.1f}}, listed);
  both("in_collision, 5 cm", clearance::in_collision{{0.05}},
       [](const auto& found) { return found.point != clearance::none; });
  both("distances_per_part, 10 cm", clearance::distances_per_part{.d_max = 0.1f}, [](const auto& found) {
    return std::count_if(found.distance.begin(), found.distance.end(), [](float d) { return d < clearance::infinity; });
  });
  for (const std::size_t k : {10, 1000}) both("nearest_k, " + std::to_string(k), clearance::nearest_k{.k = k}, listed);
  both("min_distance_supported", clearance::min_distance_supported{}, [](const auto& found) { return found.isolated; });
  add("motion_clearance", [](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
    clearance::query query(on, model, clearance::min_distance_per_part{});
    const auto motion = some_motion();
    const auto found = ask_often(state, [&] { return clearance::motion_clearance(query, model, motion, cloud); });
    state.counters["queries"] = double(found.queries), state.counters["lower_mm"] = 1e3 * found.lower;
  });
  for_each_gradient(add);
  for_each_attached(add);
  // The robot's triangles; signed_distances, to compare with the distances that it computes first.
  const auto exact = [&](const char* name, const auto& question) {
    add(name, [=](benchmark::State& state, const auto& on, const auto&, const auto& cloud) {
      const auto triangles = triangle_model<clearance::aabb>(the_scene()).on(on);
      const auto found =
          ask_often(state, [&] { return clearance::ask(on, triangles, the_scene().poses, cloud, question); });
      state.counters["inside"] = double(std::ranges::count_if(found.distance, [](float d) { return d < 0; }));
    });
  };
  exact("distances to triangles, 10 cm", clearance::distances{.d_max = 0.1f});
  exact("signed_distances, 10 cm", clearance::signed_distances{.d_max = 0.1f});
  add("compacted", [](benchmark::State& state, const auto& on, const auto&, const auto& cloud) {
    state.counters["points"] =
        double(ask_often(state, [&] { return clearance::compacted(on, cloud.source); }).points.size());
  });
}

}  // namespace bench
