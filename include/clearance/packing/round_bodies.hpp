// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a round of packing does to one cell or one climber, on host and device.

#include <clearance/ground/math.hpp>
#include <clearance/packing/grid.hpp>
#include <clearance/packing/room_view.hpp>

namespace clearance {

/// The room around a place, from the few spheres and surface pieces nearby. It is exact below `reach` minus the way
/// from the place, and never too large. If there are too many, all are asked; a solid without pieces is asked as a
/// whole.
template <solid_view V, class Lanes>
class local_list {
 public:
  static constexpr std::uint32_t capacity = 256;

  CLEARANCE_HD local_list(const room_view<V>& all, std::uint32_t* items, Lanes lanes)
      : all_(all), items_(items), lanes_(lanes) {}

  CLEARANCE_HD void prepare(const solid_sphere& now) {
    if (reach_ >= 1.5 * now.radius && (now.center - place_).norm() <= 0.25 * reach_) return;
    place_ = now.center;
    reach_ = 2 * now.radius;
    count_ = 0;
    const auto sphere = [this](std::uint32_t i, double best) {
      if (all_.spheres[i].nearer(place_, best) < best) take(i);
      return best;
    };
    lanes_.meet();  // all have read the old list
    if constexpr (knows_pieces) all_.solid.near(place_, reach_, [this](std::uint32_t i) { take(i); });
    pieces_ = count_;
    all_.tree.nearest(place_, reach_, sphere);
    for (std::uint32_t i = all_.tree.items; i < all_.count; ++i) sphere(i, reach_);
    lanes_.meet();
  }
  CLEARANCE_HD double room(const vec3d& p, double within, double enough) const {
    if (count_ > capacity) return all_.room(p, within, enough);
    const double known = reach_ - (p - place_).norm();
    if (known < within) within = known;
    for (std::uint32_t k = pieces_; k < count_ && within > enough; ++k)
      within = all_.spheres[items_[k]].nearer(p, within);
    if constexpr (knows_pieces) {
      for (std::uint32_t k = 0; k < pieces_ && within > enough; ++k) within = all_.solid.nearer(items_[k], p, within);
    } else {
      if (within > enough) within = all_.solid.distance(p, within, enough);
    }
    return within;
  }

 private:
  static constexpr bool knows_pieces = requires(const V v, vec3d p) { v.nearer(std::uint32_t(0), p, 0.0); };

  CLEARANCE_HD void take(std::uint32_t item) {
    if (count_ < capacity && lanes_.rank() == 0) items_[count_] = item;
    ++count_;
  }

  const room_view<V>& all_;
  std::uint32_t* items_;
  Lanes lanes_;
  vec3d place_;
  double reach_ = 0;
  std::uint32_t pieces_ = 0, count_ = 0;  // pieces of the surface, which come first; everything
};

/// Moves an inside sphere that no other touches to a local maximum of the room, at most `farthest` away. Each step
/// stays in the ball that is known to be inside, so none leaves the solid through a thin wall.
template <solid_view V, class Lanes>
CLEARANCE_HD solid_sphere climb(const room_view<V>& in, std::uint32_t* memory, const solid_sphere& from,
                                double farthest, Lanes lanes) {
  local_list<V, Lanes> around(in, memory, lanes);
  return compass_search(
      from, 1e-3, lanes, [&](const solid_sphere& now) { around.prepare(now); },
      [&](const vec3d& p, double most, double least) {
        return (p - from.center).norm() > farthest ? 0 : around.room(p, most * (1 + 1e-12), least);
      });
}

/// Moves and grows an inside sphere, ignoring other spheres, as long as it covers its old middle.
template <solid_view V, class Lanes>
CLEARANCE_HD solid_sphere grow(const V& in, const solid_sphere& from, Lanes lanes) {
  return compass_search(
      from, 1e-2, lanes, [](const solid_sphere&) {},
      [&](const vec3d& p, double most, double least) {
        const double r = in.distance(p, most * (1 + 1e-12), least);
        return (p - from.center).norm() <= r - from.radius / 2 ? r : 0;
      });
}

/// Decides which part of a solid comes next, on host and device. `depth` and `gap` are the distances from a cell's
/// middle to the surface and to the spheres; `reach` is that to its corners.
struct pack_rules {
  double gap_per_radius;
  bool promotes;     ///< Is it finite?
  double smallest;   ///< The least radius.
  double trust = 1;  ///< How far a cell's bound is trusted, at most 1.

