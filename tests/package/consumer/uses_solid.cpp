// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/packing/pack.hpp>

#include <stdexcept>

namespace {

// Runs before main: a tetrahedron is closed and filled.
const bool packed = [] {
  const clearance::triangle_mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                      {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  if (clearance::pack(mesh, {.count = 10}).spheres.size() != 10) throw std::logic_error("a tetrahedron has no room");
  return true;
}();

}  // namespace
