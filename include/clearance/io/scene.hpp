// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A picture of a query for any glTF viewer: robot, points, witness.

#include <clearance/io/scene_balls.hpp>
#include <clearance/io/scene_mesh.hpp>
#include <clearance/io/write_file.hpp>

#include <assimp/Exporter.hpp>
#include <assimp/scene.h>

#include <Eigen/Geometry>

#include <memory>
#include <optional>

namespace clearance::io {

struct scene_body {
  std::string name;
  triangle_mesh mesh;  // in the body's frame
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // world-from-body
  colour paint = {0.75f, 0.75f, 0.78f, 1};
  std::string group = {};  // the name of a node for all bodies and balls of one group; empty: none
};

struct scene_points {
  std::string name;
  std::vector<vec3> points;  // in the cloud's frame; those that are not finite are left out
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  colour paint = {0.25f, 0.45f, 0.85f, 1};
};

struct scene_balls {
  std::string name;
  std::vector<ball> balls;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  colour paint = {0.9f, 0.7f, 0.3f, 1};
  std::string group = {};
};

/// A thin red rod in world coordinates.
struct scene_segment {
  std::string name;
  Eigen::Vector3d from, to;
  colour paint = {0.9f, 0.1f, 0.1f, 1};
};

/// Metres, z up, in world coordinates; `origin` is subtracted from them, because a glTF file holds floats.
struct scene {
  std::vector<scene_body> bodies;
  std::vector<scene_points> clouds;
  std::vector<scene_balls> balls;
  std::vector<scene_segment> segments;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/// Writes a binary glTF file (.glb), whole or not at all; glTF's y is up, so all is turned by -90 degrees about x. Names
/// become printable UTF-8. Throws std::runtime_error.
inline void save_scene(const scene& world, const std::string& file) {
  std::vector<std::unique_ptr<aiMesh>> meshes;
  std::vector<std::unique_ptr<aiMaterial>> materials;
  std::vector<std::unique_ptr<aiNode>> nodes;
  std::vector<std::pair<std::string, std::vector<std::unique_ptr<aiNode>>>> groups;
  const auto add = [&](const std::string& given, std::unique_ptr<aiMesh> mesh, const Eigen::Isometry3d& pose, colour paint,
                       const std::string& group = {}) {
    if (mesh->mNumVertices == 0) return;
    const std::string name = scene_name(given);
    auto node = std::make_unique<aiNode>(name);
    Eigen::Isometry3d relative = pose;
    relative.translation() -= world.origin;
    for (unsigned r = 0; r < 4; ++r)
      for (unsigned c = 0; c < 4; ++c) node->mTransformation[r][c] = ai_real(relative(r, c));
    node->mNumMeshes = 1;
    node->mMeshes = new unsigned[1]{unsigned(meshes.size())};
    mesh->mName = name;
    mesh->mMaterialIndex = unsigned(materials.size());
    meshes.push_back(std::move(mesh));
    materials.push_back(scene_material(name, paint));
    if (group.empty()) return nodes.push_back(std::move(node));
    auto at = std::ranges::find(groups, group, [](const auto& each) { return each.first; });
    if (at == groups.end()) at = groups.emplace(at, group, std::vector<std::unique_ptr<aiNode>>());
    at->second.push_back(std::move(node));
  };
  for (const auto& body : world.bodies) add(body.name, faces_of(body.mesh), body.pose, body.paint, body.group);
  for (const auto& cloud : world.clouds) add(cloud.name, points_of(cloud.points, cloud.paint), cloud.pose, cloud.paint);
  for (const auto& set : world.balls) add(set.name, faces_of(set.balls), set.pose, set.paint, set.group);
  for (const auto& s : world.segments) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = s.from;
    add(s.name, faces_of(rod(s.to - s.from)), pose, s.paint);
  }
  if (meshes.empty()) refuse(file, "there is nothing to draw");

  aiScene out;  // owns what is handed over
  const auto hand_over = [](auto& from, auto*** to, unsigned& count) {
    count = unsigned(from.size());
    *to = new std::remove_reference_t<decltype(**to)>[count];
    for (unsigned i = 0; i < count; ++i) (*to)[i] = from[i].release();
  };
  hand_over(meshes, &out.mMeshes, out.mNumMeshes);
  hand_over(materials, &out.mMaterials, out.mNumMaterials);
  const auto adopt = [&](aiNode& above, std::vector<std::unique_ptr<aiNode>>& below) {
    for (auto& node : below) node->mParent = &above;
    hand_over(below, &above.mChildren, above.mNumChildren);
  };
  for (auto& [name, members] : groups) {
    nodes.push_back(std::make_unique<aiNode>(scene_name(name)));
    adopt(*nodes.back(), members);
  }
  out.mRootNode = new aiNode("world");
  out.mRootNode->mTransformation = aiMatrix4x4(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);
  adopt(*out.mRootNode, nodes);
  Assimp::Exporter exporter;
  const aiExportDataBlob* blob = exporter.ExportToBlob(&out, "glb2");
  if (!blob) refuse(file, std::string("the scene cannot be written: ") + exporter.GetErrorString());
  write_bytes(file, {static_cast<const char*>(blob->data), blob->size});
}

}  // namespace clearance::io