  static constexpr double promotion = 8;  ///< A cell may overtake others with up to this many times its room.

  pack_rules(double per_radius, double smallest)
      : gap_per_radius(per_radius), promotes(per_radius < double(infinity)), smallest(smallest) {}

  /// The largest bound comes first. But where the spheres are much farther away than the bound, as in thin walls and
  /// sharp corners, a cell may come before its turn.
  CLEARANCE_HD double key(double depth, double reach, double gap) const {
    const double bound = (depth < gap ? depth : gap) + trust * reach, wanted = (gap + trust * reach) / gap_per_radius;
    const double key = !promotes || wanted < bound ? bound : wanted > promotion * bound ? promotion * bound : wanted;
    // With little trust the key may be negative. It stays above 0, in the same order, so that every cell gets its turn:
    // the largest key is always at least some fraction of the largest.
    const double last = 1e-3 * smallest;
    return key > last ? key : last / (2 - key / last);
  }
  /// Is a cell too small to divide? So division ends: a climb from here finds no sphere that floats can represent, or
  /// the largest is a 2^-30th below the least radius.
  CLEARANCE_HD bool finest(double reach) const { return reach < 0x1p-30 * smallest; }
  /// Is a cell small enough against its room to climb from? Otherwise it is divided.
  CLEARANCE_HD bool small(double room, double reach) const {
    const double least = 1 - 0.25 / trust;
    return room >= (least > 0.25 ? least : 0.25) * (room + reach);
  }
  /// Gaps above this change no key, so they need not be known exactly.
  CLEARANCE_HD double farthest_gap(double bound) const { return promotes ? promotion * gap_per_radius * bound : bound; }
};

}  // namespace clearance

namespace clearance::rounds {

/// A cube of space.
struct cell {
  vec3d middle;
  double half;
  double depth;  ///< The solid's signed distance at the middle, positive inside.
  double gap;    ///< From the middle to the first `seen` spheres, or farther than matters.
  std::uint32_t seen;

  CLEARANCE_HD double reach() const { return corner_reach(half); }
  CLEARANCE_HD double room() const { return depth < gap ? depth : gap; }
  CLEARANCE_HD double bound() const { return room() + reach(); }  ///< No room in the cell is larger.
};

enum class deed : std::uint8_t { none, climb, divide };

/// The sphere that one climber offers; radius 0: none.
struct offer {
  solid_sphere found, grown;  ///< Where it climbed to; the same, or grown if spheres may overlap.
  double key;                 ///< That of the cell where it began.
};

template <solid_view V>
struct field {
  room_view<V> in;
  pack_rules rules;
  double scale;

