#!/usr/bin/env bash
# Compiles the C# package with Debian's mono and checks it: run.sh HOW BUILD_FOLDER WORK_FOLDER
#   layout   structs lie in memory as in C
#   library  the package's tests, and the same hash and forces as the examples in C
#   sample   the same package as Unity compiles it, with a mock of Unity, and the sample
# Without mcs and mono it is skipped, with status 77.
set -euo pipefail
how=$1 build=$2 work=$3
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
here=$source/tests/unity package=$source/contrib/unity/org.haptolith
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

# same WHAT OF_C OF_CS
same() {
  [[ -n $2 && $2 == "$3" ]] || fail "$1 is '$2' in C and '$3' in C#"
  printf '%s of C:  %s\n%s of C#: %s\n' "$1" "$2" "$1" "$3"
}

case $how in
  layout)
    compile Haptolith.dll -target:library "$package"/Runtime/*.cs
    /usr/bin/python3 "$source/contrib/unity/make_native.py" --layout .
    compileC layout layout.c
    compile Layout.exe -r:Haptolith.dll Layout.cs
    ./layout > of_c.txt
    mono Layout.exe > of_cs.txt
    (($(wc -l < of_c.txt) > 100)) || fail "the layout of too few fields is told"
    diff of_c.txt of_cs.txt || fail "C (<) and C# (>) lay structs out differently"
    ;;
  library)
    compile Haptolith.dll -target:library "$package"/Runtime/*.cs
    compile Program.exe -r:Haptolith.dll "$here"/{Expect,FrameTests,LibraryTests,ReloadTests,Program}.cs
    for example in state_hash dig; do
      compileC "$example" "$source/examples/c/$example.c"
    done
    hash=$(./state_hash)
    same "the hash" "$hash" "$(mono Program.exe hash)"
    same "the dig" "$(./dig)" "$(mono Program.exe dig)"
    mono Program.exe tests "$hash"
    ;;
  sample)
    compile Unity.dll -target:library "$here/UnityStub.cs"
    compile Haptolith.dll -target:library -define:UNITY_5_3_OR_NEWER -r:Unity.dll "$package"/Runtime/*.cs
    compile Sample.dll -target:library -r:Haptolith.dll -r:Unity.dll "$package"/Samples~/BedAndTool/*.cs
    compile SampleTests.exe -r:Sample.dll -r:Haptolith.dll -r:Unity.dll "$here"/{Expect,FrameTests,SampleTests}.cs
    mono SampleTests.exe
    ;;
  *) fail "HOW is layout, library or sample, not '$how'" ;;
esac
