// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/packing_cache.hpp>

#include <clearance/io/bytes.hpp>
#include <clearance/io/ist.hpp>
#include <clearance/io/kept_files.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <array>
#include <cstdlib>
#include <map>
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
                                        const packing_cache& cache, std::string_view maker, const pack_by& make,
                                        const std::function<void(std::size_t)>& finished) {
  std::map<std::array<std::uint8_t, 16>, std::size_t> known;
  std::vector<std::size_t> number;              // by mesh: which of the distinct ones it is
  std::vector<std::vector<std::size_t>> equal;  // by distinct one: its meshes, the first of which is packed
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const auto [at, is_new] = known.try_emplace(digest_of(*meshes[i]).bytes, equal.size());
    if (is_new) equal.emplace_back();
    equal[at->second].push_back(i);
    number.push_back(at->second);
  }
  std::vector<cached_packing> made;
  try {
    made = side_by_side(equal.size(), options, [&](std::size_t k, const pack_options& own) {
      cached_packing one = pack_cached(*meshes[equal[k][0]], own, cache, maker, make);
      if (finished) finished(equal[k].size());
      return one;
    });
  } catch (const solid_error& error) {
    throw solid_error(equal[error.index][0], error.what());
  }
  std::vector<cached_packing> all;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    all.push_back(made[number[i]]);
    all.back().made.tolerance = meshes[i]->tolerance;
  }
  return all;
}

}  // namespace clearance::io
