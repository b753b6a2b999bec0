// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Tests a range of points against every part on the host. `Body` is a scan_body: it has the parts' places, the answer,
// and the exact visit for the few points that are left.

#include <clearance/frames/root_test.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/points/tile.hpp>
#include <clearance/scan/drops.hpp>
#include <clearance/scan/element.hpp>

#include <algorithm>

namespace clearance::scan {

// How the host reads a cloud: first only the box around a hundred points, in loops that compilers turn into vector code
// on every processor. Single coordinates are read only if a part may be near.

inline constexpr std::size_t tile_points = surveyed_points;
inline constexpr std::size_t piece_points = 32 * tile_points;  ///< What one thread takes at a time.

/// The points of a tile, less the search's origin. An invalid point is NaN and fails every comparison.
struct tile : point_tile {
  /// Loads `count` points: begin, begin + stride, ...; counts dropped ones.
  template <point_source S>
  void load(const S& source, std::size_t begin, std::size_t count, std::size_t stride, drop_tally& mine) {
    read(source, begin, count, stride, mine.dropped);
  }
  void subtract(vec3 origin) {
    if (origin == vec3{0, 0, 0}) return;
    for (std::size_t j = 0; j < tile_points; ++j) {
      x[j] -= origin.x;
      y[j] -= origin.y;
      z[j] -= origin.z;
    }
  }
};

/// The box around points that are already loaded.
inline extent box_of(const tile& t) {
  extent box;
  spread(t.x, box.lower.x, box.upper.x);
  spread(t.y, box.lower.y, box.upper.y);
  spread(t.z, box.lower.z, box.upper.z);
  return box;
}

// How the host reads a source whose points stand for capsules: tile by tile, as points.

/// Room that contains capsules: their starts are in one box, their ends in the other, and they are at most so wide.
struct capsule_hull {
  extent starts, ends;
  real wide = 0;

  bool empty() const { return !(starts.lower.x <= starts.upper.x); }
  /// Less an origin.
  void subtract(vec3 origin) {
    if (origin == vec3{0, 0, 0}) return;
    for (extent* box : {&starts, &ends}) {
      box->lower = box->lower - origin;
      box->upper = box->upper - origin;
    }
  }
  /// May any of them touch a box? There must be a share of the way at which the box between starts and ends overlaps it
  /// along every axis. Up to rounding.
  bool may_touch(const extent& box, real beside) const {
    real low = 0, high = 1;
    const auto keep = [&](real at_start, real at_end) {  // shares at which at_start + share (at_end - at_start) >= 0
      constexpr real more = 8 * slack;
      if (at_start < 0) at_end >= 0 ? low = std::max(low, at_start / (at_start - at_end) - more) : high = -1;
      if (at_start >= 0 && at_end < 0) high = std::min(high, at_start / (at_start - at_end) + more);
    };
    const auto axis = [&](real lower, real upper, real sl, real su, real el, real eu) {
      const real off = beside + slack * (absolute(lower) + absolute(upper) + absolute(sl) + absolute(su) +
                                         absolute(el) + absolute(eu));
      keep(upper + off - sl, upper + off - el);
      keep(su - lower + off, eu - lower + off);
    };
    axis(box.lower.x, box.upper.x, starts.lower.x, starts.upper.x, ends.lower.x, ends.upper.x);
    axis(box.lower.y, box.upper.y, starts.lower.y, starts.upper.y, ends.lower.y, ends.upper.y);
    axis(box.lower.z, box.upper.z, starts.lower.z, starts.upper.z, ends.lower.z, ends.upper.z);
    return low <= high;
  }
  bool may_reach(const ball& around, real reach) const {
    const real most = frames::limit(around, reach + wide);
    const vec3 c = around.center, r{most, most, most};
    return most >= 0 && !behind(c, most) && may_touch({c - r, c + r}, 0);
  }
  /// Do all begin so far from a place and lead away from it? A plane between it and both boxes says so. Up to rounding.
  bool behind(vec3 c, real most) const {
    using clearance::detail::size_of;
    const auto beyond = [](real low, real high, real at) { return low > at ? low - at : high < at ? high - at : 0; };
    const vec3 way{beyond(starts.lower.x, starts.upper.x, c.x), beyond(starts.lower.y, starts.upper.y, c.y),
                   beyond(starts.lower.z, starts.upper.z, c.z)};
    const auto nearest = [](real along, real low, real high) { return along * (along > 0 ? low : high); };
    const auto away = [&](const extent& box) {
      return nearest(way.x, box.lower.x - c.x, box.upper.x - c.x) +
             nearest(way.y, box.lower.y - c.y, box.upper.y - c.y) +
             nearest(way.z, box.lower.z - c.z, box.upper.z - c.z);
    };
    const real square = dot(way, way), least = min(square, away(ends));
    const real limit = most + 8 * slack * (size_of(c) + size_of(ends.lower) + size_of(ends.upper));
    return least > 0 && least * least > limit * limit * square;
  }
};

/// The capsules of a tile, less the search's origin. That of an invalid point is NaN and fails every comparison.
class capsule_tile {
 public:
  static constexpr std::size_t points = surveyed_points;

