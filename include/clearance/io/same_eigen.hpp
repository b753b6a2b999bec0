// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Keeps a program from linking with a library that has Eigen's types elsewhere in memory.

#include <Eigen/Core>

namespace clearance::io::detail {

/// Eigen aligns its types as -march says (by 32 bytes with AVX), and the library `clearance::io` passes them. It
/// defines this for the alignment that it was compiled with. A program with another one does not link, where it would
/// crash: compile both with the same -march, or the program with -DEIGEN_MAX_ALIGN_BYTES=16, Debian's.
template <int StaticBytes, int Bytes>
struct io_was_compiled_with_another_alignment_of_eigen {
  static bool see_the_page_io();
};
inline const bool eigen_agrees =
    io_was_compiled_with_another_alignment_of_eigen<EIGEN_MAX_STATIC_ALIGN_BYTES,
                                                    EIGEN_MAX_ALIGN_BYTES>::see_the_page_io();

}  // namespace clearance::io::detail
