// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/packing_scene.hpp>

#include <clearance/bvh/build.hpp>
#include <clearance/io/scene.hpp>
#include <clearance/packing/packing.hpp>
#include <clearance/volume/sphere.hpp>

#include <cmath>

namespace clearance::io {

namespace {

/// A colour for 0 to 1: from violet over green to yellow.
colour heat(double t) {
  const auto wave = [t](double at, double wide) { return float(std::exp(-std::pow((t - at) / wide, 2))); };
  return {0.25f * wave(0, 0.35) + 0.95f * wave(1.1, 0.45), 0.15f + 0.7f * wave(0.95, 0.6),
          0.15f + 0.5f * wave(0.2, 0.4), 1};
}

}  // namespace

scene packing_scene(const std::vector<scene_packing>& parts) {
  scene made;
  for (const scene_packing& part : parts) {
    made.bodies.push_back({part.name + " mesh", part.mesh, part.pose, {0.75f, 0.78f, 0.85f, 0.22f}, part.name});
    std::map<int, std::vector<ball>, std::greater<>> octaves;
    for (const inner_sphere& s : part.spheres.spheres)
      octaves[std::ilogb(s.radius / 1e-3f)].push_back({s.center, s.radius});
    const int high = octaves.begin()->first, low = octaves.rbegin()->first;
    for (auto& [octave, balls] : octaves) {
      const double from = std::exp2(octave);
      const std::string name = part.name + " spheres of " + std::to_string(from).substr(0, 6) + " to " +
                               std::to_string(2 * from).substr(0, 6) + " mm";
      made.balls.push_back(
          {name, std::move(balls), part.pose, heat(high == low ? 1 : double(octave - low) / (high - low)), part.name});
    }
    const auto tree = build<sphere>(part.spheres.spheres);
    const auto levels = levels_of(tree.view());
    for (std::size_t k = 0; k < levels.size(); ++k) {
      colour paint = heat(levels.size() == 1 ? 0 : double(k) / double(levels.size() - 1));
      paint.alpha = 0.12f;
      made.balls.push_back({part.name + " level " + std::to_string(k), levels[k], part.pose, paint, part.name});
    }
  }
  return made;
}

}  // namespace clearance::io