  void put(std::size_t j, const capsule& c) {
    const real square = dot(c.along, c.along);
    starts_.put(j, c.from);
    ends_.put(j, c.at(1));
    along_.put(j, c.along);
    inverse_[j] = square > 0 ? 1 / square : 0;
    wide_[j] = c.radius + detail::noise_along(c);
  }
  capsule_hull hull() const {
    capsule_hull around{starts_.box(), ends_.box()};
    for (std::size_t j = 0; j < points; ++j) around.wide = wide_[j] > around.wide ? wide_[j] : around.wide;
    return around;
  }
  vec3 start(std::size_t j) const { return starts_[j]; }

  /// Marks those that may be within reach of a ball.
  void mark(const ball& around, real reach, std::uint32_t bit, std::uint32_t* near) const {
    const real most = reach + around.radius;
    const vec3 c = around.center;
    for (std::size_t j = 0; j < points; ++j) {
      const real x = c.x - starts_.x[j], y = c.y - starts_.y[j], z = c.z - starts_.z[j];
      const real share = (x * along_.x[j] + y * along_.y[j] + z * along_.z[j]) * inverse_[j];
      const real t = min(max(share, 0), 1);
      const real dx = x - t * along_.x[j], dy = y - t * along_.y[j], dz = z - t * along_.z[j];
      const real limit = (most + wide_[j]) * (1 + 4 * slack);
      near[j] |= bool(int(limit >= 0) & int(dx * dx + dy * dy + dz * dz <= limit * limit)) ? bit : 0;
    }
  }

 private:
  struct places {
    alignas(64) real x[points], y[points], z[points];

    void put(std::size_t j, vec3 p) {
      x[j] = p.x;
      y[j] = p.y;
      z[j] = p.z;
    }
    vec3 operator[](std::size_t j) const { return {x[j], y[j], z[j]}; }
    extent box() const {
      extent b;
      spread(x, b.lower.x, b.upper.x);
      spread(y, b.lower.y, b.upper.y);
      spread(z, b.lower.z, b.upper.z);
      return b;
    }
  };

