// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

namespace gltf_target {

namespace {

/// glTF as text, which may name its data, a file beside it, and one that is out of its place.
void read_gltf(std::string_view input) {
  std::string data;
  for (int k = 0; k < 120; ++k) data += char(k % 7 == 3 ? 0x3f : k % 3);
  fuzz::put("data.bin", data);
  fuzz::put("../outside.bin", data);
  fuzz::read_mesh("m.gltf", input);
}

const fuzz::target gltf("gltf", read_gltf);

}  // namespace

}  // namespace gltf_target
