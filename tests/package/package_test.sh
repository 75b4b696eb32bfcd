#!/bin/bash
# The package: built of the release that is tested, lintian has nothing to say, no path of this machine in it, manual pages
# that man accepts, a bill of materials. What plant_test.sh needs is left in build/package: a Debian of its own as an image.
set -euo pipefail
cd "$(dirname "$(realpath "$0")")/../.."
fail() { echo "FAILED: $*"; exit 1; }
into=build/package
start=$SECONDS
scripts/package
deb=$(ls $into/canopen-gateway_*.deb)
echo "built in $((SECONDS - start)) s, installed size $(dpkg-deb -f "$deb" Installed-Size) kB"

# The project has no mail address, so the maintainer has none that could be reached.
lintian --allow-root --fail-on error,warning --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog --tag-display-limit 0 \
  "$into/canopen-gateway.changes"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
dpkg-deb -x "$deb" "$work/root"
program=$work/root/usr/bin/canopen-gateway
! strings -a "$program" | grep -F "$PWD" || fail "the program names folders of this machine"
! readelf -S "$program" | grep -F .debug_info || fail "the program is not stripped"
for page in "$work"/root/usr/share/man/man?/*.gz; do
  complaints=$(LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=80 man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null)
  [ -z "$complaints" ] || fail "${page##*/}: $complaints"
done
commands=$("$program" --help | sed -n '/^Subcommands/,$s/^  \([a-z]*\) .*/\1/p')
[ "$(wc -w <<<"$commands")" -ge 10 ] || fail "commands of the help: $commands"
for command in $commands; do
  zgrep -q "^\.SS \"$command\b" "$work/root/usr/share/man/man1/canopen-gateway.1.gz" || fail "canopen-gateway(1) has no $command"
done
for key in write_from supervise_gateway on_timeout sdo.patience stop_masks; do
  zgrep -q "^\\\\fB${key##*.}\\\\fR" "$work/root/usr/share/man/man5/gateway.toml.5.gz" || fail "gateway.toml(5) has no $key"
done
jq -e '.components | length > 10 and all(.version != "" and .purl != "")' "$work/root/usr/share/doc/canopen-gateway/sbom.cdx.json" \
  >/dev/null || fail "the bill of materials"
# The links of the manual, as it is installed.
/usr/bin/python3 -B - "$work/root/usr/share/doc/canopen-gateway" <<'PY' || fail "links of the installed manual"
import pathlib, sys
sys.path.insert(0, "tests/manual")
import pages
root = pathlib.Path(sys.argv[1])
broken = [each for page in root.rglob("*.md") for each in pages.broken_links(page, root)]
sys.exit("\n".join(broken) or None)
PY
# The completion, as bash asks for it.
offered=$(bash -c '. "$1"; COMP_WORDS=(canopen-gateway sd); COMP_CWORD=1; _canopen_gateway; echo "${COMPREPLY[*]}"' \
  - "$work/root/usr/share/bash-completion/completions/canopen-gateway")
[ "$offered" = sdo ] || fail "completion of sd: '$offered'"

start=$SECONDS
tests/package/root "$deb" "$into" >"$into/image"
echo "a Debian of its own made in $((SECONDS - start)) s"
