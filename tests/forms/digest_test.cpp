// SPDX-License-Identifier: BSD-3-Clause
// The bits of every answer are those that the repository keeps, with any number of threads and however it is asked.
#include "forms/digest.hpp"
#include "support/catch.hpp"

namespace digest_test {

using namespace testing;
using clearance::host;

TEST_CASE("Every answer has the bits that are kept") {
  for (int run = 0; run < digest_runs(); ++run)
    for (const unsigned threads : {0u, 1u, 2u, 3u, 7u}) {
      const host on{threads};
      const digests once = digests_of([&]<class Q>(const Q& q, const auto& model, const moving_frames& f) {
        return typename Q::result(ask(on, model, f.s.poses, f.here(), q));
      });
      INFO("threads " << threads << "; asked once, the digests are\n" << text_of(once));
      REQUIRE(once == kept_digests);
      const digests prepared = digests_of([&]<class Q>(const Q& q, const auto& model, const moving_frames& f) {
        clearance::query its(on, model, q);
        its(f.s.poses, f.here());
        return typename Q::result(its(f.s.poses, f.here()));
      });
      INFO("prepared, they are\n" << text_of(prepared));
      REQUIRE(prepared == kept_digests);
    }
}

TEST_CASE("In chunks every answer has the bits that are kept") {
  for (int run = 0; run < digest_runs(); ++run)
    for (const std::size_t size : {1000000, 4096, 1000 + run % 500}) {
      const digests by_chunks = digests_of([&]<class Q>(const Q& q, const auto& model, const moving_frames& f) {
        if constexpr (forms_of<Q>::in_pieces) {
          clearance::chunked chunks(clearance::point_span(f.points[0]), size);
          clearance::chunked_query its(host{}, model, q);
          return its(f.s.poses, chunks, f.here()[0].pose);
        }
      });
      INFO("in chunks of " << size << " the digests are\n" << text_of(by_chunks));
      REQUIRE(by_chunks == kept_digests_of_chunks);
    }
}

}  // namespace digest_test
