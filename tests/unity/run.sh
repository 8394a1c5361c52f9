#!/usr/bin/env bash
# Compiles the C# package with Debian's mono and looks at what it does: run.sh HOW BUILD_FOLDER WORK_FOLDER
#   layout   structs lie in memory as in C
# Without mcs and mono it is skipped, with status 77.
set -euo pipefail
how=$1 build=$2 work=$3
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
package=$source/unity/org.haptolith
export LD_LIBRARY_PATH=$build/lib HAPTOLITH_CACHE=off

for program in mcs mono; do
  if ! command -v "$program" > /dev/null; then
    printf 'run.sh: skipped, because there is no %s: apt-get install mono-mcs mono-runtime\n' "$program"
    exit 77
  fi
done
mkdir -p "$work"
cd "$work"

fail() {
  printf 'run.sh: %s\n' "$1" >&2
  exit 1
}

# compile OUT ARGUMENTS...
compile() { mcs -unsafe -langversion:7 -warnaserror -out:"$1" "${@:2}"; }

# compileC OUT SOURCE
compileC() { cc -std=c99 -I"$source/include" -I"$build/include" "$2" -L"$build/lib" -lhaptolith -o "$1"; }

case $how in
  layout)
    compile Haptolith.dll -target:library "$package"/Runtime/*.cs
    python3 "$source/unity/make_native.py" --layout .
    compileC layout layout.c
    compile Layout.exe -r:Haptolith.dll Layout.cs
    ./layout > of_c.txt
    mono Layout.exe > of_cs.txt
    (($(wc -l < of_c.txt) > 100)) || fail "the layout of too few fields is told"
    diff of_c.txt of_cs.txt || fail "C (<) and C# (>) lay structs out differently"
    ;;
  *) fail "HOW is layout, not '$how'" ;;
esac
