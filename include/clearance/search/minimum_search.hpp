// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/model.hpp>
#include <clearance/search/conclude.hpp>
#include <clearance/search/point_body.hpp>
#include <clearance/search/resolve.hpp>
#include <clearance/search/seed_body.hpp>

namespace clearance {

namespace search {

/// Refuses a tree that is too deep for the stack of a traversal; it would have to drop nodes.
template <class Traversal>
void check_stack(std::uint32_t depth, std::uint32_t width) {
  if constexpr (requires { Traversal::capacity; }) {
    const std::uint64_t need = width == 0 ? 1 : std::uint64_t(depth) * (width - 1) + 1;
    if (need > Traversal::capacity)
      throw std::invalid_argument("clearance: a tree of depth " + std::to_string(depth) + " and width " + std::to_string(width) + " needs a stack of " +
                                  std::to_string(need) + " entries, but this traversal has " + std::to_string(Traversal::capacity) +
                                  "; give it a larger capacity or use the recursive one");
  }
}

}  // namespace search

/// A point source and where it stands: world-from-source.
template <point_source S>
struct placed {
  S source;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};
// Said, because clang before 17 deduces nothing of an aggregate.
template <point_source S>
placed(S) -> placed<S>;
template <point_source S>
placed(S, Eigen::Isometry3d) -> placed<S>;

/// One search for the minimum distance over any number of clouds, of any kinds; all share one bound.
///
/// Everything is enqueued on the backend and nothing waits: `result` (and `minima`, one a part, if asked for) are in
/// memory that the backend can write, and are there once the backend has come so far. Clouds must live until then.
template <backend B, class PartView, class Traversal>
class minimum_search {
 public:
  minimum_search(const B& on, model_view<PartView> model, std::span<const Eigen::Isometry3d> poses, Traversal walk,
                 min_distance_result* result, part_minimum* minima = nullptr)
      : on_(on), model_(model), walk_(walk), result_(result), minima_(minima),
        totals_(on.template make_scratch<search::totals>(1)),
        part_best_(on.template make_scratch<distance_key>(minima == nullptr ? 0 : model.size())),
        places_(on.template make_scratch<search::placement>(0)) {
    if (poses.size() != model.size())
      throw std::invalid_argument("clearance::min_distance: there are " + std::to_string(model.size()) + " parts, but " +
                                  std::to_string(poses.size()) + " poses");
    for (std::size_t k = 0; k < poses.size(); ++k) poses_.push_back(rigid(poses[k], "part", std::int64_t(k)));
    search::check_stack<Traversal>(model.depth, model.width);
    if constexpr (requires { Traversal::device_stack(1); }) stack_bytes_ = Traversal::device_stack(model.depth);
    const search::totals start;
    on_.stage(std::span(&start, 1), totals_.data());
    const min_distance_result empty;
    on_.stage(std::span(&empty, 1), result);
    if (minima_ != nullptr) {
      on_.stage(std::span<const distance_key>(std::vector<distance_key>(model.size(), no_key)), part_best_.data());
      on_.stage(std::span<const part_minimum>(std::vector<part_minimum>(model.size())), minima_);
    }
  }

  /// Enqueues a cloud; they are numbered in this order.
  template <point_source S>
  void add(const S& source, const Eigen::Isometry3d& cloud_pose = Eigen::Isometry3d::Identity()) {
    const std::uint32_t cloud = clouds_++;
    const Eigen::Isometry3d world_from_cloud = rigid(cloud_pose, "cloud", cloud);
    const std::uint64_t n = source.size();
    if (seen_ + n >= none) throw std::invalid_argument("clearance::min_distance: more than 2^32 - 2 points in one call");
    const search::cloud_frame frame(model_.facts, poses_, world_from_cloud, rounding_of(source));
    error_.widen(frame.error);
    slop_ = frame.slop;
    places_ = on_.template make_scratch<search::placement>(model_.size());
    on_.stage(std::span<const search::placement>(frame.places), places_.data());
    const auto parts = std::uint32_t(model_.size());
    const auto first = std::uint32_t(seen_);
    distance_key* const part_best = minima_ == nullptr ? nullptr : part_best_.data();
    const search::point_body<PartView, S, Traversal> body{model_.parts, places_.data(), parts, source, frame.origin, first,
                                                          totals_.data(), part_best, walk_, stack_bytes_};
    using seeds = search::seed_body<search::point_body<PartView, S, Traversal>>;
    if (n > 4 * seeds::samples) on_.for_each(seeds::samples, seeds{body, std::size_t(n / seeds::samples)});
    on_.for_ranges(n, body);
    on_.for_each(parts + 1, search::resolve_body<PartView, S, Traversal>{
                                model_.parts, places_.data(), parts, source, frame.origin, world_transform(world_from_cloud), first, cloud,
                                totals_.data(), part_best, walk_, result_, minima_, stack_bytes_});
    seen_ += n;
  }

  /// Enqueues the end: counts, bracket and state.
  void conclude() {
    on_.for_each(1, search::conclude_body<PartView>{model_.parts, std::uint32_t(model_.size()), totals_.data(),
                                                    minima_ == nullptr ? nullptr : part_best_.data(), error_, slop_, seen_, result_});
  }

 private:
  template <class T>
  using scratch = typename B::template scratch<T>;

  B on_;
  model_view<PartView> model_;
  std::vector<Eigen::Isometry3d> poses_;
  Traversal walk_;
  min_distance_result* result_;
  part_minimum* minima_;
  scratch<search::totals> totals_;
  scratch<distance_key> part_best_;
  scratch<search::placement> places_;
  std::size_t stack_bytes_ = 0;
  std::uint32_t clouds_ = 0;
  std::uint64_t seen_ = 0;
  search::float_error error_;
  double slop_ = 0;
};

}  // namespace clearance
