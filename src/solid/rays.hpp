// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Rays through a closed surface: what they meet, and how much it encloses by them.

#include <clearance/solid/winding.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace clearance {

/// A triangle that a ray along +x meets.
struct ray_hit {
  double x;
  std::int32_t sign;       ///< +1 where the ray leaves through it, -1 where it enters.
  std::uint32_t triangle;  ///< Its number in the winding.
};

/// As many rays along each side as `wanted`, or fewer where triangles lie so many deep that they would take minutes.
inline int affordable_rays(const basic_winding<double>& w, int wanted) {
  const double deep = double(w.lists.size()) / double(w.cells.size());
  return std::clamp(int(std::sqrt(3e7 / std::max(deep, 1.0))), 16, wanted);
}

/// Calls `visit(hits)` for rays along +x through the cell middles of a grid of `rays` by `rays` over (y, z), with the
/// hits from low to high x. Returns the (y, z) area that each ray stands for, square metres.
template <class F>
double for_each_ray(const basic_winding<double>& w, int rays, F visit) {
  const basic_winding_view<double> g = w.view();
  const double y = g.high[1] - g.low[1], z = g.high[2] - g.low[2];
  std::vector<ray_hit> hits;
  for (int i = 0; i < rays; ++i)
    for (int j = 0; j < rays; ++j) {
      // Slightly off the middle, so that rays do not run in the seams of symmetric meshes.
      const double py = g.low[1] + y * ((i + 0.4987) / rays), pz = g.low[2] + z * ((j + 0.5021) / rays);
      const std::uint32_t cell = g.row(pz) * g.columns + g.column(py);
      hits.clear();
      for (std::uint32_t k = g.begin[cell]; k < g.begin[cell + 1]; ++k) {
        const auto& v = g.triangles[g.lists[k]].v;
        const int s = crossing::side(v[0], v[1], py, pz);
        if (s == 0 || crossing::side(v[1], v[2], py, pz) != s || crossing::side(v[2], v[0], py, pz) != s) continue;
        const double uy = v[1][1] - v[0][1], uz = v[1][2] - v[0][2], vy = v[2][1] - v[0][1], vz = v[2][2] - v[0][2];
        const double det = uy * vz - uz * vy, a = ((py - v[0][1]) * vz - (pz - v[0][2]) * vy) / det,
                     b = (uy * (pz - v[0][2]) - uz * (py - v[0][1])) / det;
        const double x = v[0][0] + a * (v[1][0] - v[0][0]) + b * (v[2][0] - v[0][0]);
        if (std::isfinite(x)) hits.push_back({x, s, g.lists[k]});
      }
      std::sort(hits.begin(), hits.end(),
                [](const auto& p, const auto& q) { return p.x != q.x ? p.x < q.x : p.triangle < q.triangle; });
      visit(std::span<const ray_hit>(hits));
    }
  return (y / rays) * (z / rays);
}

/// Rounding can swap two touching surfaces along a ray. That is no overlap, so shorter pieces are ignored. Metres.
inline double least_piece(const basic_winding<double>& w) { return 1e-9 * (w.grid.high[0] - w.grid.low[0]); }

/// What a closed surface encloses.
struct enclosed {
  double volume = 0;      ///< Cubic metres where the winding number is not 0.
  bool exact = true;      ///< From the divergence theorem; otherwise from rays, to about 0.1 %.
  bool overlaps = false;  ///< Some winding numbers are other than 0 and 1, or 0 and -1.
};

/// Rays find the winding numbers that occur. If these are only 0 and 1, or 0 and -1, the signed volume is the answer;
/// otherwise the lengths of rays inside are summed.
inline enclosed enclosed_volume(const basic_winding<double>& w) {
  if (w.triangles.empty()) return {};
  int lowest = 0, highest = 0;
  const auto sum_of_rays = [&](int rays) {
    double length = 0;
    const double each = for_each_ray(w, rays, [&](std::span<const ray_hit> hits) {
      int number = 0;
      for (std::size_t k = 0; k + 1 < hits.size(); ++k) {
        number -= hits[k].sign;  // +1: the ray leaves
        const double span = hits[k + 1].x - hits[k].x;
        if (number != 0) length += span;
        if (span > least_piece(w)) {
          lowest = std::min(lowest, number);
          highest = std::max(highest, number);
        }
      }
    });
    return length * each;
  };
  double signed_volume = 0;
  for (const auto& t : w.triangles) {
    double v[3][3];
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) v[j][k] = t.v[j][k] - w.grid.low[k];
    signed_volume +=
        (v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) - v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
         v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0])) /
        6;
  }
  sum_of_rays(affordable_rays(w, 128));
  enclosed e;
  e.overlaps = highest - lowest > 1;
  e.exact = !e.overlaps;
  e.volume = e.overlaps ? sum_of_rays(affordable_rays(w, 512)) : std::abs(signed_volume);
  return e;
}

}  // namespace clearance
