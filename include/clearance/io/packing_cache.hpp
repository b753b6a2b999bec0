// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Keeps packings in files, so that a mesh is packed only once with the same options.

#include <clearance/io/digest.hpp>
#include <clearance/io/kept_files.hpp>
#include <clearance/packing/packing.hpp>
#include <clearance/solid/close_mesh.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <ranges>
#include <span>
#include <string_view>
#include <vector>

namespace clearance {
class mesh_solid;
}  // namespace clearance

namespace clearance::io {

/// Raise this whenever `pack` makes other spheres from the same solid and options.
inline constexpr std::uint32_t packing_recipe = 4;

/// Covers everything that decides a packing: mesh, options, algorithm. `maker` names the algorithm.
digest packing_key(const closed_mesh& mesh, const pack_options& options, std::string_view maker = "host");

/// Packings by packing_key, each an .ist file in a folder of kept_files. A file made for another key counts as absent.
class packing_cache {
 public:
  packing_cache() = default;  ///< Keeps and finds nothing.
  explicit packing_cache(std::filesystem::path folder) : files_(std::move(folder), ".ist") {}

  /// $CLEARANCE_CACHE (set but empty: no cache), else $XDG_CACHE_HOME/clearance, else ~/.cache/clearance, else no
  /// cache.
  static std::filesystem::path usual_folder();

  const std::filesystem::path& folder() const { return files_.folder(); }
  std::filesystem::path file(const digest& key) const { return files_.file(key); }

  std::optional<packing> find(const digest& key) const;

  /// Returns whether it is kept; a failure to write is no error.
  bool keep(const digest& key, const digest& solid, const packing& made) const;

 private:
  kept_files files_;
};

struct cached_packing {
  packing made;
  bool found = false;  ///< Taken from the cache; `pack` did not run.
};

/// A function that packs one solid; if it is empty, `pack` on the host does.
using pack_by = std::function<packing(const mesh_solid&, const pack_options&)>;

/// Calls `make(mesh_solid(mesh), options)` once per mesh and options. Afterwards the packing comes from the cache, the
/// same to the bit (`seconds` is the time it took originally). A packing cut short by a time limit or a person is not
/// kept. `maker` names the algorithm, because a device's makes other spheres than the host's. Throws as `make` does.
cached_packing pack_cached(const closed_mesh& mesh, const pack_options& options, const packing_cache& cache,
                           std::string_view maker = "host", const pack_by& make = {});

/// The same for several closed meshes, side by side as by `pack`; each is kept as soon as it is done. Equal meshes, as
/// of a left and a right link, are packed once. Several threads call `make` at once, and `finished` with how many more
/// meshes are done.
std::vector<cached_packing> pack_cached(std::span<const closed_mesh* const> meshes, const pack_options& options,
                                        const packing_cache& cache, std::string_view maker = "host",
                                        const pack_by& make = {},
                                        const std::function<void(std::size_t)>& finished = {});
template <std::ranges::random_access_range R>
  requires std::same_as<std::ranges::range_value_t<R>, closed_mesh> &&
           std::is_lvalue_reference_v<std::ranges::range_reference_t<const R>>
std::vector<cached_packing> pack_cached(const R& meshes, const pack_options& options, const packing_cache& cache,
                                        std::string_view maker = "host", const pack_by& make = {},
                                        const std::function<void(std::size_t)>& finished = {}) {
  std::vector<const closed_mesh*> given;
  for (const closed_mesh& mesh : meshes) given.push_back(&mesh);
  return pack_cached(std::span<const closed_mesh* const>(given), options, cache, maker, make, finished);
}

}  // namespace clearance::io
