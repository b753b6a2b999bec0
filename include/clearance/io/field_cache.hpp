// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Keeps the fields of a robot's parts in files, so that they are sampled only once.

#include <clearance/io/digest.hpp>
#include <clearance/io/kept_files.hpp>
#include <clearance/io/sealed_file.hpp>
#include <clearance/io/write_file.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/primitive/triangle.hpp>
#include <clearance/solid/winding.hpp>

#include <cstring>

namespace clearance::io {

// The .fields file: fields of a robot's parts, bound to the very parts that they were sampled from.
//
// Head and checksum are those of the .ist file, docs/packing.md#the-ist-format-version-1, with "FLD" in the first
// bytes. Each part: 16 bytes field_key, 8 bytes `bytes` of field_options, 8 bytes number of cells, then each
// field_cell: value (2), way (3), below, above, side. Numbers have their least byte first. Where cells are is computed
// from the part.

inline constexpr sealed_form fields_form{
    "\x89"
    "FLD\r\n\x1a\n",
    1, "a .fields file", ".fields files"};

/// Raise this whenever `with_fields` samples other cells of the same part, or a cell means something else.
inline constexpr std::uint32_t field_recipe = 1;

namespace detail {

/// The bits of values without padding.
template <class T>
void put_values(byte_writer& out, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
  out.put(std::uint64_t(values.size()));
  for (const std::uint8_t byte : digest_of({reinterpret_cast<const char*>(values.data()), values.size_bytes()}).bytes)
    out.put(byte);
}
inline void put_values(byte_writer& out, vec3 v) {
  out.put(v.x);
  out.put(v.y);
  out.put(v.z);
}

inline void put_interior(byte_writer& out, const no_interior&) { out.put(std::uint32_t(0)); }
inline void put_interior(byte_writer& out, const winding<>& solid) {
  static_assert(sizeof(crossing_triangle<real>) == 9 * sizeof(real));
  const auto& [triangles, cells, lists, enclosed, grid] = solid;
  out.put(std::uint32_t(1));
  put_values(out, std::span<const crossing_triangle<real>>(triangles));
  for (const auto* numbers : {&cells, &lists, &enclosed}) put_values(out, std::span<const std::uint32_t>(*numbers));
  for (int k = 0; k < 3; ++k) {
    out.put(grid.low[k]);
    out.put(grid.high[k]);
  }
  out.put(grid.per_y);
  out.put(grid.per_z);
  out.put(grid.columns);
  out.put(grid.rows);
}

inline void put_shape(byte_writer& out, const field_view& shape) {
  const auto& [cells, around, center, half, thickness, grids] = shape;
  static_cast<void>(cells);
  put_values(out, around.center);
  out.put(around.radius);
  put_values(out, center);
  put_values(out, half);
  out.put(thickness);
  for (const auto& [low, step, inverse, least, unit, error, size, first] : grids) {
    put_values(out, low);
    out.put(step);
    put_values(out, inverse);
    out.put(least);
    out.put(unit);
    out.put(error);
    for (const std::uint32_t along : size) out.put(along);
    out.put(first);
  }
}

}  // namespace detail

/// Parts whose fields can be told apart by their content: inner spheres or triangles of a listed tree.
template <class Part>
concept file_fielded = requires(const Part part, byte_writer out) {
  requires std::same_as<decltype(part.tree.primitives), std::vector<inner_sphere>> ||
               std::same_as<decltype(part.tree.primitives), std::vector<triangle>>;
  detail::put_interior(out, part.interior);
};

/// Covers, bit for bit, all that decides what a field of this shape may say: the part's primitives, its inside, its
/// ball and tolerance, and the version.
template <file_fielded Part>
digest field_key(const Part& part, const field_view& shape) {
  constexpr bool spheres = std::same_as<decltype(part.tree.primitives), std::vector<inner_sphere>>;
  static_assert(sizeof(inner_sphere) == 4 * sizeof(real) && sizeof(triangle) == 12 * sizeof(real));
  byte_writer out;
  out.put(std::string_view(spheres ? "clearance field of spheres" : "clearance field of triangles"));
  for (const std::uint32_t number : {field_recipe, std::uint32_t(CLEARANCE_VERSION)}) out.put(number);
  detail::put_values(out, std::span(part.tree.primitives));
  detail::put_interior(out, part.interior);
  detail::put_values(out, part.facts.center);
  out.put(part.facts.radius);
  out.put(part.facts.tolerance);
  detail::put_shape(out, shape);
  return digest_of(out.bytes());
}

namespace detail {

static_assert(sizeof(field_cell) == 8);

/// Swaps the bytes of values, if need be, to the order of a file: least byte first.
inline void swap_on_big_endian(std::span<field_cell> cells) {
  if constexpr (std::endian::native == std::endian::big)
    for (field_cell& c : cells) c.value = std::uint16_t(c.value << 8 | c.value >> 8);
}

template <class Part>
void put_field(byte_writer& out, const Part& part, const field<host>& f) {
  for (const std::uint8_t byte : field_key(part, f.shape).bytes) out.put(byte);
  out.put(std::uint64_t(f.bytes));
  out.put(std::uint64_t(f.cells.size()));
  auto cells = f.cells;
  swap_on_big_endian(cells);
  out.put(std::string_view(reinterpret_cast<const char*>(cells.data()), cells.size() * sizeof(field_cell)));
}

/// Only cells are taken from the file. Where they are is computed from the part, as when they were sampled.
template <class Part>
field<host> take_field(byte_reader& in, const Part& part, std::size_t number, const std::string& file) {
  const std::string of = "the field of part " + std::to_string(number);
  digest key;
  std::ranges::copy(in.take(key.bytes.size()), key.bytes.begin());
  const auto bytes = in.take<std::uint64_t>(), count = in.take<std::uint64_t>();
  if (bytes > in.left())
    refuse(file, of + " is said to be of " + std::to_string(bytes) + " bytes, which are not there");
  std::string why_not;
  auto made = minimum::field_of(part, {std::size_t(bytes)}, why_not);
  if (!made) refuse(file, of + ": " + why_not);
  if (field_key(part, made->shape) != key) refuse(file, of + " is of another part, or of another version of clearance");
  if (count != made->shape.all_cubes())
    refuse(file, of + " has " + std::to_string(count) + " cells instead of " + std::to_string(made->shape.all_cubes()));
  if (count > in.left() / sizeof(field_cell)) refuse(file, "ends in the middle of " + of);
  made->cells.resize(count);
  std::memcpy(made->cells.data(), in.take(count * sizeof(field_cell)).data(), count * sizeof(field_cell));
  swap_on_big_endian(made->cells);
  bool fine = true;
  for (const field_cell& c : made->cells)
    fine &= c.side <= field_side::unknown && c.way[0] != -128 && c.way[1] != -128 && c.way[2] != -128;
  if (!fine) refuse(file, of + " has a cell that no part has");
  return std::move(*made);
}

}  // namespace detail

/// The fields of a robot's parts. Throws std::invalid_argument if it has none, as when one part can have none.
template <file_fielded Part>
std::string fields_bytes(const model<Part>& robot) {
  if (robot.fields().empty()) throw std::invalid_argument("clearance::save_fields: the robot has no fields");
  byte_writer records;
  for (std::size_t k = 0; k < robot.size(); ++k) detail::put_field(records, robot.parts()[k], robot.fields()[k]);
  return sealed(fields_form, std::uint32_t(robot.size()), records.bytes());
}

/// Parses what `fields_bytes` made of these parts; error sentences name `file`.
template <file_fielded Part>
std::vector<field<host>> read_fields(std::string_view bytes, const std::string& file, std::span<const Part> parts) {
  unsealed records(bytes, file, fields_form);
  if (records.count != parts.size())
    refuse(file, "holds fields of " + std::to_string(records.count) + " parts, and the robot has " +
                     std::to_string(parts.size()));
  std::vector<field<host>> fields;
  for (const Part& part : parts) fields.push_back(detail::take_field(records.in, part, fields.size(), file));
  records.finish(file);
  return fields;
}

/// The same robot with the fields that `save_fields` wrote, to the bit. Throws std::runtime_error with a sentence for
/// any other file, as one of another robot: its bounds would be wrong.
template <file_fielded Part>
model<Part> load_fields(const std::string& file, model<Part> robot) {
  robot.set_fields(
      within_memory(file, [&] { return read_fields(read_bytes(file), file, std::span<const Part>(robot.parts())); }));
  return robot;
}

/// Saves the fields of a robot; where they were sampled does not matter. Throws std::invalid_argument if it has none,
/// or some that load_fields would refuse.
template <file_fielded Part>
void save_fields(const model<Part>& robot, const std::string& file) {
  const std::string bytes = fields_bytes(robot);
  try {
    read_fields(bytes, "clearance::save_fields", std::span<const Part>(robot.parts()));
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
  write_bytes(file, bytes);
}

/// Fields of single parts by field_key, each a .fields file in a folder of kept_files. What is damaged, or of another
/// part or version, counts as absent.
class field_cache {
 public:
  field_cache() = default;  ///< Keeps and finds nothing.
  explicit field_cache(std::filesystem::path folder) : files_(std::move(folder), ".fields") {}

  const std::filesystem::path& folder() const { return files_.folder(); }

  /// An empty one if there is none.
  template <file_fielded Part>
  field<host> find(const Part& part, const field_options& options) const {
    const auto [key, its] = of(part, options);
    if (!its) return {};
    return files_.find(key, [&](const std::string& file) -> field<host> {
      constexpr std::size_t besides = 28 + sizeof(digest) + 2 * sizeof(std::uint64_t);
      if (std::filesystem::file_size(file) != besides + its->shape.all_cubes() * sizeof(field_cell)) return {};
      return std::move(read_fields(read_bytes(file), file, std::span(&part, 1))[0]);
    });
  }
  /// Returns whether it is kept; a failure to write is no error.
  template <file_fielded Part>
  bool keep(const Part& part, const field<host>& made) const {
    return !made.empty() && files_.keep(field_key(part, made.shape), [&](const std::string& file) {
      byte_writer record;
      detail::put_field(record, part, made);
      write_bytes(file, sealed(fields_form, 1, record.bytes()));
    });
  }

 private:
  template <class Part>
  static std::pair<digest, std::optional<field<host>>> of(const Part& part, const field_options& options) {
    std::string why_not;
    auto unfilled = minimum::field_of(part, options, why_not);
    return {unfilled ? field_key(part, unfilled->shape) : digest{}, std::move(unfilled)};
  }

  kept_files files_;
};

/// A robot with fields, as by `with_fields`, and how many of them came from a cache.
template <class Model>
struct cached_fields : equipped<Model> {
  std::size_t found = 0;
};

/// As `with_fields`, but takes fields from the cache where they are, the same to the bit, and keeps those that it
/// samples. One that a device sampled may be found by a host: both are right, and no answer depends on it.
template <backend B, file_fielded Part>
cached_fields<model<Part>> with_fields_cached(const B& on, model<Part> robot, const field_options& options,
                                              const field_cache& cache) {
  std::size_t found = 0;
  auto made = clearance::detail::fielded_by(std::move(robot), [&](const Part& part, std::string& why_not) {
    if (field<host> kept = cache.find(part, options); !kept.empty()) {
      ++found;
      return kept;
    }
    field<host> fresh = minimum::sampled_field(on, part, options, why_not);
    cache.keep(part, fresh);
    return fresh;
  });
  return {std::move(made), found};
}

/// The robot with fields if the cache has those of all its parts, else as it is. Nothing is sampled.
template <file_fielded Part>
cached_fields<model<Part>> with_kept_fields(model<Part> robot, const field_options& options, const field_cache& cache) {
  std::vector<field<host>> kept;
  for (const Part& part : robot.parts()) {
    kept.push_back(cache.find(part, options));
    if (kept.back().empty()) break;
  }
  const std::size_t parts = robot.size(), found = kept.back().empty() ? 0 : parts;
  if (found > 0) robot.set_fields(std::move(kept));
  return {{std::move(robot), std::vector<std::string>(parts)}, found};
}

}  // namespace clearance::io
