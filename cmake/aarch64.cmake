# SPDX-License-Identifier: BSD-3-Clause
# A toolchain: programs for aarch64 by Debian's cross compiler, run by QEMU. CLEARANCE_AARCH64 is a folder of unpacked
# Debian packages, the libraries among them (scripts/aarch64 makes it).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CLEARANCE_AARCH64)
set(CMAKE_FIND_ROOT_PATH ${CLEARANCE_AARCH64} /usr/aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE BOTH)  # headers alone are this machine's,
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)  # such as Eigen's
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static;-L;/usr/aarch64-linux-gnu)
