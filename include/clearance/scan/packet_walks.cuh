// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/scan/cell_packets.cuh>
#include <clearance/scan/tangent_packets.cuh>

namespace clearance::scan {

/// How packets find what is nearest to their points.
enum class packets_by { bounds, tangents, cells };

template <class Tally, packets_by How>
struct packet_walk {
  using memory = shared_packet_memory<Tally>;
  using type = packet_search<Tally>;
};
template <class Tally>
struct packet_walk<Tally, packets_by::tangents> {
  using memory = tangent_packet_memory<Tally>;
  using type = tangent_packets<Tally>;
};
template <class Tally>
struct packet_walk<Tally, packets_by::cells> {
  using memory = cell_packet_memory<Tally>;
  using type = cell_packets<Tally>;
};

}  // namespace clearance::scan
