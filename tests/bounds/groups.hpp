// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The laws of what looks at several at once: volumes over volumes, tiles of capsules, points that lie together.

#include "bounds/laws.hpp"

#include <clearance/scan/tile_scan.hpp>
#include <clearance/scan/yardstick.hpp>

namespace bounds {

/// A volume around the balls of volumes, as layered trees have: its lower bound of what is computed (0).
template <class V, class P>
struct layered_law {
  static constexpr std::size_t content = pieces<P>::numbers, numbers = content + 3;
  using traits = clearance::bounding_volume_traits<V>;

  mutable pieces<P> of;
  mutable V volume;
  mutable std::array<float, content> made = {};

  void draw(std::array<float, numbers>& x, std::size_t from, chance& c) const {
    float size;
    vec3 middle;
    if (from == 0) pieces<P>::draw(x.data(), size, middle, c);
    draw_asked(x.data() + content, 3, x.data(), c);
  }
  room operator()(const std::array<float, numbers>& x) const {
    if (of.all.empty() || std::memcmp(made.data(), x.data(), sizeof made) != 0) {
      std::copy_n(x.begin(), content, made.begin());
      of.make(made.data());
      std::vector<ball> below;
      for (const P& p : of.all) {
        const auto its = p.balls();
        for (const ball& b : traits::balls(traits::fit(its))) below.push_back(b);
      }
      volume = traits::fit(below);
    }
    const vec3 q = vector_at(&x[content]);
    const double computed = double(of.computed(q)), scale = unit * (std::abs(computed) + of.size) + underflow;
    room r;
    r.add((computed - double(traits::lower_bound(volume, q))) / scale, 0);
    return r;
  }
};

/// Two capsules in a tile, before a part that is a sphere: the tile marks them (0), and the room that contains them
/// reaches the part (1), if they are within reach. Room that touches a box may touch it (2).
struct tile_law {
  static constexpr std::size_t content = 4, numbers = content + 14;
  using tile = clearance::scan::capsule_tile;

  void draw(std::array<float, numbers>& x, std::size_t from, chance& c) const {
    const float size = c.power(-20, 20);
    if (from == 0) about<inner_sphere>::draw(x.data(), somewhere(c, size), size, c);
    const float start[] = {0, 0, 0, size};
    for (std::size_t k = content; k < numbers; k += 7) {  // near the part, or near the origin
      draw_asked(x.data() + k, 3, c.below(2) == 0 ? start : x.data(), c);
      draw_near(x.data() + k + 3, 3, {0, 0, 0}, c.below(4) == 0 ? 0 : size * c.power(-12, 4), c);
      x[k + 6] = size * std::abs(c.number()) * c.power(-12, 0) * float(c.below(2));
    }
  }
  room operator()(const std::array<float, numbers>& x) const {
    const inner_sphere s = about<inner_sphere>::make(x.data());
    const ball around = clearance::enclosing_ball(s.balls());
    capsule both[2];
    tile t;
    for (std::size_t j = 0; j < tile::points; ++j) {
      const float* const its = &x[content + 7 * (j % 2)];
      both[j % 2] = {vector_at(its), vector_at(its + 3), std::abs(its[6])};
      t.put(j, both[j % 2]);
    }
    const clearance::scan::capsule_hull hull = t.hull();
    room r;
    for (std::size_t j = 0; j < 2; ++j) {
      const capsule& c = both[j];
      const real computed = clearance::distance_to(s, c);
      const double scale =
          unit * (reference::length(wider<double>(c.from)) + reference::length(wider<double>(c.along)) +
                  reference::length(wider<double>(s.center)) + double(s.radius) + double(c.radius)) +
          underflow;
      r.add(units_until(computed, scale,
                        [&](real reach) {
                          std::uint32_t near[tile::points] = {};
                          t.mark(around, reach, 1, near);
                          return near[j] != 0;
                        }),
            0);
      r.add(units_until(computed, scale, [&](real reach) { return hull.may_reach(around, reach); }), 1);
    }
    // A box that begins where the starts end, along every axis.
    clearance::extent box;
    box.add(hull.starts.upper), box.add(hull.starts.upper + vec3{s.radius, s.radius, s.radius});
    r.require(hull.may_touch(box, 0), 2);
    return r;
  }
};

/// Points that lie together, and one of them: what its distance is not below (0) nor above (2), as seen from their
/// middle, and the part's distance from that (1).
template <class P>
struct together_law {
  using by_poses = bracket_law<P>;
  static constexpr std::size_t content = by_poses::content, asked = by_poses::numbers, numbers = asked + 3;

  void draw(std::array<float, numbers>& x, std::size_t from, chance& c) const {
    std::array<float, asked> its;
    std::copy_n(x.begin(), asked, its.begin());
    by_poses{}.draw(its, from, c);
    if (c.below(4) == 0) {  // at the origin of the part's frame, which may be far from the part
      const auto p =
          by_poses::pose_of(&its[content + 10]).inverse() * by_poses::pose_of(&its[content + 3]).translation();
      for (int k = 0; k < 3; ++k) its[content + std::size_t(k)] = float(p[k]);
    }
    std::copy_n(its.begin(), asked, x.begin());
    draw_near(&x[asked], 3, {0, 0, 0}, c.power(-16, 2), c);
  }
  room operator()(const std::array<float, numbers>& x) const {
    namespace scan = clearance::scan;
    const P one = about<P>::make(x.data());
    const ball around = clearance::enclosing_ball(one.balls());
    const clearance::part_facts facts{around.center, around.radius, 0, 0};
    const Eigen::Isometry3d part = by_poses::pose_of(&x[content + 3]), cloud = by_poses::pose_of(&x[content + 10]);
    const clearance::frames::cloud_frame frame(std::span(&facts, 1), std::span(&part, 1), cloud);
    const auto& place = frame.places[0];
    room r;
    if (!(frame.error.at(0) < std::numeric_limits<double>::infinity())) return r;
    const vec3 middle = vector_at(&x[content]) - frame.origin, point = middle + vector_at(&x[asked]),
               e = point - middle;
    const real radius = clearance::rough_length(e) * (1 + clearance::slack);
    scan::surroundings all;
    all.middle = middle, all.half = {std::abs(e.x), std::abs(e.y), std::abs(e.z)}, all.noise = 0, all.radius = radius;
    const vec3 q = place.part_from_cloud(middle);
    const scan::seen_part seen(all, place.around, q);
    all.noise = clearance::max(all.noise, seen.noise);
    const clearance::primitive_tangent t = one.tangent_at(q);
    const vec3 way = scan::to_cloud(place.part_from_cloud, t.direction);
    const scan::yardstick best(t, way, radius);
    const double there = double(one.distance(place.part_from_cloud(point))),
                 scale = unit * (reference::length(wider<double>(middle)) + reference::length(wider<double>(q)) +
                                 reference::length(wider<double>(around.center)) + double(around.radius)) +
                         underflow,
                 scale_there = scale + unit * double(radius);
    const auto along = [&](vec3 u) { return reference::dot(wider<double>(u), wider<double>(e)); };
    r.add((there - (double(t.distance) + along(way) - double(all.noise))) / scale_there, 0);
    r.add((double(one.distance(q)) - double(seen.distance)) / scale, 1);
    r.add((double(best.most) + along(best.direction) + double(all.noise) - there) / scale_there, 2);
    return r;
  }
};

}  // namespace bounds
