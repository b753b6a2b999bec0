// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The only header that asks which compiler is running. CMake reads the version from here, too.

#define CLEARANCE_VERSION_MAJOR 0
#define CLEARANCE_VERSION_MINOR 1
#define CLEARANCE_VERSION_PATCH 0
/// 10000 * major + 100 * minor + patch.
#define CLEARANCE_VERSION (10000 * CLEARANCE_VERSION_MAJOR + 100 * CLEARANCE_VERSION_MINOR + CLEARANCE_VERSION_PATCH)

#if defined(__CUDACC__)
#define CLEARANCE_HD __host__ __device__
/// Goes before a template that calls a function of the caller's, which may be for the host alone.
#define CLEARANCE_CALLS_ANYTHING _Pragma("nv_exec_check_disable")
#else
#define CLEARANCE_HD
#define CLEARANCE_CALLS_ANYTHING
#endif

/// Goes before a short loop whose arrays should live in registers.
#if defined(__CUDA_ARCH__)
#define CLEARANCE_UNROLL _Pragma("unroll")
/// Goes before a loop that rarely repeats.
#define CLEARANCE_ROLLED _Pragma("unroll 1")
#else
#define CLEARANCE_UNROLL
#define CLEARANCE_ROLLED
#endif

/// Goes behind a parameter, or the name of a member function, that the result views: clang warns if that is a temporary
/// which is gone before the result is used.
#if defined(__clang__) && !defined(__CUDACC__)
#define CLEARANCE_LIFETIMEBOUND [[clang::lifetimebound]]
#else
#define CLEARANCE_LIFETIMEBOUND
#endif

#if defined(__FAST_MATH__)
#error "clearance: -ffast-math breaks NaN handling and the certified bracket; compile this file without it"
#endif
