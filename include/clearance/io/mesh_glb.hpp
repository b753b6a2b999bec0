// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Binary glTF as robot descriptions use it. Anything not understood that would change the shape (skins, morph targets,
// sparse or compressed data, other files) is refused by name; materials, cameras and animations are skipped.

#include <clearance/io/glb_data.hpp>
#include <clearance/io/mesh_scene.hpp>

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <vector>

namespace clearance::io {

/// parent-from-node: a matrix, or translation, rotation and scale.
inline Eigen::Affine3d glb_transform(const gltf_value& node) {
  Eigen::Affine3d made = Eigen::Affine3d::Identity();
  if (node.has("matrix")) {
    if (node.has("translation") || node.has("rotation") || node.has("scale"))
      node.refuse("has a matrix and parts of one");
    const auto m = node["matrix"].reals<16>();
    for (int i = 0; i < 16; ++i) made.matrix()(i % 4, i / 4) = m[std::size_t(i)];
    if (made.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) node["matrix"].refuse("does not end in 0 0 0 1");
    return made;
  }
  if (node.has("translation")) {
    const auto t = node["translation"].reals<3>();
    made.translate(Eigen::Vector3d(t[0], t[1], t[2]));
  }
  if (node.has("rotation")) {
    const auto q = node["rotation"].reals<4>();
    const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
    if (!(std::abs(turn.norm() - 1) < 1e-3)) node["rotation"].refuse("is no unit quaternion");
    made.rotate(turn.normalized());
  }
  if (node.has("scale")) {
    const auto s = node["scale"].reals<3>();
    made.scale(Eigen::Vector3d(s[0], s[1], s[2]));
  }
  return made;
}

/// Allows only extensions about how things look, not about where they are.
inline void check_gltf_extensions(const gltf_value& root) {
  for (std::size_t i = 0; i < root.size("extensionsRequired"); ++i) {
    const gltf_value each = root["extensionsRequired"][i];
    if (!each.value.is_string()) each.refuse("is no name");
    const std::string name = each.value.get<std::string>();
    if (!name.starts_with("KHR_materials_") && !name.starts_with("KHR_texture_") && !name.starts_with("EXT_texture_") &&
        !name.starts_with("KHR_lights_"))
      root.refuse("requires the extension " + io::quoted(name) + ", which is not supported");
  }
}

/// All meshes of a binary glTF file's scene, once for each place that the scene gives them.
inline polygon_mesh read_glb(std::string_view bytes, const std::string& file, const mesh_limits& limits = {}) {
  const glb_chunks chunks = read_glb_chunks(bytes, file);
  const nlohmann::json json = read_json(chunks.json, file, limits);
  const gltf_value root{json, file, ""};
  root.only({"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers", "materials",
             "textures", "images", "samplers", "skins", "animations", "cameras", "extensionsUsed", "extensionsRequired",
             "extensions", "extras"});
  check_gltf_extensions(root);
  const glb_data data(root, chunks.data, limits);
  std::vector<std::optional<polygon_mesh>> meshes(root.size("meshes"));
  const std::size_t nodes = root.size("nodes"), scenes = root.size("scenes");
  if (scenes != 1 && !root.has("scene"))
    root.refuse("has " + std::to_string(scenes) + " scenes, and does not say which");
  const gltf_value scene = root["scenes"][root.has("scene") ? root["scene"].index(scenes) : 0];
  scene.only({"nodes", "name", "extensions", "extras"});

  struct pending {
    std::size_t node, depth;
    Eigen::Affine3d above;
  };
  std::vector<pending> stack;
  std::vector<bool> seen(nodes);
  const auto push = [&](const gltf_value& list, std::size_t depth, const Eigen::Affine3d& above) {
    for (std::size_t i = list.size(); i-- > 0;) {  // so the first comes next
      const std::size_t node = list[i].index(nodes);
      if (seen[node]) list[i].refuse("is a node that is elsewhere too: nodes make a tree");
      seen[node] = true;
      stack.push_back({node, depth, above});
    }
  };
  mesh_scene made(file, limits);
  if (scene.has("nodes")) push(scene["nodes"], 1, Eigen::Affine3d::Identity());
  while (!stack.empty()) {
    const pending at = stack.back();
    stack.pop_back();
    made.visit(at.depth);
    const gltf_value node = root["nodes"][at.node];
    node.only({"camera", "children", "skin", "matrix", "mesh", "rotation", "scale", "translation", "weights", "name",
               "extensions", "extras"});
    if (node.has("skin")) node.refuse("has a skin, which is not supported");
    if (node.has("extensions") && node["extensions"].has("EXT_mesh_gpu_instancing"))
      node.refuse("has instances by an extension that is not supported");
    const Eigen::Affine3d here = at.above * glb_transform(node);
    if (node.has("children")) push(node["children"], at.depth + 1, here);
    if (!node.has("mesh")) continue;
    auto& mesh = meshes[node["mesh"].index(meshes.size())];
    if (!mesh) mesh = data.mesh(root["meshes"][node["mesh"].index(meshes.size())]);
    made.place(*mesh, here);
  }
  for (std::size_t i = 0; i < nodes; ++i)
    if (!seen[i]) root["nodes"][i].refuse("has no place in the scene, so it would be lost");
  for (std::size_t i = 0; i < meshes.size(); ++i)
    if (!meshes[i]) root["meshes"][i].refuse("has no place in the scene, so it would be lost");
  return made.take();
}

}  // namespace clearance::io
