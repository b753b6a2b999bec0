// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which primitives can be nearest in a cell, and why no other can.
//
// A primitive t is left out if a place s of another one is nearer all over the cell. Let A be the distance to t's core,
// B = |p - s|, and D by how much t's radius is larger. We need A - B > D. If D is not negative, that is A^2 > (B +
// D)^2; with A^2 - |p|^2 concave (the least of linear functions), B^2 - |p|^2 linear and B convex, the difference is
// concave, so its least value is at a corner. Otherwise (A - D)^2 > B^2 is enough, with a tangent for the A in -2 A D.

#include <clearance/robot/cells.hpp>
#include <clearance/scan/interior.hpp>

namespace clearance::pointwise {

/// A cell to be looked at, and the candidates that those around it left.
struct cell_task {
  std::uint32_t x, y, z, up;   ///< See cells_view::middle.
  std::uint32_t first, count;  ///< Candidates in a list of places,
  std::uint32_t marks;         ///< one bit each, from this word on: those that are left. Of a leaf: its first entry.
  std::uint32_t node;          ///< Its own, from level `cells_view::top` on.
};

/// What is left of them.
struct cell_found {
  std::uint32_t count;
  real distance;  ///< From the cell's middle to the nearest.
};

/// The corners of a cell, a little outside of it because of rounding, and its middle.
struct cell_box {
  static constexpr int corners = 8, looks = 9;
  vec3 middle;
  real half, noise;

  /// `around`: a ball around all primitives.
  CLEARANCE_HD cell_box(const cells_view& shape, const cell_task& t, const ball& around)
      : middle(shape.middle(t.x, t.y, t.z, t.up)) {
    const real side = shape.step * real(1u << t.up),
               away = absolute(middle.x) + absolute(middle.y) + absolute(middle.z) + side;
    half = side / 2 * (1 + slack) +
           2 * slack * (away + absolute(shape.low.x) + absolute(shape.low.y) + absolute(shape.low.z));
    // Twice what rounding may change of the difference of two distances; `slack` is 32 units of it.
    noise = 2 * slack * (length(middle - around.center) + 2 * half + 2 * around.radius) + 0x1p-60f;
  }
  CLEARANCE_HD vec3 way_to(int corner) const {
    return {corner & 1 ? half : -half, corner & 2 ? half : -half, corner & 4 ? half : -half};
  }
  /// A corner, or as the last one the middle.
  CLEARANCE_HD vec3 look(int j) const { return j < corners ? middle + way_to(j) : middle; }
};

/// Marks the candidates of task i that can be nearest in its cell.
template <class PartView>
struct mark_candidates {
  using primitive_type = typename PartView::hierarchy_type::primitive_type;
  const PartView* part;
  cells_view shape;
  const cell_task* tasks;
  const std::uint32_t* places;
  std::uint32_t* marks;
  cell_found* found;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const cell_task task = tasks[i];
    const auto* const primitives = part->tree.primitives;
    const cell_box box(shape, task, {part->facts.center, part->facts.radius});
    const auto candidate = [&](std::uint32_t n) -> primitive_type { return primitives[places[task.first + n]]; };
    real least = infinity;
    std::uint32_t nearest[cell_box::looks] = {};
    for (std::uint32_t n = 0; n < task.count; ++n)
      if (const real d = candidate(n).distance(box.middle); d < least) least = d, nearest[cell_box::corners] = n;
    // No distance changes faster than its place, so one that is far from the middle is nearest nowhere.
    const real far = least + 2 * 1.7321f * box.half + box.noise;
    real least_at[cell_box::corners];
    for (real& d : least_at) d = infinity;
    each_word(task, [&](std::uint32_t n, std::uint32_t) {
      const primitive_type p = candidate(n);
      if (!(p.distance(box.middle) <= far)) return false;
      for (int c = 0; c < cell_box::corners; ++c)
        if (const real d = p.distance(box.look(c)); d < least_at[c]) least_at[c] = d, nearest[c] = n;
      return true;
    });
    rival rivals[cell_box::looks];
    for (int j = 0; j < cell_box::looks; ++j) rivals[j] = rival(candidate(nearest[j]).core_at(box.look(j)), box);
    std::uint32_t left = 0;
    each_word(task, [&](std::uint32_t n, std::uint32_t near) {
      const bool may = (near >> n % 32 & 1) != 0 && may_be_nearest(candidate(n), rivals, box);
      left += may;
      return may;
    });
    found[i] = {left, least};
  }

