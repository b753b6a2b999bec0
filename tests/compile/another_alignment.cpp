// SPDX-License-Identifier: BSD-3-Clause
// expected-error: io_was_compiled_with_another_alignment_of_eigen
#include <clearance/io/robot.hpp>

int main() { return int(clearance::io::load_robot("robot.urdf").parts().size()); }