  places starts_, ends_, along_;
  alignas(64) real inverse_[points], wide_[points];
};

/// Tests points begin .. end - 1 of a source whose points stand for capsules. `near`: a box around all that is within
/// reach of some part. `survivors`: those of a tile.
template <class Survivors, class Body>
void scan_capsules(const Body& body, std::size_t begin, std::size_t end, const extent& near, drop_tally& mine) {
  for (std::size_t i = begin; i < end; i += capsule_tile::points) {
    capsule_hull hull;
    const auto counted = [&] {
      if constexpr (surveyed_capsules<decltype(body.source)>)
        return i + capsule_tile::points <= end &&
               body.source.survey_capsules(i, hull.starts, hull.ends, hull.wide, mine.dropped);
      return false;
    }();
    const auto may_reach_some = [&] {
      for (std::uint32_t k = 0; k < body.part_count; ++k)
        if (hull.may_reach(body.places[k].around, body.answer.reach(k))) return true;
      return false;
    };

    hull.subtract(body.origin);
    // The box knows no part whose reach is below minus its size.
    const bool beside = hull.wide == 0 && !hull.may_touch(near, 0);
    if (counted && (hull.empty() || beside || !may_reach_some())) continue;

    tile points;  // read apart: in vector code a product in a position may be fused with what follows
    drop_tally again;
    points.load(body.source, i, std::min(capsule_tile::points, end - i), 1, counted ? again : mine);
    points.subtract(body.origin);
    capsule_tile t;
    with_vectors([&] {
      for (std::size_t j = 0; j < capsule_tile::points; ++j)
        t.put(j, points.x[j] == points.x[j] ? body.element(points[j], i + j) : capsule{points[j], {0, 0, 0}, 0});
      hull = t.hull();
    });

    Survivors survivors;
    bool any = false;
    for (std::uint32_t k = 0; k < body.part_count; ++k)
      if (const ball& around = body.places[k].around; hull.may_reach(around, body.answer.reach(k))) {
        any = true;
        survivors.add(t, around, body.answer.reach(k), k);
      }
    if (any)
      with_vectors([&] {
        survivors.for_each([&](std::size_t j, std::uint32_t parts) { body.visit(t.start(j), i + j, parts); });
      });
  }
}

namespace detail {

inline void mark_here(const tile& t, vec3 c, real most, std::uint32_t bit, std::uint32_t* near) {
  for (std::size_t j = 0; j < tile_points; ++j) {
    const real dx = t.x[j] - c.x, dy = t.y[j] - c.y, dz = t.z[j] - c.z;
    near[j] |= dx * dx + dy * dy + dz * dz <= most ? bit : 0;
  }
}
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__)
__attribute__((target("avx2"), flatten)) inline void mark_avx2(const tile& t, vec3 c, real most, std::uint32_t bit,
                                                               std::uint32_t* near) {
  mark_here(t, c, most, bit, near);
}
inline void mark(const tile& t, vec3 c, real most, std::uint32_t bit, std::uint32_t* near) {
  __builtin_cpu_supports("avx2") ? mark_avx2(t, c, most, bit, near) : mark_here(t, c, most, bit, near);
}
#else
inline void mark(const tile& t, vec3 c, real most, std::uint32_t bit, std::uint32_t* near) {
  mark_here(t, c, most, bit, near);
}
#endif

}  // namespace detail

/// Which points of a tile may be within reach of which parts: bit k % 32 of a point stands for part k.
class tile_survivors {
 public:
  /// Conservative, like `may_reach`. A reach below 0 may leave no point at all.
  void add(const tile& t, const ball& around, real reach, std::uint32_t part) {
    const real most = frames::limit(around, reach);
    if (most >= 0) detail::mark(t, around.center, most * most, 1u << part % 32, near_);
  }
  void add(const capsule_tile& t, const ball& around, real reach, std::uint32_t part) {
    with_vectors([&] { t.mark(around, reach, 1u << part % 32, near_); });
  }
  /// visit(point of the tile, bits of parts)
  template <class Visit>
  void for_each(Visit visit) const {
    constexpr std::size_t group = 16;
    for (std::size_t i = 0; i < tile_points; i += group) {
      std::uint32_t any = 0;
      for (std::size_t j = 0; j < group; ++j) any |= near_[i + j];
      for (std::size_t j = 0; any != 0 && j < group; ++j)
        if (near_[i + j] != 0) visit(i + j, near_[i + j]);
    }
  }

 private:
  alignas(64) std::uint32_t near_[tile_points] = {};
};

using frames::may_reach;

/// Is a box within reach of a ball, up to rounding?
inline bool may_reach(const ball& around, real reach, const extent& box) {
  const auto beyond = [](real low, real high, real c) { return max(max(low - c, c - high), 0); };
  const vec3 c = around.center;
  const real dx = beyond(box.lower.x, box.upper.x, c.x), dy = beyond(box.lower.y, box.upper.y, c.y),
             dz = beyond(box.lower.z, box.upper.z, c.z);
  const real limit = frames::limit(around, reach);
  return limit >= 0 && dx * dx + dy * dy + dz * dz <= limit * limit;
}

