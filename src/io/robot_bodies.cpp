// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/robot_bodies.hpp>

#include "io/note_tally.hpp"

#include <clearance/ground/borrowed.hpp>
#include <clearance/io/certify.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/packed_part.hpp>
#include <clearance/io/packing_cache.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdio>
#include <exception>
#include <functional>
#include <numbers>
#include <ranges>

namespace clearance::io {

namespace {

/// Names the link; the library's prefix goes, because the sentence begins with the link.
[[noreturn]] void refuse_link(const std::string& name, const std::invalid_argument& error) {
  const std::string why = error.what();
  refuse("link " + io::quoted(name), why.starts_with("clearance: ") ? why.substr(11) : why);
}

/// A part's tolerance covers both directions, so what sticks out of the solid is added to it.
void fill(body& made, certified_spheres proven) {
  made.tolerance += proven.excess;
  made.packed = std::move(proven.spheres);
  made.packed.gap = proven.part_gap();
}

void fill(body& made, const packed_part& given, const body_options& options, body_account& account) {
  if (given.solid && given.solid == digest_of(made.closed) && std::isfinite(given.spheres.gap)) {
    made.packed = given.spheres;
    made.tolerance = std::max(made.tolerance + made.closed.tolerance, given.tolerance);
    ++account.certified;
    return;
  }
  options.doing("proving the spheres of " + made.name);
  certified_spheres proven = certify(mesh_solid::of_surface(made.closed), given.spheres);
  account.largest_gap = std::max(account.largest_gap, proven.spheres.gap);
  account.largest_excess = std::max(account.largest_excess, proven.excess);
  ++account.proven;
  fill(made, std::move(proven));
}

/// If no sphere fits into a body, small ones along its surface stand for it, as far as that is proven.
void line(body& made, const body_options& options) {
  options.doing("lining " + made.name);
  const mesh_solid solid = mesh_solid::of_surface(made.closed);
  const double radius = 1e-6 * solid.bounds().diagonal().norm();
  std::vector<inner_sphere> spheres;
  for (const Eigen::Vector3d& p : solid.surface_points(options.pack.count))
    spheres.push_back({{real(p.x()), real(p.y()), real(p.z())}, real(radius)});
  fill(made, certify(solid, uncertified(std::move(spheres))));
}

std::string mm(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g mm", 1e3 * metres);
  return text;
}

/// Adds notes about the insides of the links, one of each kind.
void note_insides(const std::vector<body>& all, const std::vector<std::string>& lined, body_account& account) {
  const auto is_lined = [&](const body& b) { return std::ranges::find(lined, b.name) != lined.end(); };
  double unsure = 0, gap = 0;
  for (const body& b : all) {
    if (b.closed.inside == inside_by::flood) unsure = std::max(unsure, b.closed.tolerance);
    if (is_lined(b)) gap = std::max(gap, b.packed.gap);
  }
  note_tally notes;
  for (const body& b : all) {
    const std::string who = "link " + io::quoted(b.name);
    if (b.closed.inside == inside_by::flood)
      notes.add("is no clean solid: what it encloses was found on a grid, and is uncertain within " + mm(unsure) +
                    " of its surface",
                who);
    if (b.closed.loaded != 0 && b.closed.inside == inside_by::nothing)
      notes.add("encloses nothing, so no point is inside it", who);
    else if (b.closed.sheets != 0 && b.closed.inside != inside_by::flood)
      notes.add("has surfaces that enclose nothing, so no point is inside them", who);
    if (is_lined(b))
      notes.add("has no room for inner spheres: small ones along its surface stand for it, to within " + mm(gap), who);
  }
  account.notes = notes.sentences();
}

/// Closes the meshes side by side.
void close(const std::vector<body_source>& sources, std::vector<body>& made, const body_options& options) {
  options.doing(sources.size() == 1 ? "closing " + sources[0].name
                                    : "closing " + std::to_string(sources.size()) + " links");
  std::vector<std::exception_ptr> wrong(sources.size());
  for (const body_source& source : sources) {
    if (source.mesh == nullptr) refuse_link(source.name, std::invalid_argument("it has no mesh: it is null"));
    if (!(source.tolerance >= 0))
      refuse_link(source.name, std::invalid_argument("its tolerance is " + std::to_string(source.tolerance) +
                                                     " m, which must be 0 or more"));
    made.push_back({source.name, {}, {}, source.tolerance});
  }
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
      refuse_link(sources[k].name, error);
    }
}

/// Packs the bodies with these numbers, side by side.
void fill(std::vector<body>& all, const std::vector<std::size_t>& which, const body_options& options,
          body_account& account, std::vector<std::string>& lined) {
  pack_options wanted = options.pack;
  std::atomic<std::size_t> links = 0;
  wanted.progress = [&](std::size_t done, std::size_t of) {
    const std::string spheres = std::to_string(done) + '/' + std::to_string(of) + " spheres";
    if (which.size() == 1) return options.doing("packing " + all[which[0]].name + ": " + spheres);
    options.doing("packing " + std::to_string(which.size()) + " links: " + std::to_string(links) + " done, " + spheres);
  };
  const auto closed = which | std::views::transform([&](std::size_t k) -> const closed_mesh& { return all[k].closed; });
  std::vector<cached_packing> packings;
  try {
    packings = pack_cached(closed, wanted, options.cache, options.maker, options.make,
                           [&](std::size_t more) { links += more; });
  } catch (const solid_error& error) {
    refuse_link(all[which[error.index]].name, error);
  }
  for (std::size_t i = 0; i < which.size(); ++i) {
    auto& [packed, found] = packings[i];
    body& made = all[which[i]];
    if (packed.spheres.empty()) {
      if (!options.sheets) refuse_link(made.name, std::invalid_argument("no sphere fits inside: " + packed.reason()));
      line(made, options);
      lined.push_back(made.name);
      continue;
    }
    made.packed = std::move(packed);
    account.cached[which[i]] = found;
    ++(found ? account.from_cache : account.packed);
  }
}

}  // namespace

std::vector<body> make_bodies(const std::vector<body_source>& sources, const body_options& options,
                              body_account& account) {
  std::vector<body> made;
  std::vector<std::size_t> to_pack;
  std::vector<std::string> lined;
  account.cached.assign(sources.size(), false);
  close(sources, made, options);
  for (std::size_t k = 0; k < sources.size(); ++k) try {
      if (sources[k].given) {
        fill(made[k], *sources[k].given, options, account);
      } else if (!options.spheres) {
        continue;
      } else if (has_inside(made[k].closed) || !options.sheets) {
        to_pack.push_back(k);
      } else {
        line(made[k], options);
        lined.push_back(made[k].name);
      }
    } catch (const std::invalid_argument& error) {
      refuse_link(made[k].name, error);
    }
  fill(made, to_pack, options, account, lined);
  note_insides(made, lined, account);
  return made;
}

}  // namespace clearance::io
