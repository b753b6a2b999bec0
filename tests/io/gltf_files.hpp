// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Small glTF files of one mesh, in every way that a file can keep its numbers.

#include "io/scratch_file.hpp"

#include <nlohmann/json.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

/// The positions of a box with these sides, one corner at the origin, and its triangles, which face out.
struct box_mesh {
  std::vector<Eigen::Vector3f> corners;
  std::vector<std::uint16_t> indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  explicit box_mesh(const Eigen::Vector3f& sides) {
    for (int k = 0; k < 8; ++k)
      corners.push_back(sides.cwiseProduct(Eigen::Vector3f(float(k & 1), float(k >> 1 & 1), float(k >> 2))));
  }
  /// As glTF has it if what is up here, z, is y there.
  box_mesh y_up() const {
    box_mesh made = *this;
    for (auto& p : made.corners) p = Eigen::Vector3f(p.x(), p.z(), -p.y());
    return made;
  }
  std::string obj() const {
    std::string text;
    for (const auto& p : corners)
      text += "v " + std::to_string(p.x()) + ' ' + std::to_string(p.y()) + ' ' + std::to_string(p.z()) + '\n';
    for (std::size_t i = 0; i < indices.size(); i += 3)
      text += "f " + std::to_string(indices[i] + 1) + ' ' + std::to_string(indices[i + 1] + 1) + ' ' +
              std::to_string(indices[i + 2] + 1) + '\n';
    return text;
  }
  std::string data() const {
    std::string made;
    for (const auto& p : corners) made += raw_bytes(p.x(), p.y(), p.z());
    for (const auto i : indices) made += raw_bytes(i);
    return made;
  }
  nlohmann::json json() const {
    const std::size_t positions = 12 * corners.size(), all = data().size();
    nlohmann::json made = nlohmann::json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5123, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0}, {"buffer": 0}], "buffers": [{}]})");
    made["accessors"][0]["count"] = corners.size(), made["accessors"][1]["count"] = indices.size();
    made["bufferViews"][0]["byteLength"] = made["bufferViews"][1]["byteOffset"] = positions;
    made["bufferViews"][1]["byteLength"] = all - positions;
    made["buffers"][0]["byteLength"] = all;
    return made;
  }
};

inline std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string made;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) made += i + k > bytes.size() ? '=' : digits[three >> (18 - 6 * k) & 63];
  }
  return made;
}

inline std::string glb_of(std::string json, std::string data) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  data.resize((data.size() + 3) / 4 * 4, '\0');
  return "glTF" +
         raw_bytes(std::uint32_t(2), std::uint32_t(28 + json.size() + data.size()), std::uint32_t(json.size())) +
         "JSON" + json + raw_bytes(std::uint32_t(data.size())) + std::string("BIN\0", 4) + data;
}
inline std::string glb_of(const box_mesh& box) { return glb_of(box.json().dump(), box.data()); }

/// The text of a .gltf whose buffer is at `uri`.
inline std::string gltf_of(const box_mesh& box, const std::string& uri) {
  nlohmann::json json = box.json();
  json["buffers"][0]["uri"] = uri;
  return json.dump();
}
inline std::string data_uri(const box_mesh& box) {
  return "data:application/octet-stream;base64," + base64(box.data());
}
