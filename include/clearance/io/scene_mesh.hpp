// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Shapes of a scene as assimp wants them.

#include <clearance/io/error.hpp>
#include <clearance/math.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/mesh.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <memory>
#include <string>
#include <vector>

namespace clearance::io {

/// 0 to 1 each.
struct colour {
  float red, green, blue, alpha;
};

/// A name as a glTF file may hold it, in valid UTF-8, and within the 1023 bytes that assimp would cut it to.
inline std::string scene_name(const std::string& name) { return shortened(printable(name), 1000); }

inline std::unique_ptr<aiMaterial> scene_material(const std::string& name, colour paint) {
  auto material = std::make_unique<aiMaterial>();
  const aiString label(name);
  const aiColor4D diffuse(paint.red, paint.green, paint.blue, paint.alpha);
  const float metallic = 0, roughness = 0.8f;
  const int both = 1;
  material->AddProperty(&label, AI_MATKEY_NAME);
  material->AddProperty(&diffuse, 1, AI_MATKEY_COLOR_DIFFUSE);
  material->AddProperty(&diffuse, 1, AI_MATKEY_BASE_COLOR);
  material->AddProperty(&metallic, 1, AI_MATKEY_METALLIC_FACTOR);
  material->AddProperty(&roughness, 1, AI_MATKEY_ROUGHNESS_FACTOR);
  material->AddProperty(&both, 1, AI_MATKEY_TWOSIDED);
  if (paint.alpha < 1) {
    const aiString blend("BLEND");
    material->AddProperty(&blend, AI_MATKEY_GLTF_ALPHAMODE);
  }
  return material;
}

/// Flat shading: each triangle has its own three vertices.
inline std::unique_ptr<aiMesh> faces_of(const triangle_mesh& mesh) {
  auto out = std::make_unique<aiMesh>();
  const auto count = unsigned(mesh.triangles.size());
  if (count == 0) return out;
  out->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  out->mNumVertices = 3 * count;
  out->mVertices = new aiVector3D[3 * count];
  out->mNormals = new aiVector3D[3 * count];
  out->mNumFaces = count;
  out->mFaces = new aiFace[count];
  for (unsigned t = 0; t < count; ++t) {
    const auto corner = [&](std::size_t k) -> const Eigen::Vector3d& { return mesh.vertices[mesh.triangles[t][k]]; };
    Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    normal = normal.norm() > 0 ? Eigen::Vector3d(normal / normal.norm()) : Eigen::Vector3d::UnitZ();
    out->mFaces[t].mNumIndices = 3;
    out->mFaces[t].mIndices = new unsigned[3]{3 * t, 3 * t + 1, 3 * t + 2};
    for (unsigned k = 0; k < 3; ++k) {
      const Eigen::Vector3d& c = corner(k);
      out->mVertices[3 * t + k] = aiVector3D(ai_real(c.x()), ai_real(c.y()), ai_real(c.z()));
      out->mNormals[3 * t + k] = aiVector3D(ai_real(normal.x()), ai_real(normal.y()), ai_real(normal.z()));
    }
  }
  return out;
}

/// glTF's POINTS mode; the colour is written with each vertex, which is where viewers look for it.
inline std::unique_ptr<aiMesh> points_of(const std::vector<vec3>& points, colour paint) {
  auto out = std::make_unique<aiMesh>();
  unsigned count = 0;
  for (const vec3 p : points) count += is_finite(p);
  if (count == 0) return out;
  out->mPrimitiveTypes = aiPrimitiveType_POINT;
  out->mNumVertices = out->mNumFaces = count;
  out->mVertices = new aiVector3D[count];
  out->mColors[0] = new aiColor4D[count];
  out->mFaces = new aiFace[count];
  unsigned i = 0;
  for (const vec3 p : points) {
    if (!is_finite(p)) continue;
    out->mVertices[i] = aiVector3D(p.x, p.y, p.z);
    out->mColors[0][i] = aiColor4D(paint.red, paint.green, paint.blue, paint.alpha);
    out->mFaces[i].mNumIndices = 1;
    out->mFaces[i].mIndices = new unsigned[1]{i};
    ++i;
  }
  return out;
}

/// A square rod along `v`, 1 % as thick as long and 1 to 10 mm: lines of one pixel are overlooked.
inline triangle_mesh rod(const Eigen::Vector3d& v) {
  const double thick = std::min(0.01, std::max(0.001, 0.01 * v.norm())) / 2;
  const Eigen::Vector3d along = v.norm() > 0 ? Eigen::Vector3d(v.normalized()) : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d a = along.unitOrthogonal() * thick, b = along.cross(a);
  const Eigen::Vector3d end = v.norm() > thick ? v : Eigen::Vector3d(along * thick);
  triangle_mesh mesh;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(Eigen::Vector3d::Zero()), end})
    for (const Eigen::Vector3d& corner : {Eigen::Vector3d(a + b), Eigen::Vector3d(b - a), Eigen::Vector3d(-a - b), Eigen::Vector3d(a - b)})
      mesh.vertices.push_back(at + corner);
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t n = (k + 1) % 4;
    mesh.triangles.push_back({k, n, n + 4});
    mesh.triangles.push_back({k, n + 4, k + 4});
  }
  return mesh;
}

}  // namespace clearance::io