  /// 0: nothing fits. A cell that was given up has its negative bound as key.
  CLEARANCE_HD double key(const cell& c) const {
    return c.bound() >= rules.smallest ? rules.key(c.depth, c.reach(), c.gap) : 0;
  }
};

template <solid_view V>
struct cover {
  field<V> f;
  cube_grid grid;
  cell* cells;
  double* keys;
  CLEARANCE_HD void operator()(std::size_t i) const {
    const vec3d p = grid.middle(i);
    cells[i] = {p, grid.half, signed_depth(f.in.solid, p, 0, 0), double(infinity), 0};
    keys[i] = f.key(cells[i]);
  }
};

/// Updates a cell, and decides what to do with it if its key is still high.
template <solid_view V>
struct refresh {
  field<V> f;
  const std::uint32_t* some;
  std::size_t count;  ///< Of `some`.
  cell* cells;
  double* keys;
  double least;
  deed* deeds;
  CLEARANCE_HD void operator()(std::size_t i) const {
    cell& c = cells[some[i]];
#if !defined(__CUDA_ARCH__) && defined(__GNUC__)
    if (i + 4 < count) {  // cells lie far apart in memory, each in two lines of a cache
      __builtin_prefetch(cells + some[i + 4]);
      __builtin_prefetch(&cells[some[i + 4]].seen);
    }
#endif
    if (c.seen < f.in.count) {
      c.gap = f.in.count - c.seen <= 256 ? f.in.gap_from(c.seen, c.middle, c.gap) : f.in.gap(c.middle, c.gap);
      c.seen = f.in.count;
    }
    const double key = keys[some[i]] = f.key(c);
    deeds[i] = key < least ? deed::none : f.rules.small(c.room(), c.reach()) ? deed::climb : deed::divide;
  }
};

template <solid_view V>
struct divide {
  field<V> f;
  const std::uint32_t *some, *these;
  cell* cells;
  double* keys;
  std::size_t first;  ///< Where the eighths go.
  CLEARANCE_HD void operator()(std::size_t i) const {
    const cell& from = cells[some[these[i / 8]]];
    cell c = eighth_of(from, std::uint32_t(i % 8));
    c.depth = signed_depth(f.in.solid, c.middle, from.depth, c.reach());
    const double bound = c.depth + c.reach();
    if (bound >= f.rules.smallest) c.gap = f.in.gap(c.middle, f.rules.farthest_gap(bound), -c.reach());
    keep(i, c);
  }
  /// All eight of cube `i`, on the host.
  void all_eight(std::size_t i) const {
    const cell& from = cells[some[these[i]]];
    const eighths at([&from](std::uint32_t k) { return eighth_middle(from.middle, from.half, k); });
    const double reach = corner_reach(from.half / 2);
    eight depth = eight::of(1), gap;
    signed_depths(f.in.solid, at, from.depth, reach, depth);
    for (int k = 0; k < 8; ++k) {
      const double bound = depth.v[k] + reach;
      gap.v[k] = bound >= f.rules.smallest ? f.rules.farthest_gap(bound) : -double(infinity);
    }
    f.in.gaps(at, gap, -reach);
    for (std::uint32_t k = 0; k < 8; ++k) {
      cell c = eighth_of(from, k);
      c.depth = depth.v[k];
      c.gap = gap.v[k];
      keep(8 * i + k, c);
    }
  }

