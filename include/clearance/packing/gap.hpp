// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/grid.hpp>
#include <clearance/packing/host_steps.hpp>
#include <clearance/packing/spheres_there.hpp>
#include <clearance/primitive/inner_sphere.hpp>

namespace clearance {

struct gap_report {
  double certified = 0;      ///< No point of the solid, surface and interior, is farther from the spheres. Metres.
  double mean = 0, p95 = 0;  ///< Over samples of the surface, metres.
};

namespace detail {

struct gap_cell {
  vec3d middle;
  double half;
  double depth;  ///< Signed: the parent cell's until visited, then its own; 0 if unknown.
};

/// Bounds the gap over the solid's points in a cell.
template <solid_view V>
struct gap_visit {
  room_view<V> in;
  gap_cell* cells;
  double* met;     ///< The gap at the middle, if that is in the solid.
  double* open;    ///< An upper bound: if it is above `target` and can be narrowed down,
  double* closed;  ///< or otherwise.
  double least, target, slack;

  CLEARANCE_HD void operator()(std::size_t i) const {
    gap_cell& c = cells[i];
    const double reach = corner_reach(c.half);
    met[i] = open[i] = closed[i] = 0;
    const double gap = in.gap(c.middle, double(infinity), least - reach), bound = gap + reach;
    if (bound <= least) return;
    c.depth = signed_depth(in.solid, c.middle, c.depth, reach);  // also the way to its parent's middle
    if (c.depth < -reach * (1 + 1e-12)) return;                  // no point of the solid is here
    if (c.depth >= 0) met[i] = gap;
    // The solid is less than `reach` from the middle, so a small cell's bound is at most twice `reach` too high.
    (bound <= target || 4 * reach <= slack ? closed : open)[i] = bound;
  }
};

struct gap_spread {
  const gap_cell* from;
  const std::uint32_t* some;
  gap_cell* to;
  CLEARANCE_HD void operator()(std::size_t i) const {
    const gap_cell& c = from[some[i / 8]];
    to[i] = {eighth_middle(c.middle, c.half, std::uint32_t(i % 8)), c.half / 2, c.depth};
  }
};

struct gap_roots {
  cube_grid grid;
  gap_cell* to;
  CLEARANCE_HD void operator()(std::size_t i) const { to[i] = {grid.middle(i), grid.half, 0}; }
};

template <solid_view V>
struct gap_at {
  room_view<V> in;
  const vec3d* points;
  double* gaps;
  CLEARANCE_HD void operator()(std::size_t i) const {
    const double g = in.gap(points[i], double(infinity));
    gaps[i] = g > 0 ? g : 0;
  }
};

struct value_of {
  const double* values;
  CLEARANCE_HD double operator()(std::size_t i) const { return values[i]; }
};
struct if_not_above {
  const double* values;
  double most;
  CLEARANCE_HD double operator()(std::size_t i) const { return values[i] > most ? 0 : values[i]; }
};
struct is_above {
  const double* values;
  double least;
  CLEARANCE_HD bool operator()(std::size_t i) const { return values[i] > least; }
};

}  // namespace detail

/// The largest distance from any point of the solid to the nearest sphere, 0 if they cover it. It is a proven upper
/// bound, by branch and bound in double, rounded up. It exceeds the truth by at most `tolerance` (relative), 10 um or
/// 1e-5 of the solid, or by more if the search would take too long. All cells of one size go at once and know the same
/// gap so far, so the result does not depend on their order.
template <backend B, class Steps, solid S, solid_view V>
gap_report measure_gap(const B& on, Steps& steps, const S& s, const room_view<V>& in, double tolerance) {
  gap_report report;
  if (in.count == 0) {
    report.certified = report.mean = report.p95 = double(infinity);
    return report;
  }
  // Every gap found bounds the largest from below; a better bound shortens the search.
  std::vector<vec3d> points;
  if constexpr (requires { s.surface_points(std::size_t(1)); })
    for (const auto& p : s.surface_points(20000)) points.push_back(p);
  const std::size_t samples = points.size();
  if constexpr (requires { s.corners(); })
    for (const auto& p : s.corners()) points.push_back(p);
  double least = 0;
  if (!points.empty()) {
    const auto there = on.copy_in(std::span<const vec3d>(points));
    auto gaps_there = on.template make_scratch<double>(points.size());
    steps.each(points.size(), detail::gap_at<V>{in, there.data(), gaps_there.data()});
    std::vector<double> gaps = on.copy_out(gaps_there.data(), gaps_there.size());
    least = *std::max_element(gaps.begin(), gaps.end());
    gaps.resize(samples);
    for (const double g : gaps) report.mean += g / double(samples);
    const auto at = gaps.begin() + std::ptrdiff_t(samples * 95 / 100);
    std::nth_element(gaps.begin(), at, gaps.end());
    if (samples != 0) report.p95 = *at;
  }

  const double diagonal = Eigen::AlignedBox3d(s.bounds()).diagonal().norm(), finest = std::min(1e-5, 1e-5 * diagonal);
  growing<detail::gap_cell, B> cells(on), next(on);
  growing<double, B> met(on), open(on), closed(on);
  growing<std::uint32_t, B> some(on);
  const cube_grid grid(s.bounds(), 16);
  std::size_t n = grid.size();
  steps.each(n, detail::gap_roots{grid, cells.reserve(n)});
  double upper = 0;
  while (n > 0) {  // cells halve until 4 * reach <= slack, which is at least `finest`
    const double slack = std::max(least * tolerance, finest);
    steps.each(n, detail::gap_visit<V>{in, cells.data(), met.reserve(n), open.reserve(n), closed.reserve(n), least,
                                       least + slack, slack});
    least = std::max(least, steps.largest(n, detail::value_of{met.data()}));
    upper = std::max(upper, steps.largest(n, detail::value_of{closed.data()}));
    const double enough = std::max(upper, least + std::max(least * tolerance, finest));
    upper = std::max(upper, steps.largest(n, detail::if_not_above{open.data(), enough}));
    const std::size_t split = steps.select(n, detail::is_above{open.data(), enough}, some.reserve(n));
    if (8 * split >
        Steps::cells) {  // the gap of a ball in a ball, say, is the same all over, which no search can narrow down
      upper = std::max(upper, steps.largest(n, detail::value_of{open.data()}));
      break;
    }
    steps.each(8 * split, detail::gap_spread{cells.data(), some.data(), next.reserve(8 * split)});
    std::swap(cells, next);
    n = 8 * split;
  }
  report.certified = std::max(least, upper) * (1 + 1e-12) + 1e-12 * diagonal;
  return report;
}

/// The same on the host, for spheres from anywhere.
template <solid S>
gap_report measure_gap(const S& s, std::span<const inner_sphere> spheres, double tolerance = 0.01) {
  const host on;
  host_steps steps(on);
  std::vector<solid_sphere> wide;
  for (const inner_sphere& each : spheres) wide.push_back({{each.center.x, each.center.y, each.center.z}, each.radius});
  spheres_there<host> all(on);
  all.insert(wide);
  all.plant(0);
  return measure_gap(on, steps, s, all.room_in(solid_there<host, S>(on, s).view()), tolerance);
}

}  // namespace clearance
