// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Who shares the bound, as queries for all traversals of the library; and the cost of a walk, counted by a tree that
// counts how often it is read.

#include <clearance/concepts.hpp>
#include <clearance/ground/ordered.hpp>

namespace bench::paper {

using clearance::real;

/// Nobody: each walk, or each thread, has its own. On one thread of the host, carried from point to point, it is the
/// paper's Algorithm 1.
struct own_bound {
  using result_type = real;

  real best = clearance::infinity;
  unsigned accepted = 0;

  CLEARANCE_HD real reach() const { return best; }
  CLEARANCE_HD void offer(std::uint32_t, real distance) {
    if (distance < best) best = distance, ++accepted;
  }
  CLEARANCE_HD real result() const { return best; }
};
static_assert(clearance::visitor<own_bound>);

/// A block, or the whole query: one word in shared or in global memory, as in the paper's Algorithms 4 and 5. Their
/// `distance(s, p)` means `s_i`, and a root that is a leaf has its distance too: leaves are asked, never passed a `d`.
struct word_bound {
  using result_type = real;

  std::uint32_t* word;
  unsigned accepted = 0;

  CLEARANCE_HD real reach() const { return clearance::from_ordered(clearance::load_relaxed(word)); }
  CLEARANCE_HD void offer(std::uint32_t, real distance) {
    if (!(distance < reach())) return;
    const std::uint32_t mine = clearance::ordered(distance);
#if defined(__CUDA_ARCH__)
    accepted += mine < atomicMin(word, mine);  // a lost race lowers nothing
#else
    *word = mine, ++accepted;  // nearer than the old one; only one thread
#endif
  }
  CLEARANCE_HD real result() const { return reach(); }
};
static_assert(clearance::visitor<word_bound>);

/// What walks did, in total.
struct counts {
  unsigned long long tests = 0, leaves = 0, accepted = 0;
};

/// The same tree, but it counts: reading a volume is a node test, reading a primitive a leaf test.
template <clearance::hierarchy H>
struct counted : H {
  unsigned* tests;
  unsigned* leaves;

  CLEARANCE_HD counted(const H& tree, unsigned* tests, unsigned* leaves) : H(tree), tests(tests), leaves(leaves) {}
  CLEARANCE_HD decltype(auto) volume(typename H::node_type n) const {
    ++*tests;
    return H::volume(n);
  }
  CLEARANCE_HD decltype(auto) primitive(typename H::node_type n, std::uint32_t k) const {
    ++*leaves;
    return H::primitive(n, k);
  }
};

}  // namespace bench::paper
