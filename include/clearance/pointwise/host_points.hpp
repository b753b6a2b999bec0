// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Each point's own distance on the host.

#include <clearance/backends/host.hpp>
#include <clearance/cloud_tree/tree_view.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/frames/frame.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/pointwise/each_point.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/scan/group_walk.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/packet.hpp>
#include <clearance/scan/tile_scan.hpp>
#include <clearance/volume/sphere.hpp>

#include <span>
#include <utility>
#include <vector>

namespace clearance::pointwise {

// Points on the host whose walks ask the same nodes side by side: neighbours together, others alone.

/// What one thread keeps from packet to packet. Each starts with the primitive nearest to an earlier point as a bound.
template <class PartView>
class host_packets {
 public:
  static constexpr std::size_t together = 16;

  /// `stack`: entries that a walk needs.
  host_packets(const PartView* parts, std::span<const frames::placement> places, real d_max, std::uint64_t stack)
      : parts_(parts), places_(places), d_max_(d_max), pending_(stack) {}

  /// Parts within reach of points in a box, the nearest first, for what is asked next. Returns false if there are none.
  bool look_around(const extent& box) {
    near_.clear();
    if (box.lower.x > box.upper.x) return false;
    for (std::uint32_t k = 0; k < places_.size(); ++k)
      if (const ball& around = places_[k].around; scan::may_reach(around, d_max_, box))
        near_.emplace_back(length(fma(0.5f, box.lower + box.upper, -around.center)) - around.radius, k);
    std::sort(near_.begin(), near_.end());
    return !near_.empty();
  }
  const std::vector<std::pair<real, std::uint32_t>>& near() const { return near_; }

  /// `count` points, at most as many as walk together. `point(j)` may be NaN.
  template <class Point>
  void ask(std::size_t count, const Point& point, found* best) {
    std::size_t lead = 0;
    while (lead < count && !is_point(point(lead))) ++lead;
    if (lead == count) return;
    real widest = 0;  // square
    for (std::size_t j = lead; j < count; ++j) {
      const vec3 way = point(j) - point(lead);
      widest = max(widest, dot(way, way));
    }
    if (const real most = distance_ * 0.25f; count > 1 && widest <= most * most)
      ask<together>(count, point, lead, best);
    else
      for (std::size_t j = lead; j < count; ++j)
        if (is_point(point(j))) ask<1>(1, [&](std::size_t) { return point(j); }, 0, best + j);
  }

  static bool is_point(vec3 p) { return p.x == p.x; }

 private:
  using hierarchy_type = typename PartView::hierarchy_type;
  struct seed {
    std::uint32_t part = none;
    scan::primitive_place<hierarchy_type> where = {};
  };

  template <std::size_t Lanes, class Point>
  void ask(std::size_t count, const Point& point, std::size_t lead, found* best) {
    scan::packet<Lanes> all;
    for (std::size_t j = 0; j < Lanes; ++j) all.put(j, j < count ? point(j) : nowhere, d_max_);
    if (last_.part != none) {
      const auto& primitive = last_.where.in(parts_[last_.part].tree);
      for (std::size_t j = 0; j < Lanes; ++j)
        all.within[j] = min(d_max_, primitive.distance(places_[last_.part].part_from_cloud(all[j])));
    }
    for (const auto& [away, k] : near_) visit(k, all, lead, best);
    last_ = next_;
    if (is_point(all[count - 1])) distance_ = best[count - 1].distance;
  }

  /// Points against one part.
  template <std::size_t Lanes>
  void visit(std::uint32_t k, scan::packet<Lanes>& all, std::size_t lead, found* best) {
    const frames::placement& place = places_[k];
    std::uint32_t near[Lanes];
    if (!all.mark(sphere{place.around.center, place.around.radius}, near)) return;
    scan::walking_packet<hierarchy_type, Lanes> here;
    for (std::size_t j = 0; j < Lanes; ++j)
      here.put(j, place.part_from_cloud(all[j]), near[j] != 0 ? all.within[j] : -infinity);
    if constexpr (scan::has_interior<PartView>)
      for (std::size_t j = 0; j < Lanes; ++j)
        if (here.within[j] > -infinity && parts_[k].interior.inside(here[j])) {
          if (here.within[j] >= 0) {
            best[j].offer({0, k, none});
            all.within[j] = 0;
          }
          here.within[j] = -infinity;
        }
    here.walk(parts_[k].tree, lead, pending_.data());
    for (std::size_t j = 0; j < Lanes; ++j)
      if (here.best[j] != none) {
        best[j].offer({here.within[j], k, here.best[j]});
        if (best[j].part == k) next_ = {k, here.where[j]};
        all.within[j] = min(all.within[j], here.within[j]);
      }
  }

