#!/bin/bash
# What docs/SECURITY.md says of the program itself: what listens, who may read what it keeps under the unit, where the
# password is not to be found, credentials of systemd, who may send on CAN. Run inside tests/vcan/run, in ctest -C long;
# what needs no CAN is looked at by recipe_mosquitto.sh, too.
. "$(dirname "$0")/recipe_lib.sh"
broker_host=broker.plant.example
credentials=(-u dashboard -P change-me-2)
hosts broker.plant.example
recipe mosquitto
recipe_do mosquitto Broker
configuration=$site/etc/canopen-gateway/gateway.toml
secret=change-me-1
sed -i -e "/^name = \"line3\"/a state_dir = \"$work/state\"\ncontrol = \"$work/control\"" \
  -e 's/^writers = .*/writers = ["mqtt", "modbus"]\nlease = "60s"/' "$configuration"
printf '[modbus]\nlisten = ["127.0.0.1:1502"]\n' >>"$configuration"
chmod 600 "$site/etc/canopen-gateway/mqtt-password"
recipe_broker mosquitto plant.conf
wait_until 10 "the broker listens" bash -c "echo >/dev/tcp/$broker_host/$broker_port"

say "secrets by systemd: a credential goes before the file beside the configuration"
mkdir "$work/credentials"
mv "$site/etc/canopen-gateway/mqtt-password" "$work/credentials/mqtt-password"
echo wrong >"$site/etc/canopen-gateway/mqtt-password"
unit() { sed -n "s/^$1=//p" "$root/systemd/canopen-gateway.service"; }
umask 022
install -d -m "$(unit StateDirectoryMode)" "$work/state"
umask "$(unit UMask)" || fail "the unit has no UMask"
export CREDENTIALS_DIRECTORY=$work/credentials
recipe_gateway
unset CREDENTIALS_DIRECTORY
recipe_drive
wait_until 15 "the drive is online" is_retained pump1/status online
wait_until 15 "the gateway is online" is_retained status online
expect "a run command by Modbus" written "$(write_registers 5 100 1 3000 0)"

say "what is open"
expect "what listens" "127.0.0.1:1502" \
  "$(ss -Hltunp | grep "pid=${started[gateway]}," | awk '{print $5}')"
expect "the control socket" 660 "$(stat -c %a "$work/control")"
expect "the directory of what is kept" 750 "$(stat -c %a "$work/state")"
expect "files that are not 0600" "" "$(find "$work/state" -type f ! -perm 600)"
expect "directories in it that others may see" "" "$(find "$work/state" -mindepth 1 -type d -perm /077)"
expect_match "that something is kept" . "$(find "$work/state" -type f -size +0 -path '*journal*')"

say "what leaks where"
expect "who holds the lease is told" "modbus 127.0.0.1" "$(field pump1/control .holder)"
expect_match "and stands in the journal" '"from":"127.0.0.1"' "$(cat "$work"/state/journal/*)"
"$gateway_bin" check --config "$configuration" --profile-dir "$root/config/profiles" >"$work/check.out" 2>&1
"$gateway_bin" map --config "$configuration" --profile-dir "$root/config/profiles" >"$work/map.out" 2>&1
"$gateway_bin" status --json --control "$work/control" >"$work/status.out" 2>&1
expect_match "there is a status" '"gateway":"line3"' "$(cat "$work/status.out")"
as dashboard change-me-2 mosquitto_sub -t 'canopen/#' --retained-only -W 2 >"$work/kept.out" 2>/dev/null
expect_match "and topics" online "$(cat "$work/kept.out")"
expect "where the password is" "" "$(grep -l "$secret" "$work"/*.out "$work/gateway.err" "/proc/${started[gateway]}/cmdline" \
  "/proc/${started[gateway]}/environ" "$work"/state/* "$work"/state/*/* 2>/dev/null)"

say "every program of this machine may send on CAN"
traced=can0
launch candump candump -L can0
sleep 1
setpriv --reuid 65534 --regid 65534 --clear-groups cansend can0 000#0105 || fail "nobody may not send"
wait_until 5 "what nobody sent is on the bus" grep -q '000#0105' "$work/candump.out"
