// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One spelling for Catch2 version 2 (Debian 12) and version 3 (Ubuntu 24.04). Use `Approx`, TEST_CASE,
// TEMPLATE_TEST_CASE, GENERATE, and matchers in their long form, `Catch::Matchers::WithinRel(...)`.

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_approx.hpp>
#include <catch2/catch_template_test_macros.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators_all.hpp>
#include <catch2/matchers/catch_matchers_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>
#endif
