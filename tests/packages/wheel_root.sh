#!/usr/bin/env bash
# Installs the wheel of `./dev wheel` with pip in bare roots of Debian and Ubuntu, digs, and compares the hash of the state with that of
# the program built here: tests/packages/wheel_root.sh [SUITE...|arm64], as root, with mmdebstrap. Takes some minutes and the network.
# Ubuntu's packages are not verified, as Debian does not have its keys. With arm64, the wheel of `./dev wheel arm64` in QEMU,
# unpacked instead of installed.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
processor=x86_64
[[ ${1:-} != arm64 ]] || processor=aarch64
wheel=$(compgen -G "$source/build/wheels/*_$processor.whl" | head -n 1) || { echo "wheel_root.sh: no wheel: ./dev wheel" >&2; exit 2; }
program=$source/build/release/apps/haptolith/haptolith
[[ -x $program ]] || { echo "wheel_root.sh: no program: ./dev build" >&2; exit 2; }
(($# > 0)) || set -- bookworm trixie noble
dig=(run icra2021 --no-realtime --duration-s 2 --json)
expected=$("$program" "${dig[@]}" | grep state_hash)
root=$(mktemp -d)
trap 'umount -q "$root/proc" "$root/dev" 2> /dev/null || true; rm -rf --one-file-system "$root"' EXIT

say() { printf 'wheel_root.sh: %s\n' "$*"; }
within() { chroot "$root" /usr/bin/env -i PATH=/venv/bin:/usr/bin:/bin HOME=/root LC_ALL=C.UTF-8 "$@"; }

if [[ $processor == aarch64 ]]; then
  mmdebstrap --quiet --variant=extract --architectures=arm64 --include=python3-numpy,libpython3-stdlib,libstdc++6 bookworm "$root/root"
  python3 -m zipfile -e "$wheel" "$root/wheel"
  chmod +x "$root/wheel/haptolith/_program/haptolith"
  libraries=$root/root/usr/lib/aarch64-linux-gnu
  emulated=(qemu-aarch64-static -L "$root/root" -E "LD_LIBRARY_PATH=$libraries/blas:$libraries/lapack" -E "PYTHONPATH=$root/wheel")
  dig=(run icra2021 --no-realtime --duration-s 0.1 --json)
  expected=$("$program" "${dig[@]}" | grep state_hash)
  found=$("${emulated[@]}" "$root/wheel/haptolith/_program/haptolith" "${dig[@]}" | grep state_hash)
  [[ $found == "$expected" ]] || { say "arm64: $found instead of $expected"; exit 1; }
  say "arm64: the program has the same $found"
  "${emulated[@]}" "$root/root/usr/bin/python3" -c 'import haptolith, platform; scene = haptolith.Scene(); scene.step([0, 0, 0.1])
print("wheel_root.sh: Python on", platform.machine(), "has stepped a scene")'
  exit
fi

for suite in "$@"; do
  rm -rf "$root" && mkdir -p "$root"
  say "making a root of $suite"
  from=()
  [[ $suite != noble && $suite != jammy ]] || from=("deb [trusted=yes] http://archive.ubuntu.com/ubuntu $suite main universe")
  mmdebstrap --quiet --variant=minbase --include=python3-venv,python3-matplotlib "$suite" "$root" "${from[@]}"
  mount --bind /dev "$root/dev"
  mount -t proc proc "$root/proc"
  mkdir "$root/wheel"
  cp "$wheel" "$root/wheel/"
  cp "$source/examples/python/dig_and_plot.py" "$root/"
  within python3 -m venv --system-site-packages /venv  # numpy and matplotlib are Debian's, as there is no index
  begin=$(date +%s.%N)
  within sh -c 'pip install --no-index --quiet /wheel/*.whl'
  within python3 /dig_and_plot.py /dig.png
  end=$(date +%s.%N)
  [[ -s $root/dig.png ]] || { say "$suite: no plot"; exit 1; }
  found=$(within haptolith "${dig[@]}" | grep state_hash)
  [[ $found == "$expected" ]] || { say "$suite: $found instead of $expected"; exit 1; }
  # Only libraries of every Linux come from the system.
  within sh -c 'ldd /venv/lib/python3*/site-packages/haptolith/*.so* /venv/lib/python3*/site-packages/haptolith/_program/haptolith' |
    awk '$2 == "=>" && $3 !~ "^/venv/" { print $1 }' | sort -u | tr '\n' ' ' > "$root/system"
  say "$(printf '%s: installed and plotted in %.1f s, %s; from the system: %s' "$suite" "$(awk "BEGIN { print $end - $begin }")" \
    "$(du -h "$wheel" | cut -f1)" "$(cat "$root/system")")"
  umount "$root/proc" "$root/dev"
done
