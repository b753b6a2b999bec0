// SPDX-License-Identifier: BSD-3-Clause
#include "robot_bodies.hpp"

#include "command_line.hpp"

#include <clearance/io/certify.hpp>
#include <clearance/io/note_tally.hpp>

#include <tbb/parallel_for.h>

#include <exception>
#include <ranges>
#include <stdexcept>

using namespace clearance;

namespace {

[[noreturn]] void refuse(const std::string& name, const std::invalid_argument& error) {
  io::refuse("link " + io::quoted(name), without_prefix(error.what()));
}

/// A part's tolerance covers both directions, so what sticks out of the solid is added to it.
void take(body& made, io::certified_spheres proven) {
  made.tolerance += proven.excess;
  made.packed = std::move(proven.spheres);
  made.packed.gap = proven.part_gap();
}
void take(body& made, const io::packed_part& given, progress& shown, body_account& account) {
  if (given.solid && given.solid == io::digest_of(made.closed) && std::isfinite(given.spheres.gap)) {
    made.packed = given.spheres;
    made.tolerance = std::max(made.tolerance + made.closed.tolerance, given.tolerance);
    ++account.certified;
    return;
  }
  shown.show("proving the spheres of " + made.name);
  io::certified_spheres proven = io::certify(mesh_solid::of_surface(made.closed), given.spheres);
  account.largest_gap = std::max(account.largest_gap, proven.spheres.gap);
  account.largest_excess = std::max(account.largest_excess, proven.excess);
  ++account.proven;
  take(made, std::move(proven));
}

/// If no sphere fits into a body, small ones along its surface stand for it, as far as that is proven.
void line(body& made, std::size_t count, progress& shown) {
  shown.show("lining " + made.name);
  const mesh_solid solid = mesh_solid::of_surface(made.closed);
  const double radius = 1e-6 * solid.bounds().diagonal().norm();
  std::vector<inner_sphere> spheres;
  for (const Eigen::Vector3d& p : solid.surface_points(count))
    spheres.push_back({{real(p.x()), real(p.y()), real(p.z())}, real(radius)});
  take(made, io::certify(solid, io::uncertified(std::move(spheres))));
}

std::string mm(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g mm", 1e3 * metres);
  return text;
}

/// Adds notes about the insides of the links, one of each kind.
void note_insides(const std::vector<body>& bodies, const std::vector<std::string>& lined, body_account& account) {
  const auto is_lined = [&](const body& b) { return std::ranges::find(lined, b.name) != lined.end(); };
  double unsure = 0, gap = 0;
  for (const body& b : bodies) {
    if (b.closed.inside == inside_by::flood) unsure = std::max(unsure, b.closed.tolerance);
    if (is_lined(b)) gap = std::max(gap, b.packed.gap);
  }
  io::note_tally notes;
  for (const body& b : bodies) {
    const std::string who = "link " + io::quoted(b.name);
    if (b.closed.inside == inside_by::flood)
      notes.add("is no clean solid: what it encloses was found on a grid, and is uncertain within " + mm(unsure) +
                    " of its surface",
                who);
    if (b.closed.loaded != 0 && b.closed.inside == inside_by::nothing)
      notes.add("encloses nothing, so no point is inside it", who);
    if (is_lined(b))
      notes.add("has no room for inner spheres: small ones along its surface stand for it, to within " + mm(gap), who);
  }
  account.notes = notes.sentences();
}

/// Closes the meshes side by side.
void close(const std::vector<body_source>& sources, std::vector<body>& made, progress& shown) {
  shown.show(sources.size() == 1 ? "closing " + sources[0].name
                                 : "closing " + std::to_string(sources.size()) + " links");
  std::vector<std::exception_ptr> wrong(sources.size());
  for (const body_source& source : sources) made.push_back({source.name, {}, {}, source.tolerance});
  tbb::parallel_for(std::size_t(0), sources.size(), [&](std::size_t k) {
    try {
      made[k].closed = close_mesh(*sources[k].mesh);
    } catch (...) {
      wrong[k] = std::current_exception();
    }
  });
  for (std::size_t k = 0; k < sources.size(); ++k) try {
      if (wrong[k]) std::rethrow_exception(wrong[k]);
    } catch (const std::invalid_argument& error) {
      refuse(sources[k].name, error);
    }
}

/// Packs the bodies with these numbers, side by side.
void fill(std::vector<body>& bodies, const std::vector<std::size_t>& which, const body_options& options,
          progress& shown, body_account& account, std::vector<std::string>& lined) {
  pack_options wanted = options.pack;
  const std::string what = which.size() == 1 ? bodies[which[0]].name : std::to_string(which.size()) + " links";
  wanted.progress = [&](std::size_t done, std::size_t of) {
    shown.show("packing " + what + ' ' + std::to_string(done) + '/' + std::to_string(of));
  };
  const auto closed =
      which | std::views::transform([&](std::size_t k) -> const closed_mesh& { return bodies[k].closed; });
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
    if (packed.spheres.empty()) {
      if (!options.sheets) refuse(made.name, std::invalid_argument("no sphere fits inside: " + packed.reason()));
      line(made, options.pack.count, shown);
      lined.push_back(made.name);
      continue;
    }
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
  std::vector<std::string> lined;
  account.cached.assign(sources.size(), false);
  close(sources, made, shown);
  for (std::size_t k = 0; k < sources.size(); ++k) try {
      if (sources[k].given)
        take(made[k], *sources[k].given, shown, account);
      else if (options.model != model_kind::spheres && !options.both)
        continue;
      else if (has_inside(made[k].closed) || !options.sheets)
        to_pack.push_back(k);
      else
        line(made[k], options.pack.count, shown), lined.push_back(made[k].name);
    } catch (const std::invalid_argument& error) {
      refuse(made[k].name, error);
    }
  fill(made, to_pack, options, shown, account, lined);
  note_insides(made, lined, account);
  return made;
}

io::packing_cache chosen_cache(bool none, const std::string& folder) {
  if (none && !folder.empty()) throw usage_error("--no-cache", "cannot be mixed with --cache");
  if (none) return {};
  return io::packing_cache(folder.empty() ? io::packing_cache::usual_folder() : std::filesystem::path(folder));
}
