// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance on the CPU, frame after frame. The last frame gives the next one its first bound.

#include <clearance/backends/host.hpp>
#include <clearance/minimum/plain_search.hpp>
#include <clearance/traversal/any_depth.hpp>

#include <algorithm>
#include <utility>

namespace clearance::minimum {

/// The least distance on the CPU, frame after frame. It keeps memory and threads. The last minima give the next frame a
/// first bound, which changes only how long it takes.
template <class PartView>
class host_search {
 public:
  host_search(const host& on, const model_view<PartView>& model)
      : workers_(on), model_(model), walk_{stack_need(model.depth, model.width)} {
    frames::extra_reaches(model.facts, extra_);
  }

  /// One frame; `minima`: one per part, or null. The clouds share one bound, and are numbered in their order.
  template <class Clouds>
  void operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, min_distance_result* result,
                  part_minimum* minima = nullptr) {
    *result = {};
    totals_ = {};
    counts_ = {};
    if (const real within = std::exchange(within_, infinity); within < infinity) totals_.best = make_key(within, none);
    const std::size_t each = minima == nullptr ? 0 : model_.size();
    const bool own = each != 0 || !extra_.empty();
    part_best_.assign(own ? model_.size() : 0, no_key);
    std::fill_n(minima, each, part_minimum{});
    const shared_bounds bounds{&totals_, own ? part_best_.data() : nullptr,
                               minima != nullptr || extra_.empty() ? nullptr : extra_.data()};
    const std::uint64_t seen = frames::for_each_turn(
        frame_, model_.facts, poses, clouds,
        [&](const auto& source, const frames::turn& now) { search(source, now, bounds, result, minima); });
    conclude_body<PartView>{
        model_.parts, std::uint32_t(model_.size()), &counts_, bounds, frame_.error, frame_.slop, seen, result}(0);
    last_.clear();
    if (result->part != none) last_.push_back({result->cloud, result->point});
    for (std::size_t k = 0; k < each; ++k)
      if (minima[k].cloud != none && minima[k].point != result->point)
        last_.push_back({minima[k].cloud, minima[k].point});
  }

  /// Drops what is known of the last frame. The next one takes longer; its answer is the same.
  void forget() {
    last_.clear();
    within_ = infinity;
  }

  /// The next frame alone, which must not ask for minima, need not find anything farther than `within`, unless it may
  /// decide what is certain.
  void bound_by(real within) { within_ = within; }

  std::size_t parts() const { return model_.size(); }

 private:
  static constexpr std::size_t sample_tiles = 8;

  struct seen_at {
    std::uint32_t cloud, point;
  };

  template <point_source S>
  void search(const S& source, const frames::turn& now, const shared_bounds& bounds, min_distance_result* result,
              part_minimum* minima) {
    const auto parts = std::uint32_t(model_.size());
    const std::size_t n = source.size();
    const scan::scan_body<PartView, S, any_depth, shared_bounds> body{
        model_.parts, frame_.places.data(), parts, source, frame_.origin, now.first, &counts_, bounds, walk_};
    for (const seen_at& w : last_)
      if (w.cloud == now.cloud) recall(body, w.point);
    if (n >= 4 * sample_tiles * scan::tile_points)
      scan::sample_tiles(body, sample_tiles, [&](vec3 p, std::size_t i, std::uint32_t k) {
        seed(body, p, now.first + std::uint32_t(i), k);
      });
    workers_.for_pieces(n, scan::piece_points,
                        [&](std::size_t begin, std::size_t end) { body(indices{begin, end, 1}); });
    shared_bounds found = bounds;
    totals pairs = totals_;
    if (bounds.extra != nullptr) {  // the nearest pair may be farther than what `bound_by` said
      pairs.best = *std::ranges::min_element(part_best_);
      found.all = &pairs;
    }
    const resolve_body<PartView, S, any_depth> resolve{model_.parts,  frame_.places.data(),
                                                       parts,         source,
                                                       frame_.origin, frame_.world_from_cloud,
                                                       now.first,     now.cloud,
                                                       found,         walk_,
                                                       result,        minima};
    for (std::uint32_t k = 0; k <= parts; ++k) resolve(k);
  }

  /// Tests the point of a last minimum and its neighbours: another pixel may see that place now.
  template <class Body>
  static void recall(const Body& body, std::size_t point) {
    for (const std::ptrdiff_t step : {0, -1, 1, -4, 4, -16, 16, -64, 64}) {
      const std::size_t i = point + std::size_t(step);
      if (i >= body.source.size()) continue;
      if (const sample s = body.source[i]; s.valid()) body.visit(s.position - body.origin, i);
    }
  }

  host_workers workers_;
  model_view<PartView> model_;
  any_depth walk_;
  frames::cloud_frame frame_;
  totals totals_;
  scan::drop_counts counts_;
  std::vector<distance_key> part_best_;
  std::vector<real> extra_;  ///< See extra_reaches.
  std::vector<seen_at> last_;
  real within_ = infinity;
};

}  // namespace clearance::minimum
