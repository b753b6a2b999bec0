// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Keeps packings in files, so that a mesh is packed only once with the same options.

#include <clearance/io/ist.hpp>
#include <clearance/io/kept_files.hpp>
#include <clearance/packing/pack.hpp>

#include <cstdlib>
#include <optional>

namespace clearance::io {

/// Raise this whenever `pack` makes other spheres from the same solid and options.
inline constexpr std::uint32_t packing_recipe = 4;

/// Covers everything that decides a packing: mesh, options, algorithm. `maker` names the algorithm.
inline digest packing_key(const closed_mesh& mesh, const pack_options& options, std::string_view maker = "host") {
  // If pack_options gains a member, this does not compile: does the new one change the spheres?
  const auto& [count, smallest_radius, gap_target, seconds, seed, threads, gap_per_radius, allow_overlap, gap_tolerance,
               progress, cancelled] = options;
  byte_writer out;
  out.put(std::string_view("clearance packing"));
  for (const std::uint32_t number :
       {packing_recipe, ist_version, std::uint32_t(CLEARANCE_VERSION), std::uint32_t(maker.size())})
    out.put(number);
  out.put(maker);
  for (const std::uint8_t byte : digest_of(mesh).bytes) out.put(byte);
  for (const std::uint64_t number : {std::uint64_t(count), std::uint64_t(seed), std::uint64_t(allow_overlap)})
    out.put(number);
  for (const double number : {smallest_radius, gap_target, gap_per_radius, gap_tolerance}) out.put(number);
  (void)seconds, (void)threads, (void)progress, (void)cancelled;  // a packing that one of these stopped is not kept
  return digest_of(out.bytes());
}

/// Packings by packing_key, each an .ist file in a folder of kept_files. A file made for another key counts as absent.
class packing_cache {
 public:
  packing_cache() = default;  ///< Keeps and finds nothing.
  explicit packing_cache(std::filesystem::path folder) : files_(std::move(folder), ".ist") {}

  /// $CLEARANCE_CACHE (set but empty: no cache), else $XDG_CACHE_HOME/clearance, else ~/.cache/clearance, else no
  /// cache.
  static std::filesystem::path usual_folder() {
    if (const char* own = std::getenv("CLEARANCE_CACHE")) return own;
    const auto below = [](const char* variable, const char* path) {
      const char* value = std::getenv(variable);
      const std::filesystem::path at = value ? value : "";
      return at.is_absolute() ? at / path : std::filesystem::path();
    };
    const auto standard = below("XDG_CACHE_HOME", "clearance");
    return standard.empty() ? below("HOME", ".cache/clearance") : standard;
  }

  const std::filesystem::path& folder() const { return files_.folder(); }
  std::filesystem::path file(const digest& key) const { return files_.file(key); }

  std::optional<packing> find(const digest& key) const {
    return files_.find(key, [&](const std::string& file) -> std::optional<packing> {
      auto parts = load_ist(file);
      if (parts.size() == 1 && parts[0].recipe == key) return std::move(parts[0].spheres);
      return {};
    });
  }

  /// Returns whether it is kept; a failure to write is no error.
  bool keep(const digest& key, const digest& solid, const packing& made) const {
    return !made.spheres.empty() && files_.keep(key, [&](const std::string& file) {
      save_ist(std::vector{packed_part{.name = "", .spheres = made, .solid = solid, .recipe = key}}, file);
    });
  }

 private:
  kept_files files_;
};

struct cached_packing {
  packing made;
  bool found = false;  ///< Taken from the cache; `pack` did not run.
};

/// Calls `make(mesh_solid(mesh), options)` once per mesh and options. Afterwards the packing comes from the cache, the
/// same to the bit (`seconds` is the time it took originally). A packing cut short by a time limit or a person is not
/// kept. `maker` names the algorithm, because a device's makes other spheres than the host's. Throws as `make` does.
template <class Make>
cached_packing pack_cached(const closed_mesh& mesh, const pack_options& options, const packing_cache& cache,
                           std::string_view maker, Make make) {
  if (cache.folder().empty()) return {make(mesh_solid(mesh), options)};
  const digest key = packing_key(mesh, options, maker);
  if (auto found = cache.find(key)) {
    found->tolerance = mesh.tolerance;  // files store it with the part
    return {std::move(*found), true};
  }
  cached_packing fresh{make(mesh_solid(mesh), options)};
  if (fresh.made.stopped_by != pack_stop::time && fresh.made.stopped_by != pack_stop::cancelled)
    cache.keep(key, digest_of(mesh), fresh.made);
  return fresh;
}

/// The same for several closed meshes, side by side as by `pack`; each is kept as soon as it is done. Several threads
/// call `make` at once.
template <std::ranges::random_access_range R, class Make>
  requires std::same_as<std::ranges::range_value_t<R>, closed_mesh>
std::vector<cached_packing> pack_cached(const R& meshes, const pack_options& options, const packing_cache& cache,
                                        std::string_view maker, Make make) {
  const auto first = std::ranges::begin(meshes);
  return side_by_side(std::size_t(std::ranges::size(meshes)), options, [&](std::size_t i, const pack_options& own) {
    return pack_cached(first[std::ranges::range_difference_t<const R>(i)], own, cache, maker, make);
  });
}

/// Packs one closed mesh, or several, by `pack` on the host.
template <class M>
auto pack_cached(const M& meshes, const pack_options& options, const packing_cache& cache) {
  return pack_cached(meshes, options, cache, "host",
                     [](const mesh_solid& s, const pack_options& o) { return pack(s, o); });
}

}  // namespace clearance::io
