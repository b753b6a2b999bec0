# SPDX-License-Identifier: BSD-3-Clause
"""Builds and runs the README's program with the package that was just made; and with the option io, reads a robot."""

import pathlib

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout


class Test(ConanFile):
    settings = "os", "arch", "compiler", "build_type"
    test_type = "explicit"

    def requirements(self):
        self.requires(self.tested_reference_str)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["WITH_IO"] = bool(self.dependencies["clearance"].options.io)
        toolchain.user_presets_path = False  # the checkout stays as it is
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def test(self):
        if can_run(self):
            for program in sorted(pathlib.Path(self.cpp.build.bindir).glob("uses_*")):
                self.run(str(program.resolve()), env="conanrun")
