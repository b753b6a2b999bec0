# SPDX-License-Identifier: BSD-3-Clause
"""Conan 2: `conan create packaging/conan` in a checkout. What the library includes comes from Debian's packages."""

import pathlib
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy
from conan.tools.system.package_manager import Apt


def checkout(recipe):
    """Where the library is, while the recipe lies in it (later it is alone, in Conan's cache)."""
    return pathlib.Path(recipe.recipe_folder).parent.parent


class Clearance(ConanFile):
    name = "clearance"
    description = "How far is this robot from everything its depth sensor sees"
    license = "BSD-3-Clause"
    topics = ("robotics", "collision", "distance", "point-cloud", "bvh", "cuda")
    settings = "os", "arch", "compiler", "build_type"
    options = {"io": [True, False]}  # with the component io, which is compiled
    default_options = {"io": False}
    no_copy_source = True

    def set_version(self):
        config = (checkout(self) / "include/clearance/ground/config.hpp").read_text()
        self.version = ".".join(re.findall(r"#define CLEARANCE_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", config))

    def export(self):
        copy(self, "lib.sh", checkout(self) / "scripts", self.export_folder)  # names Debian's packages

    def export_sources(self):
        files = ("CMakeLists.txt", "CHANGELOG.md", "LICENSE", "package.xml", "scripts/lib.sh", "cmake/*", "include/*", "src/*")
        for pattern in files:
            copy(self, pattern, checkout(self), self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def system_requirements(self):
        lists = pathlib.Path(self.recipe_folder, "lib.sh").read_text()
        part = "(?:library|io)" if self.options.io else "library"
        names = " ".join(re.findall(rf"^packages_{part}=(.*)", lists, re.MULTILINE))
        Apt(self).install(re.findall(r"[\w+.-]+-dev\b", names))

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False
        toolchain.generate()

    def package(self):
        cmake = CMake(self)
        parts = {f"CLEARANCE_BUILD_{part}": "OFF" for part in ("TESTS", "EXAMPLES", "BENCH", "TOOLS")}
        cmake.configure(variables={**parts, "CLEARANCE_BUILD_IO": "ON" if self.options.io else "OFF"})
        cmake.build()  # the components solid and io
        cmake.install()

    def package_info(self):
        # Its own CMake files are found, not ones that Conan makes up: they know the flags of nvcc and the component io.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = ["share/cmake/clearance"]
        self.cpp_info.bindirs = []
        self.cpp_info.libdirs = ["lib"]
