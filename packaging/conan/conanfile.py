"""A Conan 2 package of libhaptolith, from the checkout or source archive that it is in, for Linux: conan create packaging/conan

Not tried: neither Conan nor ConanCenter could be reached. The names of dependencies are those of ConanCenter. Headers of libspnav
come from the system. The program and libhaptolith_recording are left out.
"""

import re
from pathlib import Path

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, rmdir
from conan.tools.system.package_manager import Apt, Dnf, PacMan


class HaptolithConan(ConanFile):
    """The shared library with its headers and its package for CMake."""

    name = "haptolith"
    package_type = "shared-library"
    license = "BSD-3-Clause"
    description = "Haptic rendering of lunar and planetary regolith at 1 kHz"
    topics = ("haptics", "granular", "regolith", "robotics")
    settings = "os", "arch", "compiler", "build_type"
    default_options = {"boost/*:header_only": True}
    generators = "CMakeDeps", "PkgConfigDeps"

    def set_version(self):
        """Reads it in the project's CMakeLists.txt."""
        text = (Path(self.recipe_folder).parents[1] / "CMakeLists.txt").read_text(encoding="utf-8")
        self.version = re.search(r"^project\(haptolith VERSION ([0-9.]+)", text, re.M)[1]

    def export_sources(self):
        """Takes what the library is built of."""
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "include/*", "python/*", "scenes/*", "soils/*", "src/*", "tools/*"):
            copy(self, pattern, src=str(Path(self.recipe_folder).parents[1]), dst=self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def validate(self):
        if self.settings.os != "Linux":
            raise ConanInvalidConfiguration("haptolith is only for Linux")
        check_min_cppstd(self, 20)

    def requirements(self):
        for requirement in ("boost/[>=1.74]", "eigen/[>=3.4 <4]", "fmt/[>=9]", "highway/[>=1.0.3 <2]", "libsodium/[>=1.0.18 <2]",
                            "nlohmann_json/[>=3.11 <4]", "nlopt/[>=2.7 <3]", "sdl/[>=2.26 <3]", "tomlplusplus/[>=3.3 <4]",
                            "xxhash/[>=0.8 <1]"):
            self.requires(requirement)

    def build_requirements(self):
        self.tool_requires("cmake/[>=3.25]")
        self.tool_requires("pkgconf/[>=2]")

    def system_requirements(self):
        Apt(self).install(["libspnav-dev"])
        Dnf(self).install(["libspnav-devel"])
        PacMan(self).install(["libspnav"])

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["HAPTOLITH_PROGRAM"] = False
        toolchain.cache_variables["HAPTOLITH_UNITY"] = True
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", src=self.source_folder, dst=str(Path(self.package_folder) / "licenses"))
        rmdir(self, str(Path(self.package_folder) / "lib/python3"))

    def package_info(self):
        self.cpp_info.libs = ["haptolith"]
        self.cpp_info.set_property("cmake_target_name", "haptolith::haptolith")
        self.cpp_info.set_property("pkg_config_name", "haptolith")
