#!/usr/bin/env bash
# Installs the packages of `./dev package` into a fresh Debian 12 and runs debian/tests there, and add_subdirectory with only what
# docs/how-to/library.md asks for: tests/packages/fresh_root.sh, as root, with Debian's mmdebstrap. Takes some minutes and the network.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=$source/build/packages
compgen -G "$packages/*.deb" > /dev/null || { echo "fresh_root.sh: no packages in $packages: ./dev package" >&2; exit 2; }
root=$(mktemp -d)
trap 'umount -q "$root/proc" "$root/dev" || true; rm -rf --one-file-system "$root"' EXIT

say() { printf 'fresh_root.sh: %s\n' "$*"; }

within() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }

say "making a fresh Debian 12"
mmdebstrap --quiet --variant=apt bookworm "$root"
mount --bind /dev "$root/dev"
mount -t proc proc "$root/proc"
mkdir -p "$root/packages" "$root/source"
cp "$packages"/*.deb "$root/packages/"
rm -f "$root"/packages/*-dbgsym_*.deb
tar -c -C "$source" --exclude=./build --exclude=./.git --exclude=./web --exclude=__pycache__ . | tar -x -C "$root/source"
cp /etc/resolv.conf /etc/hosts "$root/etc/"
within apt-get -q update > /dev/null

# needs PACKAGE...: installs what a test depends on, of ours from /packages. Man pages stay out of small roots unless asked for.
needs() {
  local wanted=() name
  for name in "$@"; do
    if compgen -G "$root/packages/${name}_*.deb" > /dev/null; then wanted+=("$(cd "$root" && ls packages/"${name}"_*.deb | sed 's|^|/|')"); else wanted+=("$name"); fi
  done
  within apt-get -q install -y --no-install-recommends "${wanted[@]}" > "$root/tmp/apt.log" 2>&1 || { tail -20 "$root/tmp/apt.log"; exit 1; }
}

# The libraries that ours need come from Debian, ours from /packages: all together, so that apt knows where they are.
say "installing all packages"
within sh -c 'apt-get -q install -y --no-install-recommends /packages/*.deb' > "$root/tmp/apt.log" 2>&1 || { tail -20 "$root/tmp/apt.log"; exit 1; }

failed=0
# run NAME COMMAND...: a test, in a folder of its own.
run() {
  local name=$1
  shift
  mkdir -p "$root/tmp/$name"
  if within env AUTOPKGTEST_TMP="/tmp/$name" sh -c "cd /source && $*" > "$root/tmp/$name.log" 2>&1; then
    say "passed: $name"
  else
    say "FAILED: $name"
    tail -30 "$root/tmp/$name.log"
    failed=1
  fi
}

while IFS=: read -r field value; do
  case $field in
    Tests) tests=$value ;;
    Depends)
      needs ${value//,/ }
      for test in $tests; do
        run "$test" "debian/tests/$test"
      done
      ;;
  esac
done < "$source/debian/tests/control"

# As a part of somebody's build, with the packages that docs/how-to/library.md names, and no others of ours.
needs $(sed -n '/add_subdirectory(haptolith)/,/to build/p' "$source/docs/how-to/library.md" | grep -oE 'lib[a-z0-9-]+-dev|nlohmann-json3-dev') g++ cmake ninja-build pkg-config
run add-subdirectory 'tests/c_api/consumers.sh add_subdirectory installed "$AUTOPKGTEST_TMP/work"'

# The first hour, for a robotics engineer and in Python, from what is installed.
run first-hour 'cp -r /usr/share/doc/haptolith/examples "$AUTOPKGTEST_TMP" && cd "$AUTOPKGTEST_TMP/examples" && find . -name "*.gz" -exec gunzip {} + &&
  cc c/dig.c $(pkg-config --cflags --libs haptolith) -o dig && ./dig && /usr/bin/python3 python/first_hour.py'

[[ $failed == 0 ]] && say "all passed"
exit "$failed"
