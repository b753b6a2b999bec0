// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every search, by name.

#include "bounds/built.hpp"
#include "bounds/groups.hpp"

#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>

#include <cstdio>
#include <string>

namespace bounds {

/// What one search found, as text.
struct row {
  std::string name;
  std::uint64_t cases, broken;
  double least;
  int law;
  std::string at;
};

template <std::size_t N>
row row_of(const std::string& name, const found<N>& f) {
  row r{name, f.cases, f.broken, f.least, f.law, {}};
  char text[32];
  for (const float x : f.at) std::snprintf(text, sizeof text, " %a", double(x)), r.at += text;
  return r;
}

template <class P, class Take>
void primitive_rows(const std::string& p, std::uint64_t cases, std::uint64_t seed, Take take) {
  using namespace clearance;
  take(p, [&] { return row_of(p, search(primitive_law<P>{}, cases, seed)); });
  const auto in = [&](const std::string& v, auto volume) {
    using V = decltype(volume);
    take(v + " of " + p, [&, v] { return row_of(v + " of " + p, search(volume_law<V, P>{}, cases, seed)); });
    take(v + " of " + p + ", capsule",
         [&, v] { return row_of(v + " of " + p + ", capsule", search(capsule_law<V, P>{}, cases, seed)); });
    take(v + " of " + v + " of " + p,
         [&, v] { return row_of(v + " of " + v + " of " + p, search(layered_law<V, P>{}, cases, seed)); });
  };
  in("sphere", sphere{}), in("aabb", aabb{}), in("obb", obb{});
  take(p + ", bracket", [&] { return row_of(p + ", bracket", search(bracket_law<P>{}, cases, seed)); });
  take(p + ", together", [&] { return row_of(p + ", together", search(together_law<P>{}, cases, seed)); });
  take(p + ", field", [&] {
    found<3> all;
    chance c(seed);
    while (all.cases < cases) all.add(search(field_law<P>(c), std::min<std::uint64_t>(cases, 1 << 14), c.bits()));
    return row_of(p + ", field", all);
  });
}

/// Calls `take(name, run)` for each search of about `cases` cases; `run()` does it and returns its row.
template <class Take>
void each_row(std::uint64_t cases, std::uint64_t seed, Take take) {
  primitive_rows<inner_sphere>("inner sphere", cases, seed, take);
  primitive_rows<triangle>("triangle", cases, seed, take);
  take("ball", [&] { return row_of("ball", search(ball_law{}, cases, seed)); });
  take("capsule tile", [&] { return row_of("capsule tile", search(tile_law{}, cases / 32, seed)); });
  take("cloud tree", [&] { return row_of("cloud tree", search(tree_law{}, cases / 32, seed)); });
}

}  // namespace bounds
