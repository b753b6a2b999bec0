// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Shapes of a scene, in glTF's terms, and the file that holds them.

#include <clearance/io/bytes.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/scene.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace clearance::io {

/// A name as glTF may hold it: valid UTF-8, and not too long for a viewer.
inline std::string scene_name(const std::string& name) { return shortened(printable(name), 1000); }

/// Triangles with a normal at each vertex, or points.
struct drawn_mesh {
  std::vector<vec3> positions, normals;
  std::vector<std::uint32_t> corners;  // three per triangle; empty: these are points
  std::vector<colour> colours = {};    // one per point, or empty
};

/// Throws std::invalid_argument if its arrays contradict one another.
inline void check(const drawn_mesh& mesh) {
  const std::size_t size = mesh.positions.size();
  const auto fits = [&](std::size_t n) { return n == size || n == 0; };
  if (!fits(mesh.colours.size()) || (mesh.normals.size() != size && !mesh.corners.empty()))
    throw std::invalid_argument("clearance: a mesh to draw has " + std::to_string(size) + " positions, but " +
                                std::to_string(mesh.normals.size()) + " normals and " +
                                std::to_string(mesh.colours.size()) + " colours");
  for (const std::uint32_t corner : mesh.corners)
    if (corner >= size || mesh.corners.size() % 3 != 0)
      throw std::invalid_argument("clearance: a mesh to draw has corners that are none of its " + std::to_string(size) +
                                  " positions, or no three of a triangle");
}

inline vec3 to_vec3(const Eigen::Vector3d& v) { return {float(v.x()), float(v.y()), float(v.z())}; }

/// Flat shading: each triangle has its own three vertices. Throws std::invalid_argument as check_corners.
inline drawn_mesh faces_of(const triangle_mesh& mesh) {
  check_corners(mesh);
  drawn_mesh out;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) -> const Eigen::Vector3d& { return mesh.vertices[t[k]]; };
    Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    normal = normal.norm() > 0 ? Eigen::Vector3d(normal / normal.norm()) : Eigen::Vector3d::UnitZ();
    for (std::size_t k = 0; k < 3; ++k) {
      out.corners.push_back(std::uint32_t(out.positions.size()));
      out.positions.push_back(to_vec3(corner(k)));
      out.normals.push_back(to_vec3(normal));
    }
  }
  return out;
}

/// The finite points; `colours`: one per point, or empty, else std::invalid_argument.
inline drawn_mesh points_of(const std::vector<vec3>& points, const std::vector<colour>& colours = {}) {
  if (!colours.empty() && colours.size() != points.size())
    throw std::invalid_argument("clearance: a scene has " + std::to_string(colours.size()) + " colours for " +
                                std::to_string(points.size()) + " points");
  drawn_mesh out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points[i])) continue;
    out.positions.push_back(points[i]);
    if (!colours.empty()) out.colours.push_back(colours[i]);
  }
  return out;
}

/// A square rod along `v`, because lines of one pixel are overlooked. Its width is 1 % of its length, but 1 to 10 mm.
inline triangle_mesh rod(const Eigen::Vector3d& v) {
  const double thick = std::min(0.01, std::max(0.001, 0.01 * v.norm())) / 2;
  const Eigen::Vector3d along = v.norm() > 0 ? Eigen::Vector3d(v.normalized()) : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d a = along.unitOrthogonal() * thick, b = along.cross(a);
  const Eigen::Vector3d end = v.norm() > thick ? v : Eigen::Vector3d(along * thick);
  triangle_mesh mesh;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(Eigen::Vector3d::Zero()), end})
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d(a + b), Eigen::Vector3d(b - a), Eigen::Vector3d(-a - b), Eigen::Vector3d(a - b)})
      mesh.vertices.push_back(at + corner);
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t n = (k + 1) % 4;
    mesh.triangles.push_back({k, n, n + 4});
    mesh.triangles.push_back({k, n + 4, k + 4});
  }
  return mesh;
}

/// Makes a binary glTF file: one node per mesh, below a node that turns z up into y up.
class glb_writer {
 public:
  explicit glb_writer(const std::string& file) : file_(file) {}

  /// Adds a mesh at `pose`; meshes with the name of a group are below a node of that name.
  void add(const std::string& name, const drawn_mesh& mesh, const Eigen::Isometry3d& pose, colour paint,
           const std::string& group) {
    if (!pose.matrix().allFinite()) refuse(file_, "the pose of a part of the scene is not finite");
    check(mesh);

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

    const json whole = {{"asset", {{"version", "2.0"}, {"generator", "clearance"}}},
                        {"scene", 0},
                        {"scenes", json::array({{{"nodes", json::array({root})}}})},
                        {"nodes", nodes},
                        {"meshes", meshes_},
                        {"materials", materials_},
                        {"accessors", accessors_},
                        {"bufferViews", views_},
                        {"buffers", json::array({{{"byteLength", data_.bytes().size()}}})}};

    std::string text = whole.dump(-1, ' ', false, json::error_handler_t::replace);  // what is not UTF-8 becomes U+FFFD
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

/// A unit sphere: an icosahedron whose triangles are each cut into four, `cuts` times.
inline triangle_mesh icosphere(int cuts) {
  constexpr double g = 1.6180339887498949;
  triangle_mesh mesh;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g}) {
      mesh.vertices.emplace_back(0, a, b);
      mesh.vertices.emplace_back(a, b, 0);
      mesh.vertices.emplace_back(b, 0, a);
    }
  for (auto& v : mesh.vertices) v.normalize();

  const auto near = [&](std::uint32_t i, std::uint32_t k) { return mesh.vertices[i].dot(mesh.vertices[k]) > 0.4; };
  for (std::uint32_t i = 0; i < 12; ++i)
    for (std::uint32_t j = i + 1; j < 12; ++j)
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(k, i)) continue;
        const bool outward = mesh.vertices[i].cross(mesh.vertices[j]).dot(mesh.vertices[k]) > 0;
        mesh.triangles.push_back({i, outward ? j : k, outward ? k : j});
      }

  for (; cuts > 0; --cuts) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
    const auto middle = [&](std::uint32_t i, std::uint32_t k) {
      const auto [at, is_new] = known.try_emplace(std::minmax(i, k), std::uint32_t(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back((mesh.vertices[i] + mesh.vertices[k]).normalized());
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) finer.push_back(t);
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// Smoothly shaded balls. Only the largest are fine, so that viewers can open a file with thousands of them.
inline drawn_mesh faces_of(const std::vector<ball>& balls) {
  static const triangle_mesh shapes[4] = {icosphere(0), icosphere(1), icosphere(2), icosphere(3)};
  std::vector<std::size_t> order(balls.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return balls[a].radius > balls[b].radius; });
  const auto shape = [](std::size_t rank) -> const triangle_mesh& {
    return shapes[rank < 1 ? 3 : rank < 6 ? 2 : rank < 48 ? 1 : 0];
  };
  drawn_mesh out;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const ball& b = balls[order[i]];
    const auto first = std::uint32_t(out.positions.size());
    for (const auto& t : shape(i).triangles)
      for (const std::uint32_t corner : t) out.corners.push_back(first + corner);
    for (const auto& n : shape(i).vertices) {
      out.normals.push_back(to_vec3(n));
      const vec3 m = out.normals.back();
      out.positions.push_back({b.center.x + b.radius * m.x, b.center.y + b.radius * m.y, b.center.z + b.radius * m.z});
    }
  }
  return out;
}

}  // namespace clearance::io
