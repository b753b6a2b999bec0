// SPDX-License-Identifier: BSD-3-Clause
#include "packing/packers.hpp"

#include <clearance/packing/pack.cuh>

#include <thread>

namespace pack_test {

using namespace packer_laws;

namespace {

// [on_gpu]
packing on_gpu(const triangle_mesh& mesh, const pack_options& options = {.count = 2048}) {
  return pack(device{}, mesh, options);
}
// [on_gpu]

}  // namespace

TEST_CASE("a GPU's packing keeps the laws") { keeps_the_laws(on_gpu); }
TEST_CASE("a GPU packs as well as the host") { is_as_good_as_the_host(on_gpu); }
TEST_CASE("a GPU's packing is the same bits on every run") { repeats_itself(on_gpu); }
TEST_CASE("a GPU stops packing for each reason") { stops_for_each_reason(on_gpu); }
TEST_CASE("a GPU's spheres have no middle beyond a passage that is a wall") { stays_within_a_flood(on_gpu); }
TEST_CASE("a GPU lets spheres overlap if asked to") { lets_spheres_overlap(on_gpu); }
TEST_CASE("a GPU refuses to pack what makes no sense") { refuses_what_makes_no_sense(on_gpu); }
TEST_CASE("a GPU ends on thin plates and needles, with spheres or with a reason") { ends_on_thin_bodies(on_gpu); }
TEST_CASE("a GPU packs real links", "[data]") {
  packs_real_links(on_gpu, 2048, {"base.STL", "link_2.STL", "link_7.STL"});
}

TEST_CASE("solids are packed on several streams at once, each as if it were alone") {
  const triangle_mesh meshes[] = {shapes::box({0, 0, 0}, {1, 0.7, 0.9}), shapes::globe({0, 0, 0}, 1),
                                  shapes::torus(1, 0.25)};
  packing alone[3], together[3];
  std::thread threads[3];
  for (int i = 0; i < 3; ++i) alone[i] = on_gpu(meshes[i], {.count = 500});
  // [streams]
  for (int i = 0; i < 3; ++i)
    threads[i] = std::thread([&, i] {
      cudaStream_t stream;
      check_cuda(cudaStreamCreate(&stream), "cudaStreamCreate");
      together[i] = pack(device{0, stream}, meshes[i], {.count = 500});
      cudaStreamDestroy(stream);
    });
  for (auto& t : threads) t.join();
  // [streams]
  for (int i = 0; i < 3; ++i) CHECK(same(alone[i], together[i]));
  const auto range = pack(device{}, meshes, {.count = 500});
  REQUIRE(range.size() == 3);
  for (int i = 0; i < 3; ++i) CHECK(same(alone[i], range[i]));
}

TEST_CASE("the first of several that is wrong is named, on a GPU too") {
  const triangle_mesh meshes[] = {shapes::box({0, 0, 0}, {1, 0.7, 0.9}), shapes::moebius(), triangle_mesh{}};
  try {
    pack(device{}, meshes, {.count = 5});
    CHECK(false);
  } catch (const solid_error& error) {
    CHECK(error.index == 1);
  }
}

TEST_CASE("a solid that is no mesh is packed on a GPU if it can be asked there") {
  check_ring(pack(device{}, ring(), {.count = 200}));
}

}  // namespace pack_test
