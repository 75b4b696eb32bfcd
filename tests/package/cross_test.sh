#!/bin/bash
# The package for arm64: cross-built, with a program of that machine, with the manual pages of this one's. It is installed and
# run by qemu-user-static: its `check` finds in the example what the one of this machine finds.
set -euo pipefail
cd "$(dirname "$(realpath "$0")")/../.."
fail() { echo "FAILED: $*"; exit 1; }
start=$SECONDS
scripts/package-cross arm64 build/package
deb=$(ls build/package/arm64/canopen-gateway_*_arm64.deb)
echo "built in $((SECONDS - start)) s"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"
dpkg-deb -x "$deb" "$work/arm64"
dpkg-deb -x build/package/canopen-gateway_*_amd64.deb "$work/amd64"
readelf -h "$work/arm64/usr/bin/canopen-gateway" | grep -q 'Machine: *AArch64' || fail "it is no program for arm64"
diff -r "$work/arm64/usr/share/man" "$work/amd64/usr/share/man" || fail "the manual pages"
jq -r '.components[].purl' "$work/arm64/usr/share/doc/canopen-gateway/sbom.cdx.json" >"$work/purls"
[ "$(grep -c 'arch=arm64$' "$work/purls")" -gt 10 ] && ! grep 'arch=amd64' "$work/purls" || fail "the bill of materials"

# Installed beside the programs of this machine, whose Debian runs it by qemu. What a hook prints is mmdebstrap's.
install -m 666 /dev/null "$work/said"
cat >"$work/try" <<'HOOK'
#!/bin/sh
set -eu
cp "$(dirname "$0")/arm64.deb" "$1/"
chroot "$1" apt-get -q=2 -y --no-install-recommends install /arm64.deb >&2
{
  chroot "$1" qemu-aarch64-static /usr/bin/canopen-gateway --version
  chroot "$1" qemu-aarch64-static /usr/bin/canopen-gateway check --config /usr/share/canopen-gateway/gateway.toml.example
} >"$(dirname "$0")/said"
HOOK
chmod 755 "$work/try"
cp "$deb" "$work/arm64.deb"
start=$SECONDS
mmdebstrap --quiet --format=null --variant=minbase --architectures="$(dpkg --print-architecture),arm64" \
  --include=qemu-user-static --customize-hook="$work/try" bookworm >"$work/log" 2>&1 || {
  cat "$work/log"
  fail "on arm64"
}
echo "installed and run in $((SECONDS - start)) s"
cat "$work/said"
grep -qx "$("$work/amd64/usr/bin/canopen-gateway" --version)" "$work/said" || fail "its version"
"$work/amd64/usr/bin/canopen-gateway" --profile-dir "$work/amd64/usr/share/canopen-gateway/profiles" check \
  --config "$work/amd64/usr/share/canopen-gateway/gateway.toml.example" | sed "s|$work/amd64||" >"$work/expected"
grep -q '^ok: ' "$work/expected" || fail "check on this machine"
diff "$work/expected" <(tail -n "$(wc -l <"$work/expected")" "$work/said") || fail "check finds something else than on this machine"
