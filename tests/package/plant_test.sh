#!/bin/bash
# The package that package_test.sh built, installed on a Debian of its own with systemd: what plant.sh does there.
set -euo pipefail
cd "$(dirname "$(realpath "$0")")/../.."
into=build/package
deb=$(ls $into/canopen-gateway_*.deb)
image=$(cat $into/image)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The same with a higher version.
dpkg-deb -R "$deb" "$work/newer"
sed -i 's/^Version: .*/&+newer/' "$work/newer/DEBIAN/control"
mkdir "$work/shared"
cp "$deb" "$work/shared/canopen-gateway.deb"
dpkg-deb --root-owner-group -b "$work/newer" "$work/shared/canopen-gateway-newer.deb" >/dev/null
cp tests/package/plant.sh "$work/shared/script"
cp tests/package/addresses.sh "$work/shared"
tests/system/recipe_files.py docs/SECURITY.md "$work/shared/drop-ins" >/dev/null
tests/package/boot -t 600 "$image" "$work/shared"
