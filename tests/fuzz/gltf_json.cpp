// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

#include <clearance/io/bytes.hpp>

namespace gltf_json_target {

namespace {

/// The JSON alone, before the data of one tetrahedron: four places, then twelve indices of 16 bits.
void read_json(std::string_view input) {
  clearance::io::byte_writer data, all;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) data.put(x);
  for (const int i : {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}) data.put(std::uint16_t(i));
  const std::string json = std::string(input) + std::string((4 - input.size() % 4) % 4, ' ');
  all.put(std::string_view("glTF"));
  for (const std::size_t word : {std::size_t(2), 28 + json.size() + data.bytes().size(), json.size()})
    all.put(std::uint32_t(word));
  all.put("JSON" + json);
  all.put(std::uint32_t(data.bytes().size()));
  all.put(std::string_view("BIN\0", 4));
  all.put(data.bytes());
  fuzz::read_mesh("m.glb", all.bytes());
}

const fuzz::target gltf_json("gltf_json", read_json);

}  // namespace

}  // namespace gltf_json_target
