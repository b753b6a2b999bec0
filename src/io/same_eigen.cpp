// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/same_eigen.hpp>

namespace clearance::io::detail {

template <int StaticBytes, int Bytes>
bool io_was_compiled_with_another_alignment_of_eigen<StaticBytes, Bytes>::see_the_page_io() {
  return true;
}
template struct io_was_compiled_with_another_alignment_of_eigen<EIGEN_MAX_STATIC_ALIGN_BYTES, EIGEN_MAX_ALIGN_BYTES>;

}  // namespace clearance::io::detail
