# A formula for Homebrew on Linux: the program, the library and its Python package. `./dev release` writes version and sum into a
# copy of it among the release's files, from which Homebrew installs:
#
#     brew install --formula ./haptolith.rb
#
# Not tried: Homebrew could not be reached. ADDRESS is the address of the repository, which is not public yet. ROS 2 is left out. The
# build reads the browser view's packages from npm's registry. Homebrew's Eigen may be newer than the 3.4 that CMake requires.
class Haptolith < Formula
  desc "Haptic rendering of lunar and planetary regolith at 1 kHz"
  homepage "ADDRESS"
  url "ADDRESS/releases/download/v@VERSION@/haptolith-@VERSION@.tar.gz"
  sha256 "@SHA256@"
  license "BSD-3-Clause"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "eigen" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "node" => :build
  depends_on "pkgconf" => :build
  depends_on "boost"
  depends_on "fmt"
  depends_on "hdf5"
  depends_on "highway"
  depends_on "libsodium"
  depends_on "libspnav"
  depends_on :linux
  depends_on "nlopt"
  depends_on "sdl2"
  depends_on "spdlog"
  depends_on "sqlitecpp"
  depends_on "tomlplusplus"
  depends_on "xxhash"

  def install
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja", *std_cmake_args, "-DHAPTOLITH_UNITY=ON", "-DBUILD_TESTING=OFF",
           "-DHAPTOLITH_BENCHMARKS=OFF", "-DCMAKE_DISABLE_FIND_PACKAGE_CycloneDDS=ON"
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    assert_match "state_hash", shell_output("#{bin}/haptolith run icra2021 --no-realtime --duration-s 1 --json")
  end
end
