#!/usr/bin/env bash
# Builds the examples as a user would, against an installed tree, and checks their output.
#   consumers.sh HOW BUILD_FOLDER WORK_FOLDER    HOW: find_package, pkg_config, add_subdirectory, mujoco, chai3d, symbols or header
#   consumers.sh HOW installed WORK_FOLDER       with what the system's packages have installed: find_package, pkg_config, mujoco, chai3d
set -euo pipefail
how=$1 build=$2 work=$3
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
export HAPTOLITH_CACHE=off
# Only what an earlier run has made is cleared away.
if [[ -e $work && ! -e $work/.consumer ]]; then
  printf 'consumers.sh: %s is there, and no run of this script has made it\n' "$work" >&2
  exit 2
fi
rm -rf "$work" && mkdir -p "$work" && touch "$work/.consumer"

fail() {
  printf 'consumers.sh: %s\n' "$1" >&2
  exit 1
}

program=$build/apps/haptolith/haptolith
[[ $build != installed ]] || program=haptolith

install() {
  prefix=/usr
  [[ $build != installed ]] || return 0
  prefix=$work/prefix
  cmake --install "$build" --prefix "$work/prefix" --component library > "$work/install.log"
  cmake --install "$build" --prefix "$work/prefix" --component development >> "$work/install.log"
  export PKG_CONFIG_PATH=$prefix/lib/pkgconfig LD_LIBRARY_PATH=$prefix/lib
}

# The hash that the program prints is the one that the library gives.
lookAt() {
  local hash of_program
  hash=$("$1/example_state_hash" icra2021)
  of_program=$("$program" run icra2021 --no-realtime --duration-s 1 --json 2> /dev/null |
    sed -n 's/.*"state_hash": "\([0-9a-f]*\)".*/\1/p')
  [[ -n $hash && $hash == "$of_program" ]] || fail "state_hash printed '$hash', the program '$of_program'"
  "$1/example_dig" | tee "$work/dig.txt"
  awk '$3 < last || NF != 4 { exit 1 } { last = $3 } END { exit !(NR == 5 && last > 10) }' "$work/dig.txt" ||
    fail "dig does not feel soil that grows harder with depth"
  "$1/example_own_loop" | tee "$work/own_loop.txt"
  grep -q '0.000 N, "the device' "$work/own_loop.txt" || fail "own_loop does not let go"
}

case $how in
  find_package)
    install
    cmake -S "$source/examples" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release > "$work/configure.log"
    cmake --build "$work/build" > "$work/build.log" || { cat "$work/build.log"; exit 1; }
    lookAt "$work/build"
    "$work/build/example_own_device" | tee "$work/own_device.txt"
    grep -q "ended: duration reached" "$work/own_device.txt" || fail "own_device does not end as it should"
    "$work/build/example_record" "$work/run.h5" | tee "$work/record.txt"
    grep -q "2000 ticks, run again: the same to the last bit" "$work/record.txt" || fail "record does not run the same again"
    "$program" replay "$work/run.h5" --verify > "$work/replay.txt" || { cat "$work/replay.txt"; fail "the program does not run it again"; }
    awk '/N  tick/ && $7 > 0.1 { felt = 1 } END { exit !felt }' "$work/own_device.txt" || fail "own_device feels nothing"
    ;;
  pkg_config)
    install
    read -ra flags <<< "$(pkg-config --cflags --libs haptolith)"
    [[ $(pkg-config --modversion haptolith) == "$("$program" --version | sed 's/haptolith //')" ]] ||
      fail "haptolith.pc has another version than the program"
    for example in dig state_hash; do
      gcc -std=c99 -pedantic -Wall -Wextra -Wno-missing-field-initializers -Werror "$source/examples/c/$example.c" "${flags[@]}" -o "$work/example_$example"
    done
    for example in own_device own_loop; do
      g++ -std=c++17 -pedantic -Wall -Wextra -Wno-missing-field-initializers -Werror "$source/examples/cpp/$example.cpp" "${flags[@]}" -o "$work/example_$example"
    done
    lookAt "$work"
    read -ra flags <<< "$(pkg-config --cflags --libs haptolith_recording)"
    g++ -std=c++17 -pedantic -Wall -Wextra -Wno-missing-field-initializers -Werror "$source/examples/cpp/record.cpp" "${flags[@]}" -o "$work/example_record"
    "$work/example_record" "$work/run.h5"
    ;;
  add_subdirectory)
    cat > "$work/CMakeLists.txt" << CMAKE