 private:
  /// Writes a mark for each candidate. `mark(n, word)` is told what the mark's word was.
  template <class Mark>
  CLEARANCE_HD void each_word(const cell_task& task, const Mark& mark) const {
    for (std::uint32_t begin = 0; begin < task.count; begin += 32) {
      const std::uint32_t end = task.count < begin + 32 ? task.count : begin + 32,
                          before = marks[task.marks + begin / 32];
      std::uint32_t word = 0;
      for (std::uint32_t n = begin; n < end; ++n) word |= std::uint32_t(mark(n, before)) << n % 32;
      marks[task.marks + begin / 32] = word;
    }
  }
  /// A place of a core, as seen from the corners.
  struct rival {
    real away[cell_box::corners], farthest, radius;

    rival() = default;
    CLEARANCE_HD rival(const core_place& s, const cell_box& box) : farthest(0), radius(s.radius) {
      for (int c = 0; c < cell_box::corners; ++c)
        away[c] = length(box.look(c) - s.at), farthest = max(farthest, away[c]);
    }
  };

  static CLEARANCE_HD bool may_be_nearest(const primitive_type& p, const rival (&rivals)[cell_box::looks],
                                          const cell_box& box) {
    const real radius = p.core_at(box.middle).radius;
    const primitive_tangent t = p.tangent_at(box.middle);
    real away[cell_box::corners];
    for (int c = 0; c < cell_box::corners; ++c) away[c] = p.distance(box.look(c)) + radius;
    for (const rival& s : rivals) {
      const real more = radius - s.radius, of_rival = max(more, 0), its = max(-more, 0);
      const real margin = box.noise * (2 * (s.farthest + of_rival) + box.noise);
      bool nearer = true;  // the rival, everywhere
      for (int c = 0; nearer && c < cell_box::corners; ++c) {
        const real a = away[c], b = s.away[c] + of_rival,
                   plane = t.distance + dot(t.direction, box.way_to(c)) + radius - box.noise;
        nearer = (a - b) * (a + b) + its * (2 * plane + its) > margin;
      }
      if (nearer) return false;
    }
    return true;
  }
};

/// Puts the marked candidates of task i into its own list.
struct list_candidates {
  const cell_task* tasks;
  const std::uint32_t* places;
  const std::uint32_t* marks;
  const std::uint32_t* first;  ///< Where each list begins.
  std::uint32_t* lists;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const cell_task task = tasks[i];
    std::uint32_t to = first[i];
    for (std::uint32_t n = 0; n < task.count; ++n)
      if (marks[task.marks + n / 32] >> n % 32 & 1) lists[to++] = places[task.first + n];
  }
};

/// Makes the entries of leaf i, the nearest to its middle first, from its list.
template <class PartView>
struct enter_candidates {
  const PartView* part;
  cells_view shape;
  const cell_task* leaves;
  const std::uint32_t* places;
  cell_entry* entries;
  cell_kind* sides;  ///< Becomes `inside`, `list` for outside, or `unlisted` if a leaf may have both.

  CLEARANCE_HD void operator()(std::size_t i) const {
    const cell_task leaf = leaves[i];
    const cell_box box(shape, leaf, {part->facts.center, part->facts.radius});
    cell_entry* const to = entries + leaf.marks;
    real least = infinity;
    for (std::uint32_t n = 0; n < leaf.count; ++n) {
      const std::uint32_t place = places[leaf.first + n];
      const auto p = part->tree.primitives[place];
      least = min(least, p.distance(box.middle));
      const cell_entry e = entry(place, p.tangent_at(box.middle), box);
      std::uint32_t at = n;
      for (; at > 0 && to[at - 1].distance > e.distance; --at) to[at] = to[at - 1];
      to[at] = e;
    }
    sides[i] = side(box, least);
  }

 private:
  static CLEARANCE_HD cell_entry entry(std::uint32_t place, const tangent& t, const cell_box& box) {
    const auto whole = [](real u) { return std::uint16_t(rough_max(rough_min(u * 32767, 32767), -32767) + 32768.5f); };
    cell_entry e{place, 0, {whole(t.direction.x), whole(t.direction.y), whole(t.direction.z)}, 0};
    // The direction is off by less than 2/32767 along each axis, whatever rounding does.
    e.distance = t.distance - box.half * (6.0f / 32767) - slack * (absolute(t.distance) + 8 * box.half) - 0x1p-60f;
    return e;
  }
  /// All of a cell is on one side if no primitive comes nearer to it than the solid's tolerance.
  CLEARANCE_HD cell_kind side(const cell_box& box, real least) const {
    if constexpr (scan::has_interior<PartView>) {
      const real nearest = least - 1.7321f * box.half - box.noise;
      if (!(nearest > part->facts.tolerance)) return cell_kind::unlisted;
      return part->interior.inside(box.middle) ? cell_kind::inside : cell_kind::list;
    }
    return cell_kind::list;
  }
};

}  // namespace clearance::pointwise