/// A box around all that is within reach of some part now, and so also later: every box that passes `may_reach`
/// overlaps it. (The slack covers the rounding there, the sums here, and squares that underflow.)
template <class Body>
extent within_reach(const Body& body) {
  extent box;
  for (std::uint32_t k = 0; k < body.part_count; ++k) {
    const ball& around = body.places[k].around;
    const real most = frames::limit(around, body.answer.reach(k));
    if (!(most >= 0)) continue;
    const auto beyond = [most](real c) { return (most + 0x1p-72f) * (1 + 8 * slack) + absolute(c) * slack; };
    const vec3 c = around.center, r{beyond(c.x), beyond(c.y), beyond(c.z)};
    box.add(c - r);
    box.add(c + r);
  }
  return box;
}
inline bool beside(const extent& a, const extent& b) {
  const bool together = int(a.lower.x <= b.upper.x) & int(b.lower.x <= a.upper.x) & int(a.lower.y <= b.upper.y) &
                        int(b.lower.y <= a.upper.y) & int(a.lower.z <= b.upper.z) & int(b.lower.z <= a.upper.z);
  return !together;
}

/// Counts a whole tile's dropped points and finds the others' box, without loading it. False if this source cannot.
template <point_source S>
bool survey(const S& source, std::size_t begin, extent& box, drop_tally& mine) {
  if constexpr (surveyed_source<S>) return source.survey(begin, box, mine.dropped);
  return false;
}

/// Tests points begin .. end - 1, tile by tile. Nearly all tiles are far from every part and are done after one test.
template <class Body>
void scan_tiles(const Body& body, std::size_t begin, std::size_t end, drop_tally& mine) {
  const auto reach = [&](std::uint32_t k) { return body.answer.reach(k); };
  const extent near_robot = within_reach(body);  // spares nearly all boxes the test of every part
  if constexpr (capsule_source<std::remove_cvref_t<decltype(body.source)>>)
    return scan_capsules<tile_survivors>(body, begin, end, near_robot, mine);

  for (std::size_t i = begin; i < end; i += tile_points) {
    const std::size_t count = std::min(tile_points, end - i);
    tile t;
    extent box;
    bool loaded = false;
    if (count == tile_points && survey(body.source, i, box, mine)) {
      box = {box.lower - body.origin, box.upper - body.origin};
    } else {
      t.load(body.source, i, count, 1, mine);
      t.subtract(body.origin);
      box = box_of(t);
      loaded = true;
    }

    if (body.answer.ended(body.first + std::uint32_t(i))) continue;
    if (beside(box, near_robot)) continue;
    std::uint32_t k = 0;
    while (k < body.part_count && !may_reach(body.places[k].around, reach(k), box)) ++k;
    if (k == body.part_count) continue;
    if (!loaded) {
      drop_tally uncounted;
      t.load(body.source, i, count, 1, uncounted);
      t.subtract(body.origin);
    }

    tile_survivors near;
    for (; k < body.part_count; ++k)
      if (may_reach(body.places[k].around, reach(k), box)) near.add(t, body.places[k].around, reach(k), k);
    with_vectors([&] { near.for_each([&](std::size_t j, std::uint32_t parts) { body.visit(t[j], i + j, parts); }); });
  }
}

/// Before all others, takes a few points spread over the cloud to one leaf each, by `descend(p, index, part)`. For a
/// good bound it takes those nearest to each part's middle.
template <class Body, class Descend>
void sample_tiles(const Body& body, std::size_t tiles, Descend descend) {
  const std::size_t stride = body.source.size() / (tiles * tile_points);
  const auto index = [&](std::size_t n, std::size_t j) { return (n * tile_points + j) * stride; };
  const auto reach = [&](std::uint32_t k) { return body.answer.reach(k); };
  tile t;
  drop_tally uncounted;
  for (std::size_t n = 0; n < tiles; ++n) {
    t.load(body.source, index(n, 0), tile_points, stride, uncounted);
    t.subtract(body.origin);
    for (std::uint32_t k = 0; k < body.part_count; ++k) {
      const vec3 c = body.places[k].around.center;
      alignas(64) real away[tile_points];
      for (std::size_t j = 0; j < tile_points; ++j) {
        const real dx = t.x[j] - c.x, dy = t.y[j] - c.y, dz = t.z[j] - c.z;
        away[j] = dx * dx + dy * dy + dz * dz;
      }
      std::size_t nearest = 0;
      real least = infinity;
      for (std::size_t j = 0; j < tile_points; ++j)
        if (away[j] < least) {
          least = away[j];
          nearest = j;
        }
      if (may_reach(body.places[k].around, reach(k), t[nearest])) descend(t[nearest], index(n, nearest), k);
    }
  }
}

}  // namespace clearance::scan
