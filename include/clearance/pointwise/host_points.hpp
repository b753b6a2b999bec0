// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Each point's own distance on the host.

#include <clearance/backend/host.hpp>
#include <clearance/frame/clouds.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/pointwise/host_groups.hpp>
#include <clearance/pointwise/host_packets.hpp>
#include <clearance/robot/model.hpp>

namespace clearance::pointwise {

/// A range of points, done by one thread: tile by tile, or in groups if the trees know their tangents.
template <class PartView, point_source Source>
struct host_points {
  using hierarchy_type = typename PartView::hierarchy_type;
  using packets = host_packets<PartView>;
  static constexpr bool by_tangents = scan::tangent_hierarchy<hierarchy_type>;
  static constexpr std::size_t most_together = 16384;  ///< Points among which groups are looked for.

  const PartView* parts;
  std::span<const frames::placement> places;
  std::uint64_t stack;  ///< Entries that a walk needs.
  Source source;
  vec3 origin;
  std::uint32_t first;  ///< Number of this cloud's first point among all clouds' points.
  scan::drop_counts* counts;
  distances_out out;
  real d_max;

  /// How many points one thread takes at a time: the more, the smaller is the space of a group.
  static std::size_t grain(const host& on, std::size_t points) {
    return by_tangents ? std::clamp<std::size_t>(points / (8 * on.concurrency()), 2048, most_together) : 1024;
  }

  void operator()(indices range) const {
    scan::drop_tally mine;
    packets m(parts, places, d_max, stack);
    if constexpr (by_tangents)
      in_groups(range, m, mine);
    else
      in_tiles(range, m, mine);
    mine.add_to(*counts);
  }

 private:
  void in_tiles(indices range, packets& m, scan::drop_tally& mine) const {
    scan::tile t;
    for (std::size_t i = range.begin; i < range.end; i += scan::tile_points) {
      const std::size_t count = load(t, i, range.end, mine);
      found best[scan::tile_points];
      with_vectors([&] {
        if (!m.look_around(box_of(t))) return;
        for (std::size_t j = 0; j < scan::tile_points; j += packets::together)
          m.ask(packets::together, [&](std::size_t l) { return t[j + l]; }, best + j);
      });
      for (std::size_t j = 0; j < count; ++j) put(i + j, packets::is_point(t[j]) ? best[j] : found{not_a_number});
    }
  }

  void in_groups(indices range, packets& m, scan::drop_tally& mine) const {
    host_groups<PartView> groups(m, parts, places, d_max);
    const auto take = [&](std::uint32_t number, const found& f) { put(number, f); };
    scan::tile t;
    std::size_t tiles = 0;
    for (std::size_t i = range.begin; i < range.end; i += scan::tile_points) {
      const std::size_t count = load(t, i, range.end, mine);
      bool near = false;
      with_vectors([&] {
        const extent box = box_of(t);
        for (const auto& place : places) near = near || scan::may_reach(place.around, d_max, box);
      });
      for (std::size_t j = 0; j < count; ++j) put(i + j, packets::is_point(t[j]) ? found{} : found{not_a_number});
      if (near) add(groups, t, i, count);
      if (++tiles % (most_together / scan::tile_points) == 0 || i + scan::tile_points >= range.end) groups.answer(take);
    }
  }

  /// A tile's points that may be near a part.
  void add(host_groups<PartView>& groups, const scan::tile& t, std::size_t begin, std::size_t count) const {
    const auto one = [&](std::size_t j) { groups.add(t[j], std::uint32_t(begin + j)); };
    if (d_max < infinity) {
      scan::tile_survivors survivors;
      for (const auto& place : places) survivors.add(t, place.around, d_max, 0);
      survivors.for_each([&](std::size_t j, std::uint32_t) { one(j); });
      return;
    }
    for (std::size_t j = 0; j < count; ++j)
      if (packets::is_point(t[j])) one(j);
  }
  std::size_t load(scan::tile& t, std::size_t begin, std::size_t end, scan::drop_tally& mine) const {
    const std::size_t count = std::min(scan::tile_points, end - begin);
    t.load(source, begin, count, 1, mine);
    t.subtract(origin);
    return count;
  }
  void put(std::size_t i, const found& f) const { write(out, first + i, f); }
};

/// All clouds of a frame. Returns how certain the distances are.
template <class PartView, class Clouds>
distance_certainty on_host(const host& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
                           const Clouds& clouds, const distances_out& out, real d_max, point_counts* counts) {
  scan::drop_counts dropped;
  frames::cloud_frame frame;
  const std::uint64_t seen = frames::for_each_turn(
      frame, model.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
        static_assert(points_alone<S>());
        using body = host_points<PartView, S>;
        on.for_ranges(source.size(),
                      body{model.parts, frame.places, stack_need(model.depth, model.width), source, frame.origin,
                           now.first, &dropped, out, d_max},
                      body::grain(on, source.size()));
      });
  scan::count(*counts, dropped.dropped, seen);
  return certainty_of(frame);
}

}  // namespace clearance::pointwise
