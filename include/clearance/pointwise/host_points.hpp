// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Each point's own distance on the host.

#include <clearance/backend/host.hpp>
#include <clearance/frame/clouds.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/pointwise/each_point.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/packet.hpp>
#include <clearance/scan/tile_scan.hpp>
#include <clearance/volume/sphere.hpp>

#include <span>
#include <utility>

namespace clearance::pointwise {

/// A range of points, done by one thread. Neighbours walk together if they are much closer to one another than to the
/// robot. Each starts with the primitive nearest to an earlier point as a bound.
template <class PartView, point_source Source>
struct host_points {
  using hierarchy_type = typename PartView::hierarchy_type;

  const PartView* parts;
  std::span<const frames::placement> places;
  std::uint64_t stack;  ///< Entries that a walk needs.
  Source source;
  vec3 origin;
  std::uint32_t first;  ///< Number of this cloud's first point among all clouds' points.
  scan::drop_counts* counts;
  distances_out out;
  real d_max;

  void operator()(indices range) const {
    scan::drop_tally mine;
    scan::tile t;
    memory m;
    m.pending.resize(stack);
    for (std::size_t i = range.begin; i < range.end; i += scan::tile_points) {
      const std::size_t count = std::min(scan::tile_points, range.end - i);
      t.load(source, i, count, 1, mine);
      t.subtract(origin);
      found best[scan::tile_points];
      with_vectors([&] { look(t, m, best); });
      for (std::size_t j = 0; j < count; ++j) write(out, first + i + j, is_point(t[j]) ? best[j] : found{not_a_number});
    }
    mine.add_to(*counts);
  }

 private:
  static constexpr std::size_t together = 16;

  struct seed {
    std::uint32_t part = none;
    scan::primitive_place<hierarchy_type> where = {};
  };
  struct memory {
    std::vector<near_first::entry_of<hierarchy_type>> pending;
    std::vector<std::pair<real, std::uint32_t>> near;  ///< Parts within reach of a tile, nearest first.
    seed last, next;           ///< The primitive nearest to a point of the last packet, and of this one.
    real distance = infinity;  ///< The last point's.
  };

  static bool is_point(vec3 p) { return p.x == p.x; }

  void look(const scan::tile& t, memory& m, found* best) const {
    const extent box = box_of(t);
    if (box.lower.x > box.upper.x) return;
    m.near.clear();
    for (std::uint32_t k = 0; k < places.size(); ++k)
      if (const ball& around = places[k].around; scan::may_reach(around, d_max, box))
        m.near.emplace_back(length(fma(0.5f, box.lower + box.upper, -around.center)) - around.radius, k);
    if (m.near.empty()) return;
    std::sort(m.near.begin(), m.near.end());
    for (std::size_t i = 0; i < scan::tile_points; i += together) {
      std::size_t lead = 0;
      while (lead < together && !is_point(t[i + lead])) ++lead;
      if (lead == together) continue;
      real widest = 0;  // square
      for (std::size_t j = lead; j < together; ++j) {
        const vec3 way = t[i + j] - t[i + lead];
        widest = max(widest, dot(way, way));
      }
      if (const real most = m.distance * 0.25f; widest <= most * most)
        ask<together>(t, i, lead, m, best);
      else
        for (std::size_t j = lead; j < together; ++j)
          if (is_point(t[i + j])) ask<1>(t, i + j, 0, m, best);
    }
  }

  /// The points from `begin` on.
  template <std::size_t Lanes>
  void ask(const scan::tile& t, std::size_t begin, std::size_t lead, memory& m, found* best) const {
    scan::packet<Lanes> all;
    for (std::size_t j = 0; j < Lanes; ++j) all.put(j, t[begin + j], d_max);
    if (m.last.part != none) {
      const auto& primitive = m.last.where.in(parts[m.last.part].tree);
      for (std::size_t j = 0; j < Lanes; ++j)
        all.within[j] = min(d_max, primitive.distance(places[m.last.part].part_from_cloud(all[j])));
    }
    for (const auto& [away, k] : m.near) visit(k, all, lead, m, best + begin);
    m.last = m.next;
    if (is_point(all[Lanes - 1])) m.distance = best[begin + Lanes - 1].distance;
  }

  /// Points against one part.
  template <std::size_t Lanes>
  void visit(std::uint32_t k, scan::packet<Lanes>& all, std::size_t lead, memory& m, found* best) const {
    const frames::placement& place = places[k];
    std::uint32_t near[Lanes];
    if (!all.mark(sphere{place.around.center, place.around.radius}, near)) return;
    scan::walking_packet<hierarchy_type, Lanes> here;
    for (std::size_t j = 0; j < Lanes; ++j)
      here.put(j, place.part_from_cloud(all[j]), near[j] != 0 ? all.within[j] : -infinity);
    if constexpr (scan::has_interior<PartView>)
      for (std::size_t j = 0; j < Lanes; ++j)
        if (here.within[j] > -infinity && parts[k].interior.inside(here[j])) {
          if (here.within[j] >= 0) best[j].offer({0, k, none}), all.within[j] = 0;
          here.within[j] = -infinity;
        }
    here.walk(parts[k].tree, lead, m.pending.data());
    for (std::size_t j = 0; j < Lanes; ++j)
      if (here.best[j] != none) {
        best[j].offer({here.within[j], k, here.best[j]});
        if (best[j].part == k) m.next = {k, here.where[j]};
        all.within[j] = min(all.within[j], here.within[j]);
      }
  }
};

/// All clouds of a frame. Returns how certain the distances are.
template <class PartView, class Clouds>
distance_certainty on_host(const host& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
                           const Clouds& clouds, const distances_out& out, real d_max, point_counts* counts) {
  scan::drop_counts dropped;
  frames::cloud_frame frame;
  const std::uint64_t seen = frames::for_each_turn(
      frame, model.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
        on.for_ranges(source.size(),
                      host_points<PartView, S>{model.parts, frame.places, stack_need(model.depth, model.width), source,
                                               frame.origin, now.first, &dropped, out, d_max});
      });
  scan::count(*counts, dropped.dropped, seen);
  return certainty_of(frame);
}

}  // namespace clearance::pointwise
