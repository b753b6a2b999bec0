// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/packing_cache.hpp>

#include <clearance/io/bytes.hpp>
#include <clearance/io/ist.hpp>
#include <clearance/io/kept_files.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <cstdlib>
#include <optional>

namespace clearance::io {

digest packing_key(const closed_mesh& mesh, const pack_options& options, std::string_view maker) {
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
  // Not in the key: a packing that one of these stopped is not kept.
  (void)seconds;
  (void)threads;
  (void)progress;
  (void)cancelled;
  return digest_of(out.bytes());
}

std::filesystem::path packing_cache::usual_folder() {
  if (const char* own = std::getenv("CLEARANCE_CACHE")) return own;
  const auto below = [](const char* variable, const char* path) {
    const char* value = std::getenv(variable);
    const std::filesystem::path at = value ? value : "";
    return at.is_absolute() ? at / path : std::filesystem::path();
  };
  const auto standard = below("XDG_CACHE_HOME", "clearance");
  return standard.empty() ? below("HOME", ".cache/clearance") : standard;
}

std::optional<packing> packing_cache::find(const digest& key) const {
  return files_.find(key, [&](const std::string& file) -> std::optional<packing> {
    auto parts = load_ist(file);
    if (parts.size() == 1 && parts[0].recipe == key) return std::move(parts[0].spheres);
    return {};
  });
}

bool packing_cache::keep(const digest& key, const digest& solid, const packing& made) const {
  return !made.spheres.empty() && files_.keep(key, [&](const std::string& file) {
    save_ist(std::vector{packed_part{.name = "", .spheres = made, .solid = solid, .recipe = key}}, file);
  });
}

namespace {

packing made_by(const pack_by& make, const closed_mesh& mesh, const pack_options& options) {
  const mesh_solid solid(mesh);
  return make ? make(solid, options) : pack(solid, options);
}

}  // namespace

cached_packing pack_cached(const closed_mesh& mesh, const pack_options& options, const packing_cache& cache,
                           std::string_view maker, const pack_by& make) {
  if (cache.folder().empty()) return {made_by(make, mesh, options)};
  const digest key = packing_key(mesh, options, maker);
  if (auto found = cache.find(key)) {
    found->tolerance = mesh.tolerance;  // files store it with the part
    return {std::move(*found), true};
  }
  cached_packing fresh{made_by(make, mesh, options)};
  if (fresh.made.stopped_by != pack_stop::time && fresh.made.stopped_by != pack_stop::cancelled)
    cache.keep(key, digest_of(mesh), fresh.made);
  return fresh;
}

std::vector<cached_packing> pack_cached(std::span<const closed_mesh* const> meshes, const pack_options& options,
                                        const packing_cache& cache, std::string_view maker, const pack_by& make) {
  return side_by_side(meshes.size(), options, [&](std::size_t i, const pack_options& own) {
    return pack_cached(*meshes[i], own, cache, maker, make);
  });
}

}  // namespace clearance::io