  static constexpr vec3 nowhere{not_a_number, not_a_number, not_a_number};

  const PartView* parts_;
  std::span<const frames::placement> places_;
  real d_max_;
  std::vector<near_first::entry_of<hierarchy_type>> pending_;
  std::vector<std::pair<real, std::uint32_t>> near_;  ///< Parts within reach, the nearest first.
  seed last_, next_;          ///< The primitive nearest to a point of the last packet, and of this one.
  real distance_ = infinity;  ///< The last point's.
};

// Points on the host that walk by tangents. A few thousand points that follow one another in a cloud are put in order
// along a curve through space, so that those near to one another become groups, whatever their order was: an image's
// rows are long and narrow.

/// What one thread keeps from group to group.
template <class PartView>
class host_groups {
 public:
  host_groups(host_packets<PartView>& packets, const PartView* parts, std::span<const frames::placement> places,
              real d_max)
      : packets_(packets), walk_(parts, places), d_max_(d_max) {}

  void add(vec3 p, std::uint32_t number) {
    points_.push_back({p, number});
    box_.add(p);
  }

  /// Finds what is nearest to each point that was added, and calls `take(number, found)`.
  template <class Take>
  void answer(const Take& take) {
    if (points_.empty()) return;
    if (packets_.look_around(box_)) {
      parts_.clear();
      for (const auto& [away, k] : packets_.near()) parts_.push_back(k);
      put_in_order();
      for (std::size_t i = 0; i < points_.size(); i += most) groups(i, std::min(most, points_.size() - i), take);
    } else {
      for (const auto& p : points_) take(p.number, found{});
    }
    points_.clear();
    box_ = {};
  }

 private:
  static constexpr std::size_t most = scan::neighbours::most;
  static constexpr std::size_t few = 4;  ///< So few points that do not lie together walk alone.
  struct coded {
    std::uint32_t code, at;
  };
  struct numbered {
    vec3 at;
    std::uint32_t number;
  };

  /// A group, or its halves if its points do not lie together.
  template <class Take>
  void groups(std::size_t begin, std::size_t count, const Take& take) {
    scan::neighbours near;
    for (std::size_t j = 0; j < count; ++j) near.add(points_[begin + j].at, d_max_);
    if (walk_.look_around(near, parts_)) {
      walk_.search(near, parts_);
      for (std::size_t j = 0; j < count; ++j)
        take(points_[begin + j].number,
             near.part[j] == none ? found{} : found{near.within[j], near.part[j], near.primitive[j]});
    } else if (count > few) {
      groups(begin, count / 2, take);
      groups(begin + count / 2, count - count / 2, take);
    } else {
      found best[few];
      with_vectors([&] { packets_.ask(count, [&](std::size_t j) { return points_[begin + j].at; }, best); });
      for (std::size_t j = 0; j < count; ++j) take(points_[begin + j].number, best[j]);
    }
  }

  void put_in_order() {
    if (points_.size() <= most) return;
    const cloud_tree::morton_grid grid(box_.lower, box_.upper);
    codes_.resize(points_.size());
    sorted_.resize(points_.size());
    with_vectors([&] {
      for (std::size_t i = 0; i < codes_.size(); ++i) codes_[i] = {grid(points_[i].at), std::uint32_t(i)};
    });
    constexpr int bits = cloud_tree::morton_grid::bits;
    for (int shift = 0; shift < 3 * bits; shift += bits) {
      std::uint32_t to[1 << bits] = {}, before = 0;
      const auto digit = [&](const coded& c) { return c.code >> shift & ((1 << bits) - 1); };
      for (const coded& c : codes_) ++to[digit(c)];
      for (std::uint32_t& t : to) before += std::exchange(t, before);
      for (const coded& c : codes_) sorted_[to[digit(c)]++] = c;
      codes_.swap(sorted_);
    }
    others_.clear();
    for (const coded& c : codes_) others_.push_back(points_[c.at]);
    points_.swap(others_);
  }

  host_packets<PartView>& packets_;
  scan::group_walk<PartView> walk_;
  real d_max_;
  std::vector<numbered> points_, others_;
  std::vector<coded> codes_, sorted_;
  std::vector<std::uint32_t> parts_;
  extent box_;
};

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
