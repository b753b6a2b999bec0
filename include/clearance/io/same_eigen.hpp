// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Keeps a program from linking with a library that has Eigen's types elsewhere in memory.

#include <Eigen/Core>

namespace clearance::io::detail {

/// Eigen aligns and allocates its types as -march says (by 32 bytes with AVX), and the library `clearance::io` passes
/// them. It defines this for how it was compiled. A program with another way does not link, where it would crash:
/// compile both alike, or, for Debian's library, the program with -mno-avx; under g++'s address sanitizer with
/// -DEIGEN_MALLOC_ALREADY_ALIGNED=1.
template <int StaticBytes, int Bytes, bool Malloc>
struct io_was_compiled_with_another_alignment_of_eigen {
  static bool see_the_page_io();
};
inline const bool eigen_agrees =
    io_was_compiled_with_another_alignment_of_eigen<EIGEN_MAX_STATIC_ALIGN_BYTES, EIGEN_MAX_ALIGN_BYTES,
                                                    EIGEN_MALLOC_ALREADY_ALIGNED>::see_the_page_io();

}  // namespace clearance::io::detail
