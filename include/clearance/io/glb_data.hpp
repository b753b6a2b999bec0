// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The chunks, accessors and meshes of a binary glTF file.

#include <clearance/io/bytes.hpp>
#include <clearance/io/gltf_json.hpp>
#include <clearance/io/mesh_polygons.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

struct glb_chunks {
  std::string_view json, data;
};

inline glb_chunks read_glb_chunks(std::string_view bytes, const std::string& file) {
  if (bytes.size() < 20 || !bytes.starts_with("glTF")) refuse(file, "is not a binary glTF file");
  byte_reader reader(bytes.substr(4), file);
  if (const auto version = reader.take<std::uint32_t>(); version != 2)
    refuse(file, "is binary glTF of version " + std::to_string(version) + ", not 2");
  if (const auto size = reader.take<std::uint32_t>(); size != bytes.size())
    refuse(file, "says it has " + std::to_string(size) + " bytes, but it has " + std::to_string(bytes.size()));
  std::optional<std::string_view> json, data;
  while (reader.left() > 0) {
    if (reader.left() < 8) refuse(file, "is cut short within the head of a chunk");
    const auto size = reader.take<std::uint32_t>(), kind = reader.take<std::uint32_t>();
    if (size > reader.left()) refuse(file, "is cut short within a chunk");
    const std::string_view chunk = reader.take(size);
    constexpr std::uint32_t json_kind = 0x4e4f534a, data_kind = 0x004e4942;
    if ((kind == json_kind) == json.has_value() || (kind == data_kind && data))
      refuse(file, "does not begin with one chunk of JSON and at most one of data");
    if (kind == json_kind) json = chunk;
    if (kind == data_kind) data = chunk;
  }
  if (!json) refuse(file, "has no JSON");
  return {*json, data.value_or(std::string_view())};
}

class glb_data {
 public:
  glb_data(const gltf_value& root, std::string_view data, const mesh_limits& limits)
      : root_(root), data_(data), limits_(limits) {}

  /// The faces of one mesh, within limits: any number of primitives may use the same data. Points, lines, and
  /// everything that moves vertices are refused.
  polygon_mesh mesh(const gltf_value& from) const {
    from.only({"primitives", "weights", "name", "extensions", "extras"});
    polygon_mesh made;
    for (std::size_t i = 0; i < from["primitives"].size(); ++i) {
      const gltf_value primitive = from["primitives"][i];
      primitive.only({"attributes", "indices", "material", "mode", "targets", "extensions", "extras"});
      if (primitive.has("targets")) primitive.refuse("has morph targets, which are not supported");
      const std::uint64_t mode = primitive.integer("mode", 4);
      if (mode < 4 || mode > 6)
        primitive.refuse("has the mode " + std::to_string(mode) + ", which is none of triangles");
      const gltf_value attributes = primitive["attributes"];
      const std::size_t first = made.vertices.size();
      for (const auto& [key, unused] : attributes.value.items()) check_attribute(attributes, key);
      positions(attributes["POSITION"], made.vertices);
      const std::size_t count = made.vertices.size() - first;
      std::vector<std::uint32_t> corners;
      if (primitive.has("indices")) {
        corners = indices(primitive["indices"], count);
      } else {
        for (std::size_t k = 0; k < count; ++k) corners.push_back(std::uint32_t(k));
      }
      if (corners.size() < 3 || (mode == 4 && corners.size() % 3))
        primitive.refuse("has " + std::to_string(corners.size()) + " corners, which make no triangles");
      for (std::size_t k = 2; k < corners.size(); k += mode == 4 ? 3 : 1) {
        const bool odd = mode == 5 && k % 2;
        for (const std::size_t c : {mode == 6 ? 0 : k - 2 + odd, k - 1 - odd, k})
          made.corners.push_back(std::uint32_t(first + corners[c]));
        made.ends.push_back(made.corners.size());
      }
      if (made.ends.size() > limits_.triangles || made.vertices.size() / 3 > limits_.triangles)
        from.refuse("has, with all its primitives, more than the " + std::to_string(limits_.triangles) +
                    " triangles that the limit leaves (mesh_limits::triangles)");
    }
    return made;
  }

