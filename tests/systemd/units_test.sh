#!/bin/bash
# The units are ones that systemd understands to the last key, and the service stays as locked up as it is: exposure 1.5 of
# 10. tests/package looks at it on a running system.
set -eu
cd "$(dirname "$(realpath "$0")")/../../systemd"
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
# The program is not installed here; systemd looks whether it is there.
sed -E 's|^(Exec[A-Za-z]+)=/usr/bin/canopen-gateway|\1=/bin/true|' canopen-gateway.service >"$directory/canopen-gateway.service"
grep -q '^ExecStart=/usr/bin/canopen-gateway run$' canopen-gateway.service
grep -q '^RuntimeDirectory=canopen-gateway$' canopen-gateway.service # where the control socket is by default

# An unknown key is only a remark for systemd-analyze.
cp canopen-gateway.socket can@.service "$directory"
systemd-analyze verify --man=no "$directory/canopen-gateway.service" "$directory/canopen-gateway.socket" \
  "$directory/can@can0.service" 2>"$directory/remarks"
if [ -s "$directory/remarks" ]; then
  cat "$directory/remarks" >&2
  exit 1
fi
systemd-analyze security --offline=yes --threshold=15 "$directory/canopen-gateway.service" >"$directory/report" ||
  { cat "$directory/report" >&2; exit 1; }
tail -n 1 "$directory/report"

# The drop-ins: of the port, of secrets, and those of the security guide.
mkdir "$directory/canopen-gateway.service.d"
cp privileged-port.conf secrets.conf "$directory/canopen-gateway.service.d"
systemd-analyze verify --man=no "$directory/canopen-gateway.service" 2>"$directory/remarks"
if [ -s "$directory/remarks" ]; then
  cat "$directory/remarks" >&2
  exit 1
fi
rm -r "$directory/canopen-gateway.service.d"
# Every example of an interface comes back after bus-off.
grep -q '^RestartSec=' 80-can.network
for example in can0.interfaces can@.service; do
  grep -q 'restart-ms [1-9]' "$example" || { echo "$example: no restart-ms" >&2; exit 1; }
done
cd ..
tests/system/recipe_files.py docs/SECURITY.md "$directory" >/dev/null
mv "$directory"/etc/systemd/system/canopen-gateway.service.d "$directory"/etc/systemd/system/canopen-gateway.socket.d "$directory"
systemd-analyze verify --man=no "$directory/canopen-gateway.service" "$directory/canopen-gateway.socket" 2>"$directory/remarks"
if [ -s "$directory/remarks" ]; then
  cat "$directory/remarks" >&2
  exit 1
fi
systemd-sysusers --dry-run "$PWD/systemd/canopen-gateway.sysusers"
