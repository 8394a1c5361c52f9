#!/usr/bin/env bash
# Builds the image of packaging/docker/Dockerfile with Debian's buildah, without a registry of images, and digs in it for a second:
# tests/packages/container_image.sh [bookworm|noble]..., as root, with mmdebstrap. Takes a quarter of an hour each and the network.
# Ubuntu's packages are not verified, because Debian does not have its keys.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
(($# > 0)) || set -- bookworm
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT

say() { printf 'container_image.sh: %s\n' "$*"; }
images() { buildah --root "$work/storage" --runroot "$work/run" --storage-driver vfs "$@"; }
# quietly COMMAND...: shows the end of its output when it fails.
quietly() { "$@" > "$work/log" 2>&1 || { tail -n 40 "$work/log"; exit 1; }; }

ccache=()
[[ ! -d $HOME/.cache/ccache ]] || ccache=(--volume "$HOME/.cache/ccache:/root/.cache/ccache")
for suite in "$@"; do
  say "$suite: making the base"
  from=()
  [[ $suite != noble ]] || from=("deb [trusted=yes] http://archive.ubuntu.com/ubuntu noble main universe")
  mmdebstrap --quiet --variant=minbase "$suite" "$work/base.tar" "${from[@]}"
  base=$(images from scratch)
  quietly images add --quiet "$base" "$work/base.tar" /
  quietly images copy --quiet "$base" /usr/local/share/ca-certificates /usr/local/share/ca-certificates  # npm must trust that of a proxy
  quietly images commit --quiet "$base" "base-$suite"
  quietly images rm "$base"
  rm "$work/base.tar"

  say "$suite: building the image"
  quietly images build --isolation chroot --pull-never --build-arg "BASE=localhost/base-$suite" "${ccache[@]}" --tag "haptolith-$suite" \
    --file "$source/packaging/docker/Dockerfile" "$source"
  container=$(images from --pull-never "localhost/haptolith-$suite")
  within() { images run --isolation chroot "$container" -- "$@"; }
  quietly within haptolith lab shear --help
  hash=$(within haptolith run icra2021 --no-realtime --duration-s 1 --json | grep -o '"state_hash": "[^"]*"')
  user=$(within id --user --name)
  [[ $user == haptolith ]] || { say "$suite: the program runs as $user"; exit 1; }
  say "$suite: $(within haptolith version), $hash, user $user, $(images images | awk -v name="localhost/haptolith-$suite" '$1 == name { print $4, $5 }')"
  quietly images rm "$container"
done
