// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The worst possible cloud, made in the memory where it is read.

#include <clearance/ground/pose.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/visitor/nearest.hpp>

#include <algorithm>

namespace bench {

using clearance::vec3;

/// Random bits that depend only on the point's number: the finaliser of splitmix64 over a counter.
class point_bits {
 public:
  CLEARANCE_HD explicit point_bits(std::uint64_t point) : counter_(mixed(point)) {}
  CLEARANCE_HD std::uint64_t operator()() { return mixed(counter_ += 0x9e3779b97f4a7c15u); }

 private:
  CLEARANCE_HD static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  std::uint64_t counter_;
};

struct shell_part {
  clearance::rigid_transform world_from_part, part_from_world;
  const clearance::inner_sphere* spheres;
  std::uint32_t count;
};

/// Goes from far away to a random sphere of the robot, in steps so long that nothing gets nearer than `away`. (Of
/// points placed around single spheres, only one in four thousand has no other sphere that is nearer.)
template <class PartView>
struct shell_body {
  const PartView* parts;
  const shell_part* placed;
  std::uint32_t count;
  float away;
  vec3* points;

  static constexpr float start = 8, to_rounding = 1e-6f;  // metres
  static constexpr int most_steps = 1000, most_tries = 10;

  CLEARANCE_HD void operator()(std::size_t i) const {
    point_bits bits(i);
    points[i] = {clearance::not_a_number, clearance::not_a_number, clearance::not_a_number};
    for (int tries = 0; tries < most_tries && !clearance::is_finite(points[i]); ++tries)
      points[i] = seen_along_a_ray(bits);
  }

  CLEARANCE_HD float distance(vec3 world) const {
    clearance::nearest nearest;
    for (std::uint32_t k = 0; k < count; ++k)
      clearance::near_first{}(parts[k].tree, placed[k].part_from_world(world), nearest);
    return nearest.within;
  }

  /// NaN if the steps do not end `away` from the robot, such as along a ray that grazes it.
  CLEARANCE_HD vec3 seen_along_a_ray(point_bits& bits) const {
    const std::uint64_t which = bits();
    const shell_part& part = placed[(which >> 32) % count];
    const vec3 target = part.world_from_part(part.spheres[std::uint32_t(which) % part.count].center);
    vec3 out;
    do {
      const std::uint64_t b = bits();
      const auto axis = [&](int shift) { return float((b >> shift) & 0x1fffff) * 0x1p-20f - 1; };
      out = {axis(0), axis(21), axis(42)};
    } while (!(clearance::length(out) <= 1 && clearance::length(out) > 0.1f));
    out = clearance::scaled(clearance::divide(1, clearance::length(out)), out);
    float along = start;
    for (int steps = 0; steps < most_steps; ++steps) {
      const vec3 p = clearance::fma(along, out, target);
      const float beyond = distance(p) - away;
      if (clearance::absolute(beyond) <= to_rounding) return p;
      if (beyond < 0) break;
      along -= beyond;
    }
    return {clearance::not_a_number, clearance::not_a_number, clearance::not_a_number};
  }
};

/// Writes `count` points in world coordinates, `away` metres from the robot to two micrometres. The parts have our own
/// trees. `points` is memory of the backend, and filled when this returns.
template <clearance::backend B, class Model>
void put_shell(const B& on, const Model& model, std::span<const Eigen::Isometry3d> poses, float away, vec3* points,
               std::size_t count) {
  std::vector<shell_part> parts;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const auto& spheres = model.parts()[k].tree.primitives;
    parts.push_back({clearance::to_floats(poses[k]), clearance::to_floats(poses[k].inverse()), spheres.data(),
                     std::uint32_t(spheres.size())});
  }
  const auto there = on.copy_in(std::span<const shell_part>(parts));
  using view = typename Model::view_type;
  on.for_each(count, shell_body<view>{model.view().parts, there.data(), std::uint32_t(parts.size()), away, points});
  on.wait();
}

/// Puts them in the order in which a sensor sees them, with neighbours side by side: along a Z-curve of 2 mm.
template <clearance::backend B>
void put_in_order(const B& on, vec3* points, std::size_t count) {
  auto there = on.copy_out(points, count);
  const auto place = [](vec3 p) {
    std::uint64_t code = 0;
    const std::uint64_t x = std::uint64_t((p.x + 8) * 500), y = std::uint64_t((p.y + 8) * 500),
                        z = std::uint64_t((p.z + 8) * 500);
    for (int b = 0; b < 14; ++b)
      code |= (x >> b & 1) << 3 * b | (y >> b & 1) << (3 * b + 1) | (z >> b & 1) << (3 * b + 2);
    return code;
  };
  std::ranges::sort(there, {}, place);
  on.stage(std::span<const vec3>(there), points);
}

}  // namespace bench
