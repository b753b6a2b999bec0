// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/closed_mesh.hpp>
#include <clearance/solid/flood.hpp>
#include <clearance/solid/volume.hpp>

namespace clearance {

/// Bodies with a winding number below 0 somewhere: they cross themselves, and another body's number could cancel
/// theirs. Rays find them if they are at least a hundredth of the part.
inline std::vector<bool> cancelling_bodies(const closed_mesh& mesh, const basic_winding<double>& w,
                                           std::span<const std::uint32_t> body) {
  std::vector<bool> cancels(mesh.encloses.size(), false);
  std::vector<std::int32_t> number(cancels.size(), 0);
  std::vector<std::uint32_t> below;  // bodies whose number is now below 0
  for_each_ray(w, 128, [&](std::span<const ray_hit> hits) {
    for (std::size_t k = 0; k < hits.size(); ++k) {
      const std::uint32_t its = body[hits[k].triangle];
      number[its] -= hits[k].sign;
      if (number[its] == -1 && hits[k].sign == 1) below.push_back(its);
      if (k + 1 < hits.size() && hits[k + 1].x - hits[k].x > least_piece(w))
        for (const std::uint32_t b : below)
          if (number[b] < 0) cancels[b] = true;
      std::erase_if(below, [&](std::uint32_t b) { return number[b] >= 0; });
    }
    for (const ray_hit& hit : hits) number[body[hit.triangle]] = 0;
    below.clear();
  });
  return cancels;
}

/// What a flood from outside does not reach in a mesh's shapes.
class second_opinion {
 public:
  /// `shape`: the shape of each triangle, caps included.
  second_opinion(const closed_mesh& mesh, std::span<const std::uint32_t> shape, std::uint32_t shapes)
      : mesh_(mesh), triangles_of_(shapes) {
    for (std::uint32_t i = 0; i < shape.size(); ++i) triangles_of_[shape[i]].push_back(i);
  }

  /// Is there a cube that a flood around this shape does not reach, but that is outside by the winding numbers? Coarse,
  /// because it only checks what caps closed.
  bool contradicts(std::uint32_t shape, const basic_winding<double>& w) const {
    Eigen::AlignedBox3d box;
    extend(box, shape);
    const enclosure_grid grid = grid_around(box, coarse_cubes);
    const std::size_t row = grid.size[0], layer = row * grid.size[1];
    const std::vector<std::uint32_t> bits = flooded(grid, shape);
    for (std::size_t i = 0; i < layer * grid.size[2]; ++i)
      if (bits[i / 32] >> i % 32 & 1) {
        const Eigen::Vector3d cube(i % row, i / row % grid.size[1], i / layer);
        const Eigen::Vector3d p = grid.low + grid.cube * (cube + Eigen::Vector3d::Constant(0.5));
        if (!w.view().inside(p.x(), p.y(), p.z())) return true;
      }
    return false;
  }

  /// All cubes that floods around each of these shapes do not reach. `cube` is set even if nothing is enclosed.
  enclosure_grid enclosed(const std::vector<bool>& shapes) const {
    Eigen::AlignedBox3d box;
    for (std::uint32_t s = 0; s < shapes.size(); ++s)
      if (shapes[s]) extend(box, s);
    const auto floods = double(std::count(shapes.begin(), shapes.end(), true));
    enclosure_grid grid = grid_around(box, fine_cubes * std::min(1.0, most_fine / floods));
    std::vector<std::uint32_t> all;
    for (std::uint32_t s = 0; s < shapes.size(); ++s) {
      if (!shapes[s]) continue;
      const std::vector<std::uint32_t> bits = flooded(grid, s);
      all.resize(bits.size());
      for (std::size_t i = 0; i < bits.size(); ++i) all[i] |= bits[i];
    }
    if (std::any_of(all.begin(), all.end(), [](std::uint32_t word) { return word != 0; })) grid.bits = std::move(all);
    return grid;
  }

 private:
  // 50 and 200 cubes along each side of a cube. A fine flood takes a twentieth of a second; for many shapes they are
  // coarser.
  static constexpr double coarse_cubes = 1 << 17, fine_cubes = 1 << 23, most_fine = 16;

  std::array<Eigen::Vector3d, 3> corners(std::uint32_t i) const {
    const auto& t = mesh_.surface.triangles[i];
    return {mesh_.surface.vertices[t[0]], mesh_.surface.vertices[t[1]], mesh_.surface.vertices[t[2]]};
  }
  void extend(Eigen::AlignedBox3d& box, std::uint32_t shape) const {
    for (const std::uint32_t i : triangles_of_[shape])
      for (const auto& c : corners(i)) box.extend(c);
  }
  std::vector<std::uint32_t> flooded(const enclosure_grid& grid, std::uint32_t shape) const {
    flood from_outside(grid);
    for (const std::uint32_t i : triangles_of_[shape]) from_outside.add(corners(i));
    return from_outside.enclosed();
  }

  const closed_mesh& mesh_;
  std::vector<std::vector<std::uint32_t>> triangles_of_;
};

}  // namespace clearance
