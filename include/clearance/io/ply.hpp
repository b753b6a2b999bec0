// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/cloud.hpp>
#include <clearance/io/ply_check.hpp>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include <span>

namespace clearance::io {

/// Reads a PLY file from memory; `file` is its name in the cloud and in errors.
inline cloud read_ply(std::string_view bytes, const std::string& file) {
  const ply_vertices checked = check_ply(bytes, file);
  std::vector<Eigen::Vector3d> points;
  if (checked.count > 0) {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(checked.bytes.data(), checked.bytes.size(), 0, "ply");
    if (!scene || scene->mNumMeshes != 1) refuse(file, std::string("cannot be read as PLY: ") + importer.GetErrorString());
    const aiMesh& mesh = *scene->mMeshes[0];
    if (mesh.mNumVertices != checked.count)
      refuse(file, "the header says " + std::to_string(checked.count) + " vertices, read were " +
                       std::to_string(mesh.mNumVertices));
    points.reserve(mesh.mNumVertices);
    for (const aiVector3D& v : std::span(mesh.mVertices, mesh.mNumVertices)) {
      points.emplace_back(double(v.x), double(v.y), double(v.z));
      if (const double far = points.back().cwiseAbs().maxCoeff(); checked.doubles && std::isfinite(far) && far > 1024)
        refuse(file, "has double coordinates of " + std::to_string(far) +
                         " m, which would be rounded to float when read: convert it to PCD or XYZ");
    }
  }
  return make_cloud(file, points, points.size(), 1);
}

/// Reads the vertices of a PLY file, ascii or binary, in the file's order; faces are ignored. assimp rounds coordinates
/// to float, so doubles farther than 1024 m from 0 are refused: PCD and XYZ files keep them. Throws std::runtime_error.
inline cloud load_ply(const std::string& file) { return read_ply(read_bytes(file), file); }

}  // namespace clearance::io
