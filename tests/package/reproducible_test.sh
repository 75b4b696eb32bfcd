#!/bin/bash
# Two builds of this tree, in directories of different names and without a compiler cache, are the same to the last bit.
set -euo pipefail
cd "$(dirname "$(realpath "$0")")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for place in one another/place; do
  mkdir -p "$work/$place"
  { git ls-files -z 2>/dev/null || find . -path ./build -prune -o -type f -print0; } |
    tar --null -cf - -T - | tar -C "$work/$place" -xf -
  CCACHE_DISABLE=1 "$work/$place/scripts/package" >/dev/null
done
(cd "$work/one/build/package" && sha256sum -- *.deb) | tee "$work/sums"
cd "$work/another/place/build/package" && sha256sum -c "$work/sums"
