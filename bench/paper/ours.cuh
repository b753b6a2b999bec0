// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Axes that the paper does not have: width, fit, volumes, exact triangles, layouts of points; and the headline, the
// paper's own method at its best width over the prepared query.

#include "lab.cuh"

#include <clearance/bvh/build.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/strided_points.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>

namespace bench::paper {

using sphere_parts = decltype(sphere_model<clearance::sphere>(std::declval<const scene&>()));

/// The widths and leaf sizes to try.
inline const std::vector<clearance::build_options> shapes = {{2, 1}, {2, 4}, {4, 1}, {4, 4}, {8, 1}, {8, 4}};
inline std::string name_of(const clearance::build_options& o) {
  return "width " + std::to_string(o.width) + " leaf " + std::to_string(o.leaf_size);
}

/// The paper's own method on every width, and ours on each of its widths. The headline is the ratio of the paper's best
/// to our default, cold and warm. Returns the number of the paper's best.
template <class Models>
std::size_t headline(lab& l, const Models& models, double reference) {
  l.floors();
  l.out.begin("width", l.scene->name, l.points.size());
  double least = 1e30;
  std::size_t best = 0;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const double t = l.time_method("the paper's; " + name_of(shapes[k]), paper_method{}, l.parts(models[k]), reference);
    l.time_method("near first fused; " + name_of(shapes[k]),
                  method<shared_by_all, clearance::near_first>{.order = schedule::fused}, l.parts(models[k]),
                  reference);
    if (t < least) least = t, best = k;
    clearance::query query(l.gpu, models[k], clearance::min_distance{});
    l.time_ours("ours cold; " + name_of(shapes[k]), query, l.cloud(), true, reference);
  }
  l.out.begin("headline", l.scene->name, l.points.size());
  clearance::query query(l.gpu, models.back(), clearance::min_distance{});
  const double cold = l.time_ours("ours cold", query, l.cloud(), true, reference);
  const double warm = l.time_ours("ours warm", query, l.cloud(), false, reference);
  l.out.row("the paper's; " + name_of(shapes[best]), "us", least);
  l.out.row("the paper's over ours cold", "ratio", least / cold);
  l.out.row("the paper's over ours warm", "ratio", least / warm);
  return best;
}

template <class Model>
void volume_of(lab& l, const std::string& name, const Model& on_host) {
  const double reference = l.reference(on_host);
  const auto model = on_host.on(l.gpu);
  const auto parts = l.parts(model);
  l.time_method("the paper's; " + name, paper_method{}, parts, reference);
  l.time_method("near first fused; " + name, method<shared_by_all, clearance::near_first>{.order = schedule::fused},
                parts, reference);
  clearance::query query(l.gpu, model, clearance::min_distance{});
  l.time_ours("ours cold; " + name, query, l.cloud(), true, reference);
  l.time_ours("ours warm; " + name, query, l.cloud(), false, reference);
}

/// Volumes around inner spheres and around triangles. The paper's kernel does not ask for the interior, so the robot
/// must touch nothing.
inline void volumes(lab& l, const scene& robot) {
  l.out.begin("volume", l.scene->name, l.points.size());
  volume_of(l, "spheres in spheres", sphere_model<clearance::sphere>(robot));
  volume_of(l, "spheres in aabb", sphere_model<clearance::aabb>(robot));
  volume_of(l, "spheres in obb", sphere_model<clearance::obb>(robot));
  volume_of(l, "triangles in aabb", triangle_model<clearance::aabb>(robot));
  volume_of(l, "triangles in obb", triangle_model<clearance::obb>(robot));
}

/// Nodes fitted around their leaves, or around their children as in the first Inner Sphere Trees.
inline void fits(lab& l, const scene& robot) {
  l.out.begin("fit", l.scene->name, l.points.size());
  for (const clearance::build_options options : {clearance::build_options{2, 1}, clearance::build_options{8, 4}}) {
    std::vector<std::remove_cvref_t<decltype(std::declval<sphere_parts>().parts()[0])>> parts;
    for (const auto& p : robot.packings)
      parts.push_back(clearance::make_part<clearance::sphere>(p, {.build = options}, clearance::layered{}));
    volume_of(l, "wrapped; " + name_of(options), sphere_model<clearance::sphere>(robot, options));
    volume_of(l, "layered; " + name_of(options), clearance::model(std::move(parts)));
  }
}

