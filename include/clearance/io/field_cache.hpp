// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/fields_file.hpp>
#include <clearance/io/kept_files.hpp>

namespace clearance::io {

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
    auto its = clearance::detail::field_of(part, options, why_not);
    return {its ? field_key(part, its->shape) : digest{}, std::move(its)};
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
    if (field<host> kept = cache.find(part, options); !kept.empty()) return ++found, kept;
    field<host> fresh = clearance::detail::sampled_field(on, part, options, why_not);
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
