// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/error.hpp>
#include <clearance/io/mesh_polygons.hpp>

#include <assimp/config.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearance::io {

/// Ends with a sentence where the length of a binary glTF file, its first chunk or the depth of its JSON is wrong.
inline void check_glb(std::string_view bytes, const std::string& file) {
  const auto word = [&](std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  if (bytes.size() < 20 || !bytes.starts_with("glTF")) refuse(file, "is not a binary glTF file");
  if (word(8) != bytes.size())
    refuse(file, "says it has " + std::to_string(word(8)) + " bytes, but it has " + std::to_string(bytes.size()));
  if (word(12) > bytes.size() - 20) refuse(file, "is cut short within its first chunk");
  int depth = 0;
  bool quoted = false;
  const std::string_view json = bytes.substr(20, word(12));
  if (json.find("\"sparse\"") != json.npos)  // assimp 5.2 writes wherever such indices say
    refuse(file, "has sparse accessors, which are not supported");
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (json[i] == '\\')
      ++i;
    else if (json[i] == '"')
      quoted = !quoted;
    else if (!quoted && (json[i] == '[' || json[i] == '{') && ++depth > 100)
      refuse(file, "its JSON is nested too deep");
    else if (!quoted && (json[i] == ']' || json[i] == '}'))
      --depth;
  }
}

/// All meshes of a scene that assimp can read, each at every place where its scene graph has it. A COLLADA file's unit
/// counts and its up axis does not, as in ROS tools. A mirrored place turns its faces round, so that they face out.
inline polygon_mesh read_scene(std::string_view bytes, const std::string& format, const std::string& file) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format.c_str());
  if (!scene || !scene->mRootNode || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE))
    refuse(file, std::string("cannot be read: ") +
                     (*importer.GetErrorString() ? importer.GetErrorString() : "it is incomplete"));

  polygon_mesh made;
  std::vector<std::pair<const aiNode*, Eigen::Affine3d>> pending{{scene->mRootNode, Eigen::Affine3d::Identity()}};
  while (!pending.empty()) {
    const auto [node, above] = pending.back();
    pending.pop_back();
    const aiMatrix4x4& m = node->mTransformation;
    Eigen::Affine3d here;
    here.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, 0, 0, 0, 1;
    here = above * here;
    const bool mirrored = here.linear().determinant() < 0;
    for (unsigned k = node->mNumChildren; k-- > 0;) pending.emplace_back(node->mChildren[k], here);
    for (unsigned k = 0; k < node->mNumMeshes; ++k) {
      const aiMesh& mesh = *scene->mMeshes[node->mMeshes[k]];
      const std::size_t first = made.vertices.size();
      if (first + mesh.mNumVertices > UINT32_MAX) refuse(file, "has more vertices than can be counted");
      for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        const aiVector3D& v = mesh.mVertices[i];
        made.vertices.push_back(here * Eigen::Vector3d(v.x, v.y, v.z));
        if (!made.vertices.back().allFinite()) refuse(file, "a vertex has a coordinate that is not finite");
      }
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices < 3) continue;  // points and lines
        for (unsigned i = 0; i < face.mNumIndices; ++i) {
          const unsigned index = face.mIndices[mirrored ? face.mNumIndices - 1 - i : i];
          if (index >= mesh.mNumVertices)
            refuse(file, "a face has vertex " + std::to_string(index) + ", of " + std::to_string(mesh.mNumVertices));
          made.corners.push_back(std::uint32_t(first + index));
        }
        made.ends.push_back(made.corners.size());
      }
    }
  }
  return made;
}

}  // namespace clearance::io
