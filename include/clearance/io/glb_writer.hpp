// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/bytes.hpp>
#include <clearance/io/scene_mesh.hpp>

#include <nlohmann/json.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearance::io {

/// Makes a binary glTF file: one node per mesh, below a node that turns z up into y up.
class glb_writer {
 public:
  explicit glb_writer(const std::string& file) : file_(file) {}

  /// Adds a mesh at `pose`; meshes with the name of a group are below a node of that name.
  void add(const std::string& name, const drawn_mesh& mesh, const Eigen::Isometry3d& pose, colour paint,
           const std::string& group) {
    if (!pose.matrix().allFinite()) refuse(file_, "the pose of a part of the scene is not finite");
    json primitive = {{"material", materials_.size()}, {"attributes", {{"POSITION", positions(mesh.positions)}}}};
    if (mesh.corners.empty()) {
      primitive["mode"] = 0;  // points; each vertex carries its colour, because viewers look for it there
      std::vector<float> colours;
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const colour& c = mesh.colours.empty() ? paint : mesh.colours[i];
        colours.insert(colours.end(), {c.red, c.green, c.blue, c.alpha});
      }
      primitive["attributes"]["COLOR_0"] = accessor(colours, 4, "VEC4", vertex_data);
    } else {
      primitive["attributes"]["NORMAL"] = accessor(flat(mesh.normals), 3, "VEC3", vertex_data);
      primitive["indices"] = accessor(mesh.corners, 1, "SCALAR", index_data);
    }
    json material = {{"name", name},
                     {"doubleSided", true},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {paint.red, paint.green, paint.blue, paint.alpha}},
                       {"metallicFactor", 0},
                       {"roughnessFactor", 0.8}}}};
    if (paint.alpha < 1) material["alphaMode"] = "BLEND";
    materials_.push_back(std::move(material));
    json node = {{"name", name}, {"mesh", meshes_.size()}};
    for (int i = 0; i < 16; ++i) node["matrix"].push_back(pose.matrix()(i % 4, i / 4));
    meshes_.push_back({{"name", name}, {"primitives", json::array({std::move(primitive)})}});
    json* above = &top_;
    if (!group.empty()) {
      auto at = std::ranges::find(groups_, group, [](const auto& each) { return each.first; });
      if (at == groups_.end()) at = groups_.emplace(at, group, json::array());
      above = &at->second;
    }
    above->push_back(nodes_.size());
    nodes_.push_back(std::move(node));
  }

  /// The whole file. An empty scene, and one beyond 4 GiB, is refused.
  std::string bytes() const {
    if (nodes_.empty()) refuse(file_, "there is nothing to draw");
    json nodes = nodes_, below = top_;
    for (const auto& [name, members] : groups_) {
      below.push_back(nodes.size());
      nodes.push_back({{"name", name}, {"children", members}});
    }
    const std::size_t root = nodes.size();
    nodes.push_back(
        {{"name", "world"}, {"matrix", {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}}, {"children", below}});
    const json all = {{"asset", {{"version", "2.0"}, {"generator", "clearance"}}},
                      {"scene", 0},
                      {"scenes", json::array({{{"nodes", json::array({root})}}})},
                      {"nodes", nodes},
                      {"meshes", meshes_},
                      {"materials", materials_},
                      {"accessors", accessors_},
                      {"bufferViews", views_},
                      {"buffers", json::array({{{"byteLength", data_.bytes().size()}}})}};
    std::string text = all.dump(-1, ' ', false, json::error_handler_t::replace);  // what is not UTF-8 becomes U+FFFD
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t size = 28 + text.size() + data_.bytes().size();
    if (size > UINT32_MAX) refuse(file_, "a scene of more than 4 GiB cannot be written as glTF");
    byte_writer out;
    out.reserve(size);
    out.put(std::string_view("glTF"));
    for (const std::uint32_t word : {std::uint32_t(2), std::uint32_t(size), std::uint32_t(text.size())}) out.put(word);
    out.put(std::string_view("JSON"));
    out.put(std::string_view(text));
    out.put(std::uint32_t(data_.bytes().size()));
    out.put(std::string_view("BIN\0", 4));
    out.put(std::string_view(data_.bytes()));
    return out.bytes();
  }

 private:
  using json = nlohmann::json;
  static constexpr int vertex_data = 34962, index_data = 34963;  // glTF's numbers for them

  static std::vector<float> flat(const std::vector<vec3>& values) {
    std::vector<float> made;
    for (const vec3 v : values) made.insert(made.end(), {v.x, v.y, v.z});
    return made;
  }

  template <class T>
  std::size_t accessor(const std::vector<T>& values, std::size_t width, const char* type, int target) {
    const std::size_t at = data_.bytes().size();
    for (const T value : values) data_.put(value);
    accessors_.push_back({{"bufferView", views_.size()},
                          {"componentType", target == index_data ? 5125 : 5126},
                          {"count", values.size() / width},
                          {"type", type}});
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", at}, {"byteLength", data_.bytes().size() - at}, {"target", target}});
    return accessors_.size() - 1;
  }

  std::size_t positions(const std::vector<vec3>& values) {
    const std::size_t made = accessor(flat(values), 3, "VEC3", vertex_data);
    vec3 low = values.front(), high = low;
    for (const vec3 v : values) {
      if (!is_finite(v)) refuse(file_, "a vertex of the scene is beyond what a float can hold");
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    accessors_[made]["min"] = {low.x, low.y, low.z};
    accessors_[made]["max"] = {high.x, high.y, high.z};
    return made;
  }

  const std::string& file_;
  byte_writer data_;
  json meshes_ = json::array(), materials_ = json::array(), nodes_ = json::array(), accessors_ = json::array(),
       views_ = json::array(), top_ = json::array();
  std::vector<std::pair<std::string, json>> groups_;  // names, and the numbers of their member nodes
};

}  // namespace clearance::io
