// SPDX-License-Identifier: BSD-3-Clause
// glTF as robot descriptions use it, as text (.gltf) and binary (.glb). Anything not understood that would change the
// shape (skins, morph targets, sparse or compressed data) is refused by name; materials, cameras and animations are
// skipped.

#include "io/gltf_data.hpp"
#include "io/mesh_formats.hpp"
#include "io/mesh_scene.hpp"

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <vector>

namespace clearance::io {

namespace {

/// parent-from-node: a matrix, or translation, rotation and scale.
Eigen::Affine3d gltf_transform(const gltf_value& node) {
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

/// glTF 2 is read. Files of other versions have another structure.
void check_gltf_version(const gltf_value& root) {
  if (!root.has("asset") || !root["asset"].has("version")) return;
  const gltf_value version = root["asset"]["version"];
  if (!version.value.is_string() || !version.value.get<std::string>().starts_with("2."))
    version.refuse("is " + version.value.dump() + ", and glTF 2 is read");
}

void check_gltf_node(const gltf_value& node) {
  node.only({"camera", "children", "skin", "matrix", "mesh", "rotation", "scale", "translation", "weights", "name",
             "extensions", "extras"});
}

}  // namespace

polygon_mesh read_gltf(std::string_view text, std::optional<std::string_view> chunk, const std::string& file,
                       const mesh_limits& limits, std::vector<std::string>& notes, std::uint64_t& bytes_of_others) {
  const nlohmann::json json = read_json(text, file, limits);
  const gltf_value root{json, file, ""};
  if (!json.is_object()) root.refuse("is no object");
  check_gltf_version(root);
  root.only({"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers", "materials",
             "textures", "images", "samplers", "skins", "animations", "cameras", "extensionsUsed", "extensionsRequired",
             "extensions", "extras"});
  check_required_extensions(root);
  judge_gltf_extensions(root, notes);

  gltf_buffers buffers(root, chunk, file, limits);
  gltf_data data(root, buffers, limits, notes);
  std::vector<std::optional<polygon_mesh>> meshes(root.size("meshes"));
  const std::size_t nodes = root.size("nodes"), scenes = root.size("scenes");
  if (scenes != 1 && !root.has("scene"))
    root.refuse("has " + std::to_string(scenes) + " scenes, and does not say which");
  const gltf_value scene = root["scenes"][root.has("scene") ? root["scene"].index(scenes) : 0];
  scene.only({"nodes", "name", "extensions", "extras"});
  judge_gltf_extensions(scene, notes);

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
    check_gltf_node(node);
    if (node.has("skin")) node.refuse("has a skin, which is not supported");
    judge_gltf_extensions(node, notes);
    const Eigen::Affine3d placed = at.above * gltf_transform(node);
    if (node.has("children")) push(node["children"], at.depth + 1, placed);
    if (!node.has("mesh")) continue;
    auto& mesh = meshes[node["mesh"].index(meshes.size())];
    if (!mesh) mesh = data.mesh(root["meshes"][node["mesh"].index(meshes.size())]);
    made.place(*mesh, placed);
  }

  for (std::size_t i = 0; i < nodes; ++i) {
    if (seen[i]) continue;
    const gltf_value node = root["nodes"][i];
    check_gltf_node(node);
    judge_gltf_extensions(node, notes);
    if (node.has("mesh")) node.refuse("has no place in the scene, so it would be lost");
  }
  for (std::size_t i = 0; i < meshes.size(); ++i)
    if (!meshes[i]) root["meshes"][i].refuse("has no place in the scene, so it would be lost");
  bytes_of_others = buffers.bytes_of_others();
  return made.finish();
}

}  // namespace clearance::io
