#!/usr/bin/env bash
# Runs haptolith.exe of `./dev build windows` in Wine and compares it with the program of `./dev build`: states, recordings in both
# directions, the page in Chromium, and bad input. tests/packages/windows_program.sh
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
linux=$source/build/release/apps/haptolith/haptolith
folder=$(mktemp -d)
cleanup() { WINEPREFIX=$folder/wine wineserver -k > /dev/null 2>&1 || true; rm -rf "$folder"; }
trap cleanup EXIT
export WINEPREFIX=$folder/wine WINEDEBUG=-all LC_ALL=C.UTF-8
failed=0

say() { printf 'windows_program.sh: %s\n' "$*"; }
# expect NAME WANTED FOUND: whether FOUND contains WANTED.
expect() {
  if [[ $3 == *"$2"* ]]; then say "$1: ok"; else say "$1: expected '$2', got '$3'"; failed=1; fi
}
value() { /usr/bin/python3 -c "import json, sys; print(json.load(sys.stdin)['$1'])"; }

for file in "$linux" "$source"/build/windows/apps/haptolith/haptolith{,-workbench}.exe; do
  [[ -e $file ]] || { echo "windows_program.sh: no $file: ./dev build; ./dev build windows" >&2; exit 2; }
done
cd "$folder"
mkdir "a folder with ümlauts" && cd a*
cp "$source"/build/windows/apps/haptolith/haptolith{,-workbench}.exe .
in_wine() { /usr/lib/wine/wine64 ./haptolith.exe "$@" 2>&1 | tr -d '\r'; }

expect "version" "$("$linux" version)" "$(in_wine version)"
run=(run icra2021 --duration-s 10 --no-realtime --no-serve --json)
expect "state after 10 s" "$("$linux" "${run[@]}" 2> /dev/null | value state_hash)" \
  "$(/usr/lib/wine/wine64 ./haptolith.exe "${run[@]}" 2> /dev/null | value state_hash)"

record=(run icra2021 --duration-s 2 --no-realtime --no-serve --record)
in_wine "${record[@]}" "würfel.h5" > /dev/null
expect "its recording, on Linux" verified "$("$linux" replay "würfel.h5" --verify 2>&1)"
"$linux" "${record[@]}" linux.h5 > /dev/null 2>&1
expect "Linux's recording" verified "$(in_wine replay linux.h5 --verify)"
expect "a command of the workbench" "friction angle" "$(in_wine lab shear --help)"
expect "soils" ottawa-f65 "$(in_wine soil list)"
expect "a study" "15 trials" "$(in_wine study new friction.study --protocol icra2021-friction)"
expect "its state" "no participants yet" "$(in_wine study status friction.study)"

expect "an unknown option" "haptolith: error:" "$(in_wine run --nonsense || true)"
expect "a missing file" "no such" "$(in_wine run missing.toml || true)"
long=$(printf 'x%.0s' {1..240})
expect "a name of 240 letters" "" "$(in_wine run icra2021 --duration-s 0.1 --no-realtime --no-serve --record "$long.h5" || true)"
/usr/bin/python3 -m http.server 18471 --bind 127.0.0.1 > /dev/null 2>&1 &
server=$!
sleep 1
expect "a port in use" 18471 "$(in_wine run icra2021 --port 18471 --duration-s 1 || true)"
kill "$server"

/usr/lib/wine/wine64 ./haptolith.exe run icra2021 --port 18472 > page.log 2>&1 &
for _ in {1..60}; do
  curl -s -o /dev/null "http://127.0.0.1:18472/" && break
  sleep 1
done
expect "the page in Chromium" "furrow" "$(cd "$source/web" && npm run --silent newcomer -- http://127.0.0.1:18472/ 2>&1)"
exit "$failed"
