#!/bin/bash
# The unit is one that systemd understands to the last key, and stays as locked up as it is: exposure 1.7 of 10.
set -eu
cd "$(dirname "$(realpath "$0")")/../../systemd"
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
# The program is not installed here; systemd looks whether it is there.
sed 's|^ExecStart=[^ ]*|ExecStart=/bin/true|' canopen-gateway.service >"$directory/canopen-gateway.service"
grep -q '^ExecStart=/usr/bin/canopen-gateway run$' canopen-gateway.service
grep -q '^RuntimeDirectory=canopen-gateway$' canopen-gateway.service # where the control socket is by default

# An unknown key is only a remark for systemd-analyze.
systemd-analyze verify --man=no "$directory/canopen-gateway.service" 2>"$directory/remarks"
if [ -s "$directory/remarks" ]; then
  cat "$directory/remarks" >&2
  exit 1
fi
systemd-analyze security --offline=yes --threshold=17 "$directory/canopen-gateway.service" >"$directory/report" ||
  { cat "$directory/report" >&2; exit 1; }
tail -n 1 "$directory/report"

# The drop-in of the security guide.
cd ..
tests/system/recipe_files.py docs/SECURITY.md "$directory" >/dev/null
mv "$directory"/etc/systemd/system/canopen-gateway.service.d "$directory"
systemd-analyze verify --man=no "$directory/canopen-gateway.service" 2>"$directory/remarks"
if [ -s "$directory/remarks" ]; then
  cat "$directory/remarks" >&2
  exit 1
fi
systemd-sysusers --dry-run "$PWD/systemd/canopen-gateway.sysusers"
