// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/winding.hpp>

namespace clearance {

/// What a closed surface encloses.
struct enclosed {
  double volume = 0;       ///< Cubic metres where the winding number is not zero.
  bool exact = true;       ///< From the divergence theorem; otherwise from rays, to about 0.1 %.
  bool overlaps = false;   ///< Somewhere the winding number is not 0 and 1, or 0 and -1.
};

/// Rays along +x through the middles of a grid over (y, z) see which winding numbers there are. If they are only 0 and 1,
/// the signed volume is the volume; else the rays' lengths inside are summed.
inline enclosed enclosed_volume(const basic_winding<double>& w) {
  const basic_winding_view<double> g = w.view();
  const double y = g.high[1] - g.low[1], z = g.high[2] - g.low[2];
  int lowest = 0, highest = 0;
  const auto sum_of_rays = [&](int rays) {
    double length = 0;
    std::vector<std::pair<double, int>> hits;
    for (int i = 0; i < rays; ++i)
      for (int j = 0; j < rays; ++j) {
        // Slightly off the middle, so that symmetric meshes are not met in their seams.
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
          if (std::isfinite(x)) hits.emplace_back(x, s);
        }
        std::sort(hits.begin(), hits.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
        int number = 0;
        for (std::size_t k = 0; k + 1 < hits.size(); ++k) {
          number -= hits[k].second;  // a ray leaves through +1
          const double span = hits[k + 1].first - hits[k].first;
          if (number != 0) length += span;
          // Touching surfaces, met in the wrong order by rounding, are no overlap.
          if (span > 1e-9 * (g.high[0] - g.low[0])) lowest = std::min(lowest, number), highest = std::max(highest, number);
        }
      }
    return length * (y / rays) * (z / rays);
  };
  double signed_volume = 0;
  for (const auto& t : w.triangles) {
    double v[3][3];
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) v[j][k] = t.v[j][k] - g.low[k];
    signed_volume += (v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) - v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
                      v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0])) / 6;
  }
  sum_of_rays(128);
  enclosed e;
  e.overlaps = highest - lowest > 1;
  e.exact = !e.overlaps;
  e.volume = e.overlaps ? sum_of_rays(512) : std::abs(signed_volume);
  return e;
}

}  // namespace clearance
