// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads the point cloud of a PCD file, ascii, binary or compressed. What it does not understand it refuses.

#include <clearance/io/cloud.hpp>
#include <clearance/io/error.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

struct pcd_field {
  std::string name;
  std::uint64_t size = 4;    // bytes per element
  char type = 'F';           // F float, I signed, U unsigned
  std::uint64_t count = 1;   // 0 for a field that takes no bytes, as drivers of lidars write for padding
  std::uint64_t offset = 0;  // bytes before it in a record
  std::uint64_t column = 0;  // words before it in a line
};

struct pcd_header {
  enum class encoding { ascii, binary, binary_compressed };
  std::vector<pcd_field> fields;
  std::array<std::size_t, 3> xyz{};  // indices of these fields
  std::uint64_t record_bytes = 0, record_words = 0;
  std::uint64_t width = 0, height = 1, points = 0;
  std::optional<io::viewpoint> viewpoint;
  encoding data = encoding::ascii;
  std::size_t lines = 0;       // of the header
  bool line_end_left = false;  // the data begin with what may be the end of the header's last line
};

/// Takes the header off `rest`, which leaves the data.
pcd_header take_pcd_header(std::string_view& rest, const std::string& file);

/// Refuses data beyond POINTS, except the zeros with which some writers fill a page, and a line end before or after
/// them.
void check_pcd_end(std::string_view rest, const pcd_header& header, const std::string& file);

}  // namespace clearance::io
