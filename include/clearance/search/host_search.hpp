// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/search/minimum_search.hpp>

namespace clearance {

/// The search on the CPU. Its memory and threads can be kept: `begin` starts the next frame with them, and with what
/// the last one found as a first bound, which changes how long a frame takes, and nothing else.
template <class PartView, class Traversal>
class minimum_search<host, PartView, Traversal> {
 public:
  minimum_search(const host& on, model_view<PartView> model, Traversal walk) : on_(on), model_(model), walk_(walk) {
    search::check_stack<Traversal>(model.depth, model.width);
  }
  minimum_search(const host& on, model_view<PartView> model, std::span<const Eigen::Isometry3d> poses, Traversal walk,
                 min_distance_result* result, part_minimum* minima = nullptr)
      : minimum_search(on, model, walk) {
    begin(poses, result, minima);
  }

  void begin(std::span<const Eigen::Isometry3d> poses, min_distance_result* result, part_minimum* minima = nullptr) {
    if (poses.size() != model_.size())
      throw std::invalid_argument("clearance::min_distance: there are " + std::to_string(model_.size()) +
                                  " parts, but " + std::to_string(poses.size()) + " poses");
    poses_.clear();
    for (std::size_t k = 0; k < poses.size(); ++k) poses_.push_back(rigid(poses[k], "part", std::int64_t(k)));
    result_ = result, minima_ = minima;
    *result = {};
    totals_ = {};
    part_best_.assign(minima == nullptr ? 0 : model_.size(), no_key);
    std::fill_n(minima, part_best_.size(), part_minimum{});
    clouds_ = 0, seen_ = 0, error_ = {};
  }

  /// Searches a cloud; they are numbered in this order.
  template <point_source S>
  void add(const S& source, const Eigen::Isometry3d& cloud_pose = Eigen::Isometry3d::Identity()) {
    const std::uint32_t cloud = clouds_++;
    const Eigen::Isometry3d world_from_cloud = rigid(cloud_pose, "cloud", cloud);
    const std::uint64_t n = source.size();
    if (seen_ + n >= none)
      throw std::invalid_argument("clearance::min_distance: more than 2^32 - 2 points in one call");
    frame_.put(model_.facts, poses_, world_transform(world_from_cloud), rounding_of(source));
    error_.widen(frame_.error);
    const auto parts = std::uint32_t(model_.size());
    const auto first = std::uint32_t(seen_);
    distance_key* const part_best = minima_ == nullptr ? nullptr : part_best_.data();
    using points = search::point_body<PartView, S, Traversal>;
    const points body{
        model_.parts, frame_.places.data(), parts, source, frame_.origin, first, &totals_, part_best, walk_};
    for (const witness& w : last_)
      if (w.cloud == cloud) recall(body, w.point);
    if (n >= 4 * sample_tiles * search::tile_points)
      search::sample_tiles(body, sample_tiles, [&](vec3 p, std::size_t i, std::uint32_t k) {
        search::seed_body<points>{body, 1}.descend(p, first + std::uint32_t(i), k);
      });
    workers_.for_pieces(n, piece, [&](std::size_t begin, std::size_t end) { body(indices{begin, end, 1}); });
    const search::resolve_body<PartView, S, Traversal> resolve{model_.parts,  frame_.places.data(),
                                                               parts,         source,
                                                               frame_.origin, world_transform(world_from_cloud),
                                                               first,         cloud,
                                                               &totals_,      part_best,
                                                               walk_,         result_,
                                                               minima_};
    for (std::uint32_t k = 0; k <= parts; ++k) resolve(k);
    seen_ += n;
  }

  /// The end: counts, bracket and state.
  void conclude() {
    search::conclude_body<PartView>{model_.parts, std::uint32_t(model_.size()),
                                    &totals_,     minima_ == nullptr ? nullptr : part_best_.data(),
                                    error_,       frame_.slop,
                                    seen_,        result_}(0);
    last_.clear();
    if (result_->part != none) last_.push_back({result_->cloud, result_->point});
    for (std::size_t k = 0; k < part_best_.size(); ++k)
      if (minima_[k].cloud != none && minima_[k].point != result_->point)
        last_.push_back({minima_[k].cloud, minima_[k].point});
  }

  /// Drops what is known of the last frame. The next one takes longer; its answer is the same.
  void forget() { last_.clear(); }

 private:
  static constexpr std::size_t piece = 4096, sample_tiles = 8;

  struct witness {
    std::uint32_t cloud, point;
  };

  /// Where the last frame's minimum was, and near it: some other pixel may see the place now.
  template <class Body>
  static void recall(const Body& body, std::size_t point) {
    for (const std::ptrdiff_t step : {0, -1, 1, -4, 4, -16, 16, -64, 64}) {
      const std::size_t i = point + std::size_t(step);
      if (i >= body.source.size()) continue;
      if (const sample s = body.source[i]; s.valid()) body.visit(s.position - body.origin, i);
    }
  }

  host on_;
  host_workers workers_{on_};
  model_view<PartView> model_;
  Traversal walk_;
  std::vector<Eigen::Isometry3d> poses_;
  search::cloud_frame frame_;
  search::totals totals_;
  std::vector<distance_key> part_best_;
  std::vector<witness> last_;
  min_distance_result* result_ = nullptr;
  part_minimum* minima_ = nullptr;
  std::uint32_t clouds_ = 0;
  std::uint64_t seen_ = 0;
  search::float_error error_;
};

}  // namespace clearance
