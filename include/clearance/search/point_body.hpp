// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/indices.hpp>
#include <clearance/query/any_within.hpp>
#include <clearance/search/tile_scan.hpp>

namespace clearance::search {

/// The query of the shared minimum (the paper's Algorithm 3): its reach is the best that anybody has found.
struct shared_nearest {
  using result_type = real;

  const distance_key* shared;
  real best = infinity;

  CLEARANCE_HD real reach() const { return min(best, key_distance(load_relaxed(shared))); }
  CLEARANCE_HD void offer(std::uint32_t, real distance) {
    if (distance < best) best = distance;
  }
  CLEARANCE_HD real result() const { return best; }
};
static_assert(query<shared_nearest>);

/// The whole of Algorithm 3 for a range of points: every part, one shared bound, or one a part.
template <class PartView, point_source Source, class Traversal>
struct point_body {
  const PartView* parts;
  const placement* places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  std::uint32_t first;  ///< Number of this cloud's first point among all clouds' points.
  totals* all;
  distance_key* part_best;  ///< One bound a part, or null: all parts share `all->best`.
  Traversal walk;

  CLEARANCE_HD void operator()(indices range) const {
    tally mine;
#if defined(__CUDA_ARCH__)
    for (std::size_t i = range.begin; i < range.end; i += range.step)
      if (const sample s = source[i]; mine.counts(s)) visit(s.position - origin, i);
#else
    scan_tiles(*this, range.begin, range.end, mine);
#endif
    mine.add_to(*all);
  }

  CLEARANCE_HD distance_key* bound_of(std::uint32_t k) const {
    return part_best != nullptr ? part_best + k : &all->best;
  }

  /// One point against every part.
  CLEARANCE_HD void visit(vec3 p, std::size_t i) const {
    for (std::uint32_t k = 0; k < part_count; ++k) visit(p, first + std::uint32_t(i), k);
  }

  std::size_t device_stack() const requires requires { Traversal::device_stack(1); }
  { return stack_bytes; }
  std::size_t stack_bytes = 0;

 private:
  CLEARANCE_HD void visit(vec3 p, std::uint32_t index, std::uint32_t k) const {
    distance_key* const bound = bound_of(k);
    const placement& place = places[k];
    if (!may_reach(place.around, key_distance(load_relaxed(bound)), p)) return;

    const PartView& part = parts[k];
    const vec3 q = place.part_from_cloud(p);
    using interior = typename PartView::interior_type;
    if constexpr (!requires { interior::empty; }) {
      // 0 is the least such a part can have: once a lower point has it for certain, nothing is left to learn.
      if (load_relaxed(bound) <= make_key(0, index) && load_relaxed(&all->certain) != 0) return;
      if (part.interior.inside(q)) {
        lower_to(bound, make_key(0, index));
        if (load_relaxed(&all->certain) == 0) {
          any_within surface{place.error + part.facts.tolerance};
          walk(part.tree, q, surface);
          if (!surface.found) add_to(&all->certain, 1);
        }
        return;
      }
    }
    shared_nearest ask{bound};
    walk(part.tree, q, ask);
    if (ask.best < infinity) {
      const distance_key key = make_key(ask.best, index);
      if (key < load_relaxed(bound)) lower_to(bound, key);
    }
  }
};

}  // namespace clearance::search
