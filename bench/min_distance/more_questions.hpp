// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions about one frame of 307,200 points that are waited for, wherever they run: prepared, and as one call, by the host's clock.
#include "configurations.hpp"

#include <clearance/distances_per_part.hpp>
#include <clearance/in_collision.hpp>
#include <clearance/min_support.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/within.hpp>
#include <clearance/zones.hpp>

#include <benchmark/benchmark.h>

namespace bench {

/// Asks once, as the first time takes memory, and then again and again; the last answer.
template <class Ask>
auto ask_often(benchmark::State& state, const Ask& ask) {
  auto found = ask();
  for (auto _ : state) found = ask();
  return found;
}

/// The scene's robot in motion, towards the table and back up: every part by its own way from one pose to another.
inline clearance::straight_motion some_motion() {
  const std::size_t parts = the_scene().poses.size();
  const auto path = trajectory(500);
  const auto at = [&](std::size_t c) { return std::span(path).subspan(c * parts, parts); };
  return {at(0), at(60)};
}

/// Calls `add(name, row)` for each question: `row(state, on, model, cloud)`, the model and the cloud there.
template <class Add>
void for_each_question(const Add& add) {
  const auto both = [&](const std::string& name, const auto& prepare, const auto& once, const auto& count, const auto&... how) {
    add(name + ", prepared", [=](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
      auto query = prepare(on, model);
      state.counters["found"] = double(count(ask_often(state, [&] { return query(the_scene().poses, cloud, how...); })));
    });
    add(name + ", one call", [=](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
      state.counters["found"] = double(count(ask_often(state, [&] { return once(on, model, the_scene().poses, cloud, how...); })));
    });
  };
  both("zones of 10, 20 and 40 cm", [](const auto& on, const auto& model) { return clearance::zones_query(on, model); },
       [](const auto&... all) { return clearance::zones(all...); },
       [](const auto& found) {
         std::uint64_t points = 0;
         for (std::size_t k = 0; k < found.zones.size() / found.per_part; ++k) points += found.of(k, found.per_part - 1).points;
         return points;
       },
       clearance::zones_options{.thresholds = {0.1, 0.2, 0.4}});
  both("within 10 cm", [](const auto& on, const auto& model) { return clearance::within_query(on, model); },
       [](const auto&... all) { return clearance::within(all...); }, [](const auto& found) { return found.pairs.size(); }, 0.1f);
  both("in_collision, 5 cm", [](const auto& on, const auto& model) { return clearance::in_collision_query(on, model); },
       [](const auto&... all) { return clearance::in_collision(all...); }, [](const auto& found) { return found.point != clearance::none; }, 0.05);
  const auto near = [](const auto& found) {
    return std::count_if(found.distance.begin(), found.distance.end(), [](float d) { return d < clearance::infinity; });
  };
  both("distances_per_part, 10 cm", [](const auto& on, const auto& model) { return clearance::distances_per_part_query(on, model); },
       [](const auto&... all) { return clearance::distances_per_part(all...); }, near, 0.1f);
  for (const std::size_t k : {10, 1000})
    both("nearest_k, " + std::to_string(k), [](const auto& on, const auto& model) { return clearance::nearest_k_query(on, model); },
         [](const auto&... all) { return clearance::nearest_k(all...); }, [](const auto& found) { return found.pairs.size(); }, k);
  both("min_distance_supported", [](const auto& on, const auto& model) { return clearance::min_distance_supported_query(on, model); },
       [](const auto&... all) { return clearance::min_distance_supported(all...); }, [](const auto& found) { return found.isolated; },
       clearance::support_options{});
  add("motion_clearance", [](benchmark::State& state, const auto& on, const auto& model, const auto& cloud) {
    clearance::min_distance_query query(on, model);
    const auto motion = some_motion();
    const auto found = ask_often(state, [&] { return clearance::motion_clearance(query, model, motion, cloud); });
    state.counters["queries"] = double(found.queries), state.counters["lower_mm"] = 1e3 * found.lower;
  });
}

}  // namespace bench
