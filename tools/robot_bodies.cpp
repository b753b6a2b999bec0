// SPDX-License-Identifier: BSD-3-Clause
#include "robot_bodies.hpp"

#include "command_line.hpp"

#include <clearance/io/certify.hpp>

#include <stdexcept>

using namespace clearance;

namespace {

void fill(body& made, const body_options& options, progress& shown, body_account& account) {
  pack_options wanted = options.pack;
  wanted.progress = [&](std::size_t done, std::size_t of) {
    shown.show("packing " + made.name + ' ' + std::to_string(done) + '/' + std::to_string(of));
  };
  const auto [packed, found] = io::pack_cached(made.closed, wanted, options.cache ? *options.cache : io::packing_cache());
  if (packed.spheres.empty()) throw std::invalid_argument("no sphere fits inside: " + packed.reason());
  made.packed = packed;
  ++(found ? account.from_cache : account.packed);
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

}  // namespace

body make_body(const std::string& name, const triangle_mesh& mesh, double tolerance, const body_options& options,
               progress& shown, body_account& account) {
  body made{name, {}, {}, tolerance};
  try {
    shown.show("closing " + name);
    made.closed = close_mesh(mesh);
    if (options.given)
      take(made, *options.given, shown, account);
    else if (options.model == model_kind::spheres || options.both)
      fill(made, options, shown, account);
  } catch (const std::invalid_argument& error) {
    std::string why = error.what();
    if (why.starts_with("clearance: ")) why.erase(0, 11);
    throw std::runtime_error("link \"" + name + "\": " + why);
  }
  return made;
}

io::packing_cache chosen_cache(bool none, const std::string& folder) {
  if (none && !folder.empty()) throw usage_error("--no-cache", "cannot be mixed with --cache");
  if (none) return {};
  return io::packing_cache(folder.empty() ? io::packing_cache::usual_folder() : std::filesystem::path(folder));
}