cmake_minimum_required(VERSION 3.16)
project(host LANGUAGES C CXX)
add_subdirectory($source haptolith)
add_subdirectory($source/examples examples)
CMAKE
    ! command -v ccache > /dev/null || export CMAKE_CXX_COMPILER_LAUNCHER=ccache
    cmake -S "$work" -B "$work/build" -G Ninja -DHAPTOLITH_UNITY=ON > "$work/configure.log" || { cat "$work/configure.log"; exit 1; }
    # So that ccache finds precompiled headers again (see namePrecompiledHeaders() in dev).
    find "$work/build" -name cmake_pch.hxx | while read -r list; do { cat "$list"; c++ --version; } | sha256sum > "$list.gch.sum"; done
    ! ninja -C "$work/build" -t targets all | grep -q "test_\|benchmarks/" || fail "it brings its tests"
    cmake --build "$work/build" -j 2 > "$work/build.log" || { tail -30 "$work/build.log"; exit 1; }
    lookAt "$work/build/examples"
    ;;
  mujoco)
    install
    read -ra flags <<< "$(pkg-config --cflags --libs haptolith)"
    gcc -std=c99 -Wall -Wextra -Wno-missing-field-initializers -Werror "$source/examples/mujoco/arm_digs.c" "${flags[@]}" -lmujoco -lm -o "$work/arm_digs"
    "$work/arm_digs" "$work/arm.csv" | tee "$work/arm.txt"
    awk '/strongest/ { strongest = $3 } END { exit !(strongest > 5 && strongest < 50) }' "$work/arm.txt" || fail "the arm does not feel the soil"
    # Before it touches the soil and behind it the blade feels nothing; in it, the arm gives way and pushes harder.
    awk -F, 'NR > 1 && ($1 < 0.3 || $1 > 4) { out += $7 * $7 } $1 > 1.5 && $1 < 3 { in_soil += $7; n++ }
             END { exit !(out < 2 && in_soil / n > 3) }' "$work/arm.csv" || fail "the force is not where the soil is"
    HAPTOLITH_LIBRARY=$prefix/lib/libhaptolith.so PYTHONPATH=$source/python PYTHONDONTWRITEBYTECODE=1 \
      /usr/bin/python3 "$source/examples/mujoco/draw.py" "$work/arm.csv" "$work/arm.png"
    [[ -s $work/arm.png ]] || fail "the arm is not drawn"
    # Four wheels: level soil and 20 degrees carry the rover, at 30 degrees it digs itself in.
    gcc -std=c99 -Wall -Wextra -Wno-missing-field-initializers -Werror "$source/examples/mujoco/rover.c" "${flags[@]}" -lmujoco -lm -o "$work/rover"
    for slope in 0 20 30; do "$work/rover" "$slope" > "$work/rover-$slope.txt" & done
    wait
    drove() { awk '/drove/ { print $5 }' "$work/rover-$1.txt"; }
    (( $(drove 0) > 600 )) || fail "the rover drives $(drove 0) mm on level soil"
    (( $(drove 20) > 300 )) || fail "the rover climbs $(drove 20) mm on 20 degrees"
    (( $(drove 30) < 100 )) || fail "the rover climbs $(drove 30) mm on 30 degrees"
    ;;
  chai3d)  # with mocks of its classes, in the C++ that CHAI3D is built with
    install
    read -ra flags <<< "$(pkg-config --cflags --libs haptolith)"
    g++ -std=c++11 -pedantic -Wall -Wextra -Werror -isystem "$source/tests/c_api/chai3d" "$source/examples/chai3d/dig.cpp" "${flags[@]}" -o "$work/chai3d_dig"
    "$work/chai3d_dig" | tee "$work/chai3d_dig.txt"
    awk '/N$/ { if ($4 < last) exit 1; last = $4 } END { exit !(NR == 6 && last > 3) }' "$work/chai3d_dig.txt" || fail "the hand does not feel soil that grows harder"
    ;;
  symbols)
    for name in haptolith haptolith_recording; do
      library=$build/lib/lib$name.so
      header=$source/include/haptolith/${name#haptolith_}.h
      nm -D --defined-only "$library" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | sort > "$work/shown"
      grep -o 'HAPTO_API [a-z0-9_ *]*hapto_[a-z0-9_]*(' "$header" | grep -o 'hapto_[a-z0-9_]*(' | tr -d '(' | sort > "$work/declared"
      diff "$work/declared" "$work/shown" || fail "what $header declares (<) is not what the library shows (>)"
      objdump -p "$library" | grep "SONAME *lib$name.so.0.2$" > /dev/null || fail "the SONAME is not lib$name.so.0.2"
    done
    library=$build/lib/libhaptolith.so
    # Few and light: no X11, no HDF5, no SQLite in who uses it.
    needed=$(objdump -p "$library" | awk '/NEEDED/ { print $2 }' | sed 's/\.so.*//' | sort | tr '\n' ' ')
    allowed="ld-linux-x86-64 libc libfmt libgcc_s libhwy libm libnlopt libnlopt_cxx libsodium libstdc++ libtomlplusplus libxxhash "
    for name in $needed; do
      [[ " $allowed" == *" $name "* ]] || fail "the library needs $name"
    done
    ;;
  header)
    printf '#include <haptolith/network_device.h>\n#include <haptolith/recording.h>\nint main(void) { return 0; }\n' > "$work/alone.c"
    for standard in c99 c11 c17; do
      gcc -std=$standard -pedantic -Wall -Wextra -Wstrict-prototypes -Wpadded -Werror -I"$source/include" -I"$build/include" -fsyntax-only "$work/alone.c"
    done
    cp "$work/alone.c" "$work/alone.cpp"
    printf '#include <haptolith/recording.hpp>\nint main() { return 0; }\n' > "$work/wrapper.cpp"
    for standard in c++17 c++20 c++23; do
      g++ -std=$standard -pedantic -Wall -Wextra -Wconversion -Wshadow -Werror -I"$source/include" -I"$build/include" -fsyntax-only "$work/alone.cpp" "$work/wrapper.cpp"
    done
    if command -v clang++ > /dev/null; then
      clang++ -std=c++17 -pedantic -Wall -Wextra -Werror -I"$source/include" -I"$build/include" -fsyntax-only "$work/wrapper.cpp"
    fi
    ;;
  *) fail "HOW is find_package, pkg_config, add_subdirectory, mujoco, chai3d, symbols or header, not '$how'" ;;
esac
