// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/same_eigen.hpp>

namespace clearance::io::detail {

template <int StaticBytes, int Bytes, bool Malloc>
bool io_was_compiled_with_another_alignment_of_eigen<StaticBytes, Bytes, Malloc>::see_the_page_io() {
  return true;
}
template struct io_was_compiled_with_another_alignment_of_eigen<EIGEN_MAX_STATIC_ALIGN_BYTES, EIGEN_MAX_ALIGN_BYTES,
                                                                EIGEN_MALLOC_ALREADY_ALIGNED>;

}  // namespace clearance::io::detail
