// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads the meshes of a glTF file, from wherever it keeps their numbers, and judges its extensions.

#include "io/gltf_json.hpp"
#include "io/mesh_polygons.hpp"
#include "io/note_tally.hpp"
#include "io/uri.hpp"

#include <clearance/io/bytes.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

// What a glTF file's extensions may change. Those about looks pass; those about shapes and places are refused by name;
// others are noted.

/// Is this extension about looks, sound or remarks, whatever it says?
inline bool gltf_looks(std::string_view extension) {
  for (const std::string_view of :
       {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_", "EXT_lights_", "KHR_xmp",
        "KHR_audio", "KHR_animation_", "KHR_techniques_webgl", "ADOBE_materials_", "MSFT_packing_", "EXT_mesh_features",
        "EXT_structural_metadata", "EXT_mesh_manifold", "KHR_mesh_quantization"})
    if (extension.starts_with(of)) return true;
  return false;
}

/// Does it hold or hide surfaces, or say where they are? What is packed may have a plain copy, which is then read.
inline bool gltf_shapes(std::string_view extension) {
  for (const std::string_view of : {"instancing", "visibility", "_lod", "splatting", "subdivision"})
    if (extension.find(of) != extension.npos) return true;
  return false;
}

/// Judges the extensions of something that has to do with surfaces.
inline void judge_gltf_extensions(const gltf_value& of, std::vector<std::string>& notes) {
  if (!of.has("extensions")) return;
  const gltf_value all = of["extensions"];
  if (!all.value.is_object()) all.refuse("is no object");
  for (const auto& [name, unused] : all.value.items()) {
    if (gltf_looks(name) || name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression") continue;
    if (gltf_shapes(name)) of.refuse("has the extension " + io::quoted(name) + ", which may change the shape");
    note_once(notes, "has the extension " + io::quoted(name) + ", which is not known, and is passed over");
  }
}

/// A file says which extensions it cannot do without.
inline void check_required_extensions(const gltf_value& root) {
  for (std::size_t i = 0; i < root.size("extensionsRequired"); ++i) {
    const gltf_value each = root["extensionsRequired"][i];
    if (!each.value.is_string()) each.refuse("is no name");
    const std::string name = each.value.get<std::string>();
    if (!gltf_looks(name)) root.refuse("requires the extension " + io::quoted(name) + ", which is not supported");
  }
}

// Where a glTF file keeps its numbers: in its binary chunk, in data URIs, and in files beside it; in no other place.

struct glb_chunks {
  std::string_view json;
  std::optional<std::string_view> data;
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
  return {*json, data};
}

/// The bytes that base64 spells; no value if it spells none.
inline std::optional<std::string> base64_decoded(std::string_view text) {
  if (text.size() % 4 == 0)
    for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string made;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const auto value = std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/").find(c);
    if (value == std::string_view::npos) return std::nullopt;
    bits = bits << 6 | std::uint32_t(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    made += char(std::uint8_t(bits >> count));
  }
  return made;
}

/// Reads each buffer when it is first asked for.
class gltf_buffers {
 public:
  /// `chunk`: the data in a binary glTF file; buffer 0 may be it. `path`: the glTF file.
  gltf_buffers(const gltf_value& root, std::optional<std::string_view> chunk, std::filesystem::path path,
               const mesh_limits& limits)
      : root_(root), chunk_(chunk), path_(std::move(path)), limits_(limits), kept_(root.size("buffers")) {}

  std::size_t size() const { return kept_.size(); }

  /// All `byteLength` bytes of a buffer.
  std::string_view operator[](std::size_t i) {
    if (kept_[i].seen) return kept_[i].bytes;
    const gltf_value buffer = root_["buffers"][i];
    buffer.only({"uri", "byteLength", "name", "extensions", "extras"});
    const std::uint64_t length = buffer["byteLength"].integer();
    std::string_view data;
    if (buffer.has("uri")) {
      kept_[i].own = outside(buffer["uri"]);
      data = kept_[i].own;
    } else {
      if (i != 0 || !chunk_) buffer.refuse("has neither a uri nor data in the file");
      data = *chunk_;
      if (data.size() > length && data.size() - length > 3)  // padded to multiples of 4
        buffer.refuse("is shorter than the data in the file");
    }
    if (length > data.size())
      buffer.refuse("is longer than its data, which has " + std::to_string(data.size()) + " bytes");
    kept_[i].seen = true;
    return kept_[i].bytes = data.substr(0, length);
  }

  /// Bytes of other files that were read.
  std::uint64_t bytes_of_others() const { return others_; }

 private:
  struct kept {
    bool seen = false;
    std::string own;
    std::string_view bytes;
  };

  /// What a uri holds or names.
  std::string outside(const gltf_value& at) {
    if (!at.value.is_string()) at.refuse("is no text");
    const std::string uri = at.value.get<std::string>();
    if (uri.starts_with("data:")) {
      const std::size_t comma = uri.find(',');
      if (comma == uri.npos || !std::string_view(uri).substr(0, comma).ends_with(";base64"))
        at.refuse("is a data URI that is not base64");
      auto made = base64_decoded(std::string_view(uri).substr(comma + 1));
      if (!made) at.refuse("is a data URI whose base64 is damaged");
      return std::move(*made);
    }
    const std::filesystem::path found = beside(uri, at);
    std::error_code failed;
    if (!std::filesystem::exists(found, failed)) at.refuse("names " + io::quoted(uri) + ", and there is no such file");
    if (!std::filesystem::is_regular_file(found, failed))
      at.refuse("names " + io::quoted(uri) + ", which is no regular file");
    const std::uint64_t size = std::filesystem::file_size(found, failed);
    if (!failed && size > limits_.bytes - std::min(limits_.bytes, others_))
      at.refuse("names " + io::quoted(uri) + ", which is longer than the limit leaves (mesh_limits::bytes)");
    std::string made = read_bytes(found.string());
    others_ += made.size();
    return made;
  }

  /// A file in the folder of the glTF file, or in that of the file which that is a link to.
  std::filesystem::path beside(const std::string& uri, const gltf_value& at) const {
    namespace fs = std::filesystem;
    const fs::path named(percent_decoded(uri));
    if (uri.empty() || uri.find("://") != uri.npos || named.is_absolute())
      at.refuse("names " + io::quoted(uri) + ", and only files beside this one are read");
    const fs::path found = written_path(path_.parent_path(), uri);
    std::error_code failed;
    const fs::path real = fs::weakly_canonical(fs::absolute(found), failed);
    for (const fs::path& home : {fs::absolute(path_.parent_path().empty() ? fs::path(".") : path_.parent_path()),
                                 fs::weakly_canonical(fs::absolute(path_), failed).parent_path()}) {
      const fs::path within = real.lexically_relative(fs::weakly_canonical(home, failed));
      if (!failed && !within.empty() && *within.begin() != "..") return found;
    }
    at.refuse("names " + io::quoted(uri) + ", and only files beside this one are read");
  }

  const gltf_value& root_;
  std::optional<std::string_view> chunk_;
  std::filesystem::path path_;
  const mesh_limits& limits_;
  std::vector<kept> kept_;
  std::uint64_t others_ = 0;
};

class gltf_data {
 public:
  gltf_data(const gltf_value& root, gltf_buffers& buffers, const mesh_limits& limits, std::vector<std::string>& notes)
      : root_(root), buffers_(buffers), limits_(limits), notes_(notes) {}

  /// The faces of one mesh, within limits: any number of primitives may use the same data. What moves vertices is
  /// refused; lines and points have no surface, and are noted.
  polygon_mesh mesh(const gltf_value& from) {
    from.only({"primitives", "weights", "name", "extensions", "extras"});
    judge_gltf_extensions(from, notes_);
    polygon_mesh made;
    for (std::size_t i = 0; i < from["primitives"].size(); ++i) {
      add(from["primitives"][i], made);
      if (made.ends.size() > limits_.triangles || made.vertices.size() / 3 > limits_.triangles)
        from.refuse("has, with all its primitives, more than the " + std::to_string(limits_.triangles) +
                    " triangles that the limit leaves (mesh_limits::triangles)");
    }
    return made;
  }

 private:
  void add(const gltf_value& primitive, polygon_mesh& made) {
    primitive.only({"attributes", "indices", "material", "mode", "targets", "extensions", "extras"});
    judge_gltf_extensions(primitive, notes_);
    if (primitive.has("targets")) primitive.refuse("has morph targets, which are not supported");
    const std::uint64_t mode = primitive.integer("mode", 4);
    if (mode > 6) primitive.refuse("has the mode " + std::to_string(mode) + ", which is not known");
    if (mode < 4) return note_once(notes_, "has points or lines, which have no surface, and are passed over");
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
  }

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
  view open(const gltf_value& accessor, std::size_t size, std::size_t component) {
    accessor.only({"bufferView", "byteOffset", "componentType", "normalized", "count", "type", "max", "min", "sparse",
                   "name", "extensions", "extras"});
    judge_gltf_extensions(accessor, notes_);
    if (accessor.has("sparse")) accessor.refuse("is sparse, which is not supported");
    if (!accessor.has("bufferView")) accessor.refuse("has no data (compressed by an extension?)");
    const gltf_value from = root_["bufferViews"][accessor["bufferView"].index(root_.size("bufferViews"))];
    from.only({"buffer", "byteOffset", "byteLength", "byteStride", "target", "name", "extensions", "extras"});
    judge_gltf_extensions(from, notes_);
    const std::string_view data = buffers_[from["buffer"].index(buffers_.size())];
    const std::uint64_t at = from.integer("byteOffset", 0), length = from["byteLength"].integer(),
                        offset = accessor.integer("byteOffset", 0), count = accessor["count"].integer(),
                        stride = from.integer("byteStride", size);
    if (at > data.size() || length > data.size() - at) from.refuse("is not inside its buffer");
    if (count == 0) accessor.refuse("has the count 0");
    if (stride < size || stride > 252) from.refuse("has the stride " + std::to_string(stride));
    if (stride % component) from.refuse("has the stride " + std::to_string(stride) + ", which is not aligned");
    if ((at + offset) % component) accessor.refuse("is not aligned in its buffer");
    if (offset > length || size > length - offset || (count - 1) > (length - offset - size) / stride)
      accessor.refuse("is not inside its view");
    return {data.substr(at + offset, (count - 1) * stride + size), std::size_t(count), std::size_t(stride)};
  }

  gltf_value accessor(const gltf_value& index) const {
    return root_["accessors"][index.index(root_.size("accessors"))];
  }

  static bool normalized(const gltf_value& accessor) {
    if (!accessor.has("normalized")) return false;
    if (!accessor["normalized"].value.is_boolean()) accessor["normalized"].refuse("is neither true nor false");
    return accessor["normalized"].value.get<bool>();
  }

  /// May positions be whole numbers, which the node's scale makes metres?
  bool quantized() const {
    for (std::size_t i = 0; i < root_.size("extensionsUsed"); ++i)
      if (root_["extensionsUsed"][i].value == "KHR_mesh_quantization") return true;
    return false;
  }

  /// One whole number as a coordinate.
  template <class T>
  static double coordinate(byte_reader& reader, bool normalized) {
    const auto raw = reader.take<std::make_unsigned_t<T>>();
    const double value = double(static_cast<T>(raw));
    return normalized ? std::max(value / double(std::numeric_limits<T>::max()), -1.0) : value;
  }

  void positions(const gltf_value& index, std::vector<Eigen::Vector3d>& to) {
    const gltf_value from = accessor(index);
    const std::uint64_t kind = from["componentType"].integer();
    const std::size_t size = kind == 5126 ? 4 : kind == 5120 || kind == 5121 ? 1 : kind == 5122 || kind == 5123 ? 2 : 0;
    const bool scaled = normalized(from);
    if (from["type"].value != "VEC3" || size == 0 || (size < 4 && !quantized()) || (size == 4 && scaled))
      from.refuse("of positions does not hold three floats each");
    const view values = open(from, 3 * size, size);
    for (std::size_t i = 0; i < values.count; ++i) {
      byte_reader reader(values.bytes.substr(i * values.stride, 3 * size), root_.file);
      Eigen::Vector3d v;
      for (double& x : v)
        x = kind == 5126   ? double(reader.take<float>())
            : kind == 5120 ? coordinate<std::int8_t>(reader, scaled)
            : kind == 5121 ? coordinate<std::uint8_t>(reader, scaled)
            : kind == 5122 ? coordinate<std::int16_t>(reader, scaled)
                           : coordinate<std::uint16_t>(reader, scaled);
      if (!v.allFinite()) from.refuse("has a coordinate that is not finite");
      to.push_back(v);
    }
  }

  std::vector<std::uint32_t> indices(const gltf_value& index, std::size_t vertices) {
    const gltf_value from = accessor(index);
    const std::uint64_t kind = from["componentType"].integer();
    const std::size_t size = kind == 5121 ? 1 : kind == 5123 ? 2 : kind == 5125 ? 4 : 0;
    if (from["type"].value != "SCALAR" || size == 0 || normalized(from))
      from.refuse("of indices does not hold whole numbers");
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
  gltf_buffers& buffers_;
  const mesh_limits& limits_;
  std::vector<std::string>& notes_;
};

}  // namespace clearance::io