/// The same parts with trees by another split rule.
template <class Model, class Split>
Model rebuilt(const Model& model, Split split) {
  auto parts = model.parts();
  for (auto& p : parts) {
    auto primitives = p.tree.primitives;
    for (std::size_t i = 0; i < primitives.size(); ++i) primitives[p.tree.ids[i]] = p.tree.primitives[i];
    using volume = std::remove_cvref_t<decltype(p.tree.volumes[0])>;
    p.tree = clearance::build<volume>(primitives, {}, clearance::wrapped{}, split);
  }
  return Model(std::move(parts));
}

/// The rules for splitting nodes when a tree is built.
inline void splits(lab& l, const scene& robot) {
  l.out.begin("split", l.scene->name, l.points.size());
  const auto spheres = sphere_model<clearance::sphere>(robot);
  const auto triangles = triangle_model<clearance::aabb>(robot);
  const auto by = [&](const std::string& name, auto split) {
    volume_of(l, "spheres, " + name, rebuilt(spheres, split));
    volume_of(l, "triangles, " + name, rebuilt(triangles, split));
  };
  by("surface area", clearance::surface_area_split{});
  by("median", clearance::median_split{});
  by("principal", clearance::principal_split{});
  by("two means", clearance::two_means_split{});
  by("neural gas", clearance::neural_gas_split{});
}

/// x, y and z in separate arrays: a point source like any other.
struct point_arrays {
  const float *x, *y, *z;
  std::size_t count;

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD clearance::sample operator[](std::size_t i) const {
    return clearance::point_filter{}({x[i], y[i], z[i]});
  }
};
static_assert(clearance::point_source<point_arrays>);

template <class Query, class Source>
void layout_of(lab& l, Query& query, const std::string& name, const Source& source, double bytes, double reference) {
  l.out.row(name, "bytes_a_point", bytes);
  l.time_ours(name + "; cold", query, source, true, reference);
  l.time_ours(name + "; warm", query, source, false, reference);
}

/// The same points in different layouts in memory; for one frame also as its depth image.
template <class Model>
void layouts(lab& l, const Model& on_host) {
  l.out.begin("layout", l.scene->name, l.points.size());
  const double reference = l.reference(on_host);
  const auto model = on_host.on(l.gpu);
  clearance::query query(l.gpu, model, clearance::min_distance{});
  const std::size_t n = l.points.size();
  std::vector<float> wide(n * 8), apart(n * 3);
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = l.points[i];
    wide[8 * i] = p.x, wide[8 * i + 1] = p.y, wide[8 * i + 2] = p.z;
    apart[i] = p.x, apart[n + i] = p.y, apart[2 * n + i] = p.z;
  }
  const auto records = l.gpu.copy_in(std::span<const float>(wide)),
             arrays = l.gpu.copy_in(std::span<const float>(apart));
  layout_of(l, query, "float3", l.cloud(), 12, reference);
  layout_of(
      l, query, "records of 32 bytes",
      clearance::strided_points<>{.data = reinterpret_cast<const std::byte*>(records.data()), .count = n, .step = 32},
      32, reference);
  layout_of(l, query, "three arrays", point_arrays{arrays.data(), arrays.data() + n, arrays.data() + 2 * n, n}, 12,
            reference);
  if (l.scene->name != "table" || n != 640 * 480) return;
  std::vector<std::uint16_t> depth(n);
  for (std::size_t i = 0; i < n; ++i)
    depth[i] = clearance::is_finite(l.points[i]) ? std::uint16_t(std::lround(1000 * l.points[i].z)) : 0;
  clearance::depth_image image(depth.data(), 640, 480, {525, 525, 320, 240});
  const clearance::placed<clearance::depth_image<std::uint16_t>> placed{image, l.scene->world_from_cloud};
  const double same = clearance::ask(clearance::host{}, on_host, l.poses, placed, clearance::min_distance{}).distance;
  const auto pixels = l.gpu.copy_in(std::span<const std::uint16_t>(depth));
  layout_of(l, query, "16-bit depth", image.at(reinterpret_cast<const std::byte*>(pixels.data())), 2, same);
}

}  // namespace bench::paper