 private:
  CLEARANCE_HD cell eighth_of(const cell& from, std::uint32_t k) const {
    return {eighth_middle(from.middle, from.half, k), from.half / 2, 0, 0, f.in.count};
  }
  CLEARANCE_HD void keep(std::size_t i, const cell& c) const {
    const std::uint32_t parent = some[these[i / 8]];
    const bool finest = f.rules.finest(cells[parent].reach());
    cells[first + i] = c;
    keys[first + i] = finest ? 0 : f.key(c);
    if (i % 8 == 0) keys[parent] = finest ? -cells[parent].bound() : 0;
  }
};

/// The sphere with float centre and radius that certainly fits; radius 0: none.
template <solid_view V>
CLEARANCE_HD solid_sphere fit(const field<V>& f, const solid_sphere& wanted, bool overlap) {
  const vec3d c(to_float(wanted.center.x), to_float(wanted.center.y), to_float(wanted.center.z));
  if ((c - wanted.center).norm() > 0.5 * wanted.radius) return {c, 0};
  const double r = overlap ? f.in.solid.distance(c, 2 * wanted.radius, 0) : f.in.room(c, 2 * wanted.radius);
  const double sure = r * (1 - 1e-12) - 1e-13 * f.scale;  // less what rounding may have added
  return {c, sure > 0 ? double(rounded_down(sure)) : 0};
}

template <solid_view V>
struct climb_cells {
  field<V> f;
  const std::uint32_t *some, *these;
  const cell* cells;
  const double* keys;
  bool overlap;
  offer* offers;
  deed* deeds;
  std::uint32_t* memory;  ///< `capacity` per climber.
  template <class Lanes>
  CLEARANCE_HD void operator()(std::size_t i, Lanes lanes) const {
    const cell& c = cells[some[these[i]]];
    // It is taken before its turn: stay near, although there is more room elsewhere.
    const double key = keys[some[these[i]]], farthest = key > c.bound() ? c.room() / 2 : double(infinity);
    const solid_sphere start{c.middle, c.room()};
    solid_sphere found = climb(f.in, memory + i * local_list<V, Lanes>::capacity, start, farthest, lanes);
    solid_sphere grown = fit(f, overlap ? grow(f.in.solid, found, lanes) : found, overlap);
    if (is_porous(f.in.solid) && !f.in.solid.inside(grown.center)) {
      found = start;
      grown = fit(f, start, overlap);
    }
    if (lanes.rank() != 0) return;
    const double least = 0.98 * found.radius;
    if (!overlap) found = grown;
    if (grown.radius < f.rules.smallest || grown.radius < least) {  // too small, or lost in rounding
      found.radius = 0;
      deeds[these[i]] = deed::divide;
    }
    offers[i] = {found, grown, key};
  }
};

/// Is an offer the largest of those it conflicts with? Then it is taken; the others return in a later round.
struct judge {
  const offer* offers;
  std::size_t count;
  double scale;
  unsigned char* taken;
  CLEARANCE_HD void operator()(std::size_t i) const {
    const solid_sphere& mine = offers[i].found;
    bool yes = mine.radius > 0;
    for (std::size_t j = 0; j < count && yes; ++j) {
      const solid_sphere &theirs = offers[j].grown, &found = offers[j].found;
      if (!(found.radius > mine.radius || (found.radius == mine.radius && j < i))) continue;
      const vec3d way = theirs.center - mine.center;
      const double reach = (theirs.radius + mine.radius) * (1 + 1e-12) + 1e-13 * scale;  // with possible rounding
      yes = way.dot(way) >= reach * reach * (1 + 1e-12);
    }
    taken[i] = yes;
  }
};
struct is_taken {
  const unsigned char* taken;
  CLEARANCE_HD bool operator()(std::size_t i) const { return taken[i] != 0; }
};

struct append {
  const offer* offers;
  const std::uint32_t* taken;
  solid_sphere* to;
  CLEARANCE_HD void operator()(std::size_t i) const { to[i] = offers[taken[i]].grown; }
};

struct keep_cells {
  const std::uint32_t* some;
  const cell* cells;
  const double* keys;
  cell* to;
  double* keys_to;
  CLEARANCE_HD void operator()(std::size_t i) const {
    to[i] = cells[some[i]];
    keys_to[i] = keys[some[i]];
  }
};

template <solid_view V>
struct weigh_again {
  field<V> f;
  const cell* cells;
  double* keys;
  CLEARANCE_HD void operator()(std::size_t i) const { keys[i] = keys[i] > 0 ? f.key(cells[i]) : keys[i]; }
};

struct key_of {
  const double* keys;
  CLEARANCE_HD double operator()(std::size_t i) const { return keys[i]; }
};
struct bound_of {
  const cell* cells;
  const double* keys;
  CLEARANCE_HD double operator()(std::size_t i) const { return keys[i] > 0 ? cells[i].bound() : -keys[i]; }
};
struct at_least {
  const double* keys;
  double least;
  CLEARANCE_HD bool operator()(std::size_t i) const { return keys[i] > 0 && keys[i] >= least; }
};
struct is_kept {
  const double* keys;
  CLEARANCE_HD bool operator()(std::size_t i) const { return keys[i] != 0; }
};
struct is_deed {
  const deed* deeds;
  deed which;
  CLEARANCE_HD bool operator()(std::size_t i) const { return deeds[i] == which; }
};

}  // namespace clearance::rounds
