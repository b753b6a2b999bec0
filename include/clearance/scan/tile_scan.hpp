// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Tests a range of points against every part on the host. `Body` is a scan_body: it has the parts' places, the answer,
// and the exact visit for the few points that are left.

#include <clearance/frame/root_test.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/scan/capsule_tiles.hpp>
#include <clearance/scan/tile.hpp>

namespace clearance::scan {

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
  extent all;
  for (std::uint32_t k = 0; k < body.part_count; ++k) {
    const ball& around = body.places[k].around;
    const real most = frames::limit(around, body.answer.reach(k));
    if (!(most >= 0)) continue;
    const auto beyond = [most](real c) { return (most + 0x1p-72f) * (1 + 8 * slack) + absolute(c) * slack; };
    const vec3 c = around.center, r{beyond(c.x), beyond(c.y), beyond(c.z)};
    all.add(c - r), all.add(c + r);
  }
  return all;
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
    if constexpr (requires { body.answer.ended(body.first); })
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
        if (away[j] < least) least = away[j], nearest = j;
      if (may_reach(body.places[k].around, reach(k), t[nearest])) descend(t[nearest], index(n, nearest), k);
    }
  }
}

}  // namespace clearance::scan
