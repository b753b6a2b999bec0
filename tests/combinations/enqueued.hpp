// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where each question writes when it is enqueued, and what is read there, on any backend.

#include "combinations/questions.hpp"
#include "support/same_answer.hpp"

namespace combinations {

/// Enqueues, waits, and compares what was written with a result. `points`: of all clouds.
template <class On, class Query, class Q, class Clouds>
bool writes_the_same(const On& on, Query& query, const std::vector<Eigen::Isometry3d>& poses, const Clouds& clouds,
                     const Q& q, const typename Q::result& expected, std::size_t parts, std::size_t points) {
  using namespace clearance;
  auto counts = on.template make_scratch<point_counts>(1);
  const auto same = [&](const auto& written, const auto& wanted) {
    return same_answer(on.copy_out(written.data(), wanted.size()), wanted);
  };
  const auto same_counts = [&](const point_counts& wanted) {
    return same_answer(on.copy_out(counts.data(), 1)[0], wanted);
  };
  if constexpr (std::is_same_v<Q, min_distance> || std::is_same_v<Q, in_collision>) {
    auto written = on.template make_scratch<typename Q::result>(1);
    query.enqueue(poses, clouds, q, written.data());
    return same_answer(on.copy_out(written.data(), 1)[0], expected);
  } else if constexpr (std::is_same_v<Q, min_distance_per_part>) {
    auto written = on.template make_scratch<min_distance_result>(1);
    auto minima = on.template make_scratch<part_minimum>(parts);
    query.enqueue(poses, clouds, q, {written.data(), minima.data()});
    return same_answer(on.copy_out(written.data(), 1)[0], expected.all) && same(minima, expected.parts);
  } else if constexpr (std::is_same_v<Q, distances> || std::is_same_v<Q, signed_distances>) {
    auto distance = on.template make_scratch<real>(points);
    auto which = on.template make_scratch<std::uint32_t>(2 * points);
    query.enqueue(poses, clouds, q, {{distance.data(), which.data(), which.data() + points}, counts.data()});
    std::vector<std::uint32_t> both = expected.part;
    both.insert(both.end(), expected.primitive.begin(), expected.primitive.end());
    return same(distance, expected.distance) && same(which, both) && same_counts(expected.counts);
  } else if constexpr (std::is_same_v<Q, distances_per_part>) {
    auto distance = on.template make_scratch<real>(parts * points);
    query.enqueue(poses, clouds, q, {distance.data(), counts.data()});
    return same(distance, expected.distance) && same_counts(expected.counts);
  } else if constexpr (std::is_same_v<Q, within> || std::is_same_v<Q, nearest_k>) {
    auto pairs = on.template make_scratch<pair_distance>(parts * points);
    auto count = on.template make_scratch<unsigned long long>(1);
    query.enqueue(poses, clouds, q, {pairs.data(), parts * points, count.data(), counts.data()});
    within_result its;
    its.pairs = on.copy_out(pairs.data(), std::size_t(on.copy_out(count.data(), 1)[0]));
    pairwise::put_in_order(its, parts);
    if constexpr (std::is_same_v<Q, nearest_k>) {
      auto best = expected;
      pairwise::take_nearest(best, its);
      return same_answer(best.pairs, expected.pairs) && same_counts(expected.counts);
    } else {
      return same_answer(its.pairs, expected.pairs) && same_counts(expected.counts);
    }
  } else if constexpr (std::is_same_v<Q, zones>) {
    auto written = on.template make_scratch<zone>(expected.zones.size());
    query.enqueue(poses, clouds, q, {written.data(), counts.data()});
    return same(written, expected.zones) && same_counts(expected.counts);
  } else if constexpr (std::is_same_v<Q, self_filter>) {
    auto labels = on.template make_scratch<point_label>(points);
    auto own = on.template make_scratch<self_filter_counts>(1);
    query.enqueue(poses, clouds, q, {labels.data(), own.data()});
    return same(labels, expected.labels) && same_answer(on.copy_out(own.data(), 1)[0], expected.counts);
  } else if constexpr (std::is_same_v<Q, part_witnesses>) {
    auto minima = on.template make_scratch<part_minimum>(parts);
    auto written = on.template make_scratch<part_witness>(parts);
    on.stage(std::span<const part_minimum>(q.minima.begin(), parts), minima.data());
    query.enqueue(poses, clouds, q, {minima.data(), written.data()});
    return same(written, expected);
  } else {
    static_assert(sizeof(Q) == 0, "where does this question write?");
  }
}

}  // namespace combinations
