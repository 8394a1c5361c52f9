#!/usr/bin/env bash
# Builds C and C++ examples against the library of `./dev build windows`, runs them in Wine, and compares forces and states with those of the
# library built for Linux: tests/packages/windows_dll.sh. Needs `./dev build` before.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
library=$source/build/windows/lib
[[ -e $library/haptolith.dll ]] || { echo "windows_dll.sh: no haptolith.dll: ./dev build windows" >&2; exit 2; }
[[ -e $source/build/release/lib/libhaptolith.so ]] || { echo "windows_dll.sh: no libhaptolith.so: ./dev build" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export WINEPREFIX=$folder/wine WINEDEBUG=-all
failed=0

say() { printf 'windows_dll.sh: %s\n' "$*"; }
# compare NAME LINUX WINDOWS: whether both answers are equal.
compare() {
  if [[ $2 == "$3" ]]; then say "$1: same"; else say "$1 differs: '$2' and '$3'"; failed=1; fi
}

cd "$folder"
mkdir path\ with\ ümlauts && cd path*
headers=(-I "$source/include" -I "$source/build/windows/include")
for example in dig state_hash; do
  cc -std=gnu99 -O1 "${headers[@]}" "$source/examples/c/$example.c" -o "$example" -L "$source/build/release/lib" -lhaptolith \
    "-Wl,-rpath,$source/build/release/lib" -lpthread
  x86_64-w64-mingw32-gcc-posix -std=gnu99 -O1 -static "${headers[@]}" "$source/examples/c/$example.c" -o "$example.exe" \
    "$library/libhaptolith.dll.a" -lpthread
done
for example in own_loop record; do
  c++ -std=c++17 -O1 "${headers[@]}" "$source/examples/cpp/$example.cpp" -o "$example" -L "$source/build/release/lib" -lhaptolith_recording \
    -lhaptolith "-Wl,-rpath,$source/build/release/lib"
  x86_64-w64-mingw32-g++-posix -std=c++17 -O1 -static "${headers[@]}" "$source/examples/cpp/$example.cpp" -o "$example.exe" \
    "$library/libhaptolith_recording.dll.a" "$library/libhaptolith.dll.a"
done
cp "$library"/haptolith*.dll .
in_wine() { /usr/lib/wine/wine64 "$@" 2> "$folder/errors" | tr -d '\r'; }
compare "forces of examples/c/dig.c" "$(./dig)" "$(in_wine dig.exe)"
compare "forces of examples/cpp/own_loop.cpp" "$(./own_loop)" "$(in_wine own_loop.exe)"
compare "recording of examples/cpp/record.cpp" "$(./record linux.h5)" "$(in_wine record.exe windows.h5)"
for target in AVX2 SSE4 SSSE3 SCALAR; do
  export HAPTOLITH_SIMD=$target
  compare "state with $target" "$(./state_hash)" "$(in_wine state_hash.exe)"
done
exit "$failed"
