// SPDX-License-Identifier: BSD-3-Clause
#include "robot_bodies.hpp"

#include "command_line.hpp"
#include "thin_body.hpp"

#include <clearance/io/certify.hpp>

#include <ranges>
#include <stdexcept>

using namespace clearance;

namespace {

[[noreturn]] void refuse(const std::string& name, const std::invalid_argument& error) {
  io::refuse("link " + io::quoted(name), without_prefix(error.what()));
}

/// The part's tolerance holds either way; what sticks out of the solid goes there.
void take(body& made, const io::packed_part& given, progress& shown, body_account& account) {
  if (given.solid && given.solid == io::digest_of(made.closed) && std::isfinite(given.spheres.gap)) {
    made.packed = given.spheres;
    ++account.certified;
    return;
  }
  shown.show("proving the spheres of " + made.name);
  io::certified_spheres proven = io::certify(mesh_solid(made.closed), given.spheres);
  account.largest_gap = std::max(account.largest_gap, proven.spheres.gap);
  account.largest_excess = std::max(account.largest_excess, proven.excess);
  ++account.proven;
  made.tolerance += proven.excess;
  made.packed = std::move(proven.spheres);
  made.packed.gap = proven.part_gap();
}

/// Packs the bodies with these numbers, beside one another.
void fill(std::vector<body>& bodies, const std::vector<std::size_t>& which, const body_options& options, progress& shown,
          body_account& account) {
  pack_options wanted = options.pack;
  const std::string what = which.size() == 1 ? bodies[which[0]].name : std::to_string(which.size()) + " links";
  wanted.progress = [&](std::size_t done, std::size_t of) {
    shown.show("packing " + what + ' ' + std::to_string(done) + '/' + std::to_string(of));
  };
  const auto closed = which | std::views::transform([&](std::size_t k) -> const closed_mesh& { return bodies[k].closed; });
  std::vector<io::cached_packing> packings;
  try {
    packings = options.on_device ? io::pack_cached(closed, wanted, options.cache, "device", pack_on_device)
                                 : io::pack_cached(closed, wanted, options.cache);
  } catch (const solid_error& error) {
    refuse(bodies[which[error.index]].name, error);
  }
  for (std::size_t i = 0; i < which.size(); ++i) {
    auto& [packed, found] = packings[i];
    body& made = bodies[which[i]];
    const std::string why = packed.reason();
    if (packed.spheres.empty()) packed = spheres_along(mesh_solid(made.closed), wanted.count);
    if (packed.spheres.empty())
      refuse(made.name, std::invalid_argument("no sphere fits inside: " + why));
    made.packed = std::move(packed);
    account.cached[which[i]] = found;
    ++(found ? account.from_cache : account.packed);
  }
}

}  // namespace

std::vector<body> make_bodies(const std::vector<body_source>& sources, const body_options& options, progress& shown,
                              body_account& account) {
  std::vector<body> made;
  std::vector<std::size_t> to_pack;
  account.cached.assign(sources.size(), false);
  for (const body_source& source : sources) {
    made.push_back({source.name, {}, {}, source.tolerance});
    try {
      shown.show("closing " + source.name);
      made.back().closed = close_mesh(*source.mesh);
      if (source.given)
        take(made.back(), *source.given, shown, account);
      else if (options.model == model_kind::spheres || options.both)
        to_pack.push_back(made.size() - 1);
    } catch (const std::invalid_argument& error) {
      refuse(source.name, error);
    }
  }
  fill(made, to_pack, options, shown, account);
  return made;
}

io::packing_cache chosen_cache(bool none, const std::string& folder) {
  if (none && !folder.empty()) throw usage_error("--no-cache", "cannot be mixed with --cache");
  if (none) return {};
  return io::packing_cache(folder.empty() ? io::packing_cache::usual_folder() : std::filesystem::path(folder));
}
