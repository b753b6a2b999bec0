// SPDX-License-Identifier: BSD-3-Clause
// The algorithm of the GPU packing, run on the host.
#include "packing/packers.hpp"
#include "support/host_steps.hpp"

#include <clearance/packing/rounds.hpp>

using namespace packer_laws;

namespace {

packing in_rounds(const triangle_mesh& mesh, const pack_options& options) {
  const mesh_solid s(mesh);
  host_steps steps;
  return round_packer<host, host_steps>(host{}, steps, s, options).run();
}

}  // namespace

TEST_CASE("rounds keep the laws") { keeps_the_laws(in_rounds); }
TEST_CASE("rounds pack as well as one cell after another") { is_as_good_as_one_by_one(in_rounds); }
TEST_CASE("rounds repeat themselves") { repeats_itself(in_rounds); }
TEST_CASE("rounds stop for each reason") { stops_for_each_reason(in_rounds); }
TEST_CASE("rounds let spheres overlap") { lets_spheres_overlap(in_rounds); }
TEST_CASE("rounds refuse what makes no sense") { refuses_what_makes_no_sense(in_rounds); }
TEST_CASE("rounds end on thin plates and needles") { ends_on_thin_bodies(in_rounds, 1e-3); }
TEST_CASE("rounds pack real links", "[data]") { packs_real_links(in_rounds, 400, {"base.STL", "link_7.STL"}); }
