#!/bin/bash
# profiles_test.sh GATEWAY: every shipped profile and configuration passes `check`; warnings are shown, and allowed.
set -u
gateway=$1
cd "$(dirname "$(realpath "$0")")/../.." || exit 1
site=$(mktemp -d) || exit 1
trap 'rm -rf "$site"' EXIT
failed=0

check() {  # check WHAT FILE
  local output status
  output=$("$gateway" --config "$2" --profile-dir config/profiles check 2>&1)
  status=$?
  echo "$1: $output"
  if [ $status != 0 ] || ! grep -qxE 'ok: [0-9]+ bus(es)?, [0-9]+ drives?, [1-9][0-9]* signals' <<<"$output"; then
    echo "FAILED: $1, exit status $status" >&2
    failed=1
  fi
}

for profile in config/profiles/*.toml; do
  name=$(basename "$profile" .toml)
  printf '[[bus]]\nname = "can0"\n\n[[drive]]\nname = "drive1"\nnode = 5\nprofile = "%s"\n' "$name" >"$site/gateway.toml"
  if grep -q '^partial = true' "$profile"; then
    continue  # A part of others, checked with them.
  fi
  check "$name" "$site/gateway.toml"
done
for file in config/*.toml; do
  check "$file" "$file"
done
exit $failed