 private:
  static void check_attribute(const gltf_value& attributes, const std::string& key) {
    for (const char* known : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_", "_"})
      if (key.starts_with(known)) return;
    attributes.refuse("has " + io::quoted(key) + ", which is not known");
  }

  struct view {
    std::string_view bytes;
    std::size_t count, stride;
  };

  /// The bytes of an accessor whose elements have this size, inside its buffer. glTF aligns each component to its own
  /// size, so an offset that is not aligned is damaged.
  view open(const gltf_value& accessor, std::size_t size, std::size_t component) const {
    accessor.only({"bufferView", "byteOffset", "componentType", "normalized", "count", "type", "max", "min", "sparse",
                   "name", "extensions", "extras"});
    if (accessor.has("sparse")) accessor.refuse("is sparse, which is not supported");
    if (accessor.has("normalized") && accessor["normalized"].value != false)
      accessor.refuse("is normalized, which is not supported");
    const auto views = root_.size("bufferViews"), buffers = root_.size("buffers");
    const gltf_value from = root_["bufferViews"][accessor["bufferView"].index(views)];
    from.only({"buffer", "byteOffset", "byteLength", "byteStride", "target", "name", "extensions", "extras"});
    const gltf_value buffer = root_["buffers"][from["buffer"].index(buffers)];
    buffer.only({"uri", "byteLength", "name", "extensions", "extras"});
    if (buffer.has("uri")) buffer.refuse("is outside of the file, where nothing is looked up");
    if (from["buffer"].integer() != 0) from.refuse("is in a buffer that is not in the file");
    const std::uint64_t whole = buffer["byteLength"].integer(), at = from.integer("byteOffset", 0),
                        length = from["byteLength"].integer(), offset = accessor.integer("byteOffset", 0),
                        count = accessor["count"].integer(), stride = from.integer("byteStride", size);
    if (whole > data_.size()) buffer.refuse("is longer than the data in the file");
    if (data_.size() - whole > 3) buffer.refuse("is shorter than the data in the file");  // padded to multiples of 4
    if (at > whole || length > whole - at) from.refuse("is not inside its buffer");
    if (count == 0) accessor.refuse("has the count 0");
    if (stride < size || stride > 252) from.refuse("has the stride " + std::to_string(stride));
    if (stride % component) from.refuse("has the stride " + std::to_string(stride) + ", which is not aligned");
    if ((at + offset) % component) accessor.refuse("is not aligned in its buffer");
    if (offset > length || size > length - offset || (count - 1) > (length - offset - size) / stride)
      accessor.refuse("is not inside its view");
    return {data_.substr(at + offset, (count - 1) * stride + size), std::size_t(count), std::size_t(stride)};
  }

  gltf_value accessor(const gltf_value& index) const {
    return root_["accessors"][index.index(root_.size("accessors"))];
  }

  void positions(const gltf_value& index, std::vector<Eigen::Vector3d>& to) const {
    const gltf_value from = accessor(index);
    if (from["type"].value != "VEC3" || from["componentType"].integer() != 5126)
      from.refuse("of positions does not hold three floats each");
    const view values = open(from, 12, 4);
    for (std::size_t i = 0; i < values.count; ++i) {
      byte_reader reader(values.bytes.substr(i * values.stride, 12), root_.file);
      Eigen::Vector3d v;
      for (double& x : v) x = double(reader.take<float>());
      if (!v.allFinite()) from.refuse("has a coordinate that is not finite");
      to.push_back(v);
    }
  }

  std::vector<std::uint32_t> indices(const gltf_value& index, std::size_t vertices) const {
    const gltf_value from = accessor(index);
    const std::uint64_t kind = from["componentType"].integer();
    const std::size_t size = kind == 5121 ? 1 : kind == 5123 ? 2 : kind == 5125 ? 4 : 0;
    if (from["type"].value != "SCALAR" || size == 0) from.refuse("of indices does not hold whole numbers");
    const view values = open(from, size, size);
    if (values.stride != size) from.refuse("of indices has a stride");
    std::vector<std::uint32_t> made;
    for (std::size_t i = 0; i < values.count; ++i) {
      byte_reader reader(values.bytes.substr(i * size, size), root_.file);
      made.push_back(size == 1   ? reader.take<std::uint8_t>()
                     : size == 2 ? reader.take<std::uint16_t>()
                                 : reader.take<std::uint32_t>());
      if (made.back() >= vertices)
        from.refuse("has the vertex " + std::to_string(made.back()) + ", of " + std::to_string(vertices));
    }
    return made;
  }

  const gltf_value& root_;
  std::string_view data_;
  const mesh_limits& limits_;
};

}  // namespace clearance::io
