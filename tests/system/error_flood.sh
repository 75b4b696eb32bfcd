#!/bin/bash
# A bus with a broken wire, whose driver tells of thousands of errors a second: the drives are served as before, Modbus
# answers as beside as many frames, what is wrong is told in few lines, and every error is counted. Run inside
# tests/vcan/run.
. "$(dirname "$0")/lib.sh"
port=9464
socket=$work/control
rate=2000
count=6000

api() { curl -sS --max-time 10 "http://127.0.0.1:$port$1"; }
bus() { api /api/buses | jq -r ".[0] | $1"; }
lines() { wc -l <"$work/gateway.err"; }
# flood KIND: Modbus is asked meanwhile; for $took seconds
flood() {
  local begun=$SECONDS
  modbus_begin
  python3 "$root/tests/system/flood.py" vcan0 "$1" "$count" "$rate" >/dev/null || fail "no flood"
  modbus_end "beside $rate/s of $1"
  took=$((SECONDS - begun + 1))
}
# Twice the time at most, by the clock or beside the bare server: what else the machine does is seen in one of them.
as_beside_frames() {
  local by_clock=$((100 * p99 / p99_before)) by_bare=$((100 * percent / percent_before))
  say "99 % of the reads: $by_clock % of before, beside a bare server $by_bare %"
  expect_at_most "99 % of the reads, in percent of before" 200 $((by_clock < by_bare ? by_clock : by_bare))
}

# The long time: a busy machine loses no drive.
sed -e '/^node = /a heartbeat_timeout = "15s"' -e "/^\[gateway\]/a state_dir = \"$work/state\"\ncontrol = \"$socket\"" "$root/tests/system/gateway.toml" \
  >"$work/gateway.toml"
printf '[http]\nlisten = "127.0.0.1:%s"\n[recorder]\nbefore = "90s"\nafter = "1s"\n' "$port" >>"$work/gateway.toml"
mkdir -m 700 "$work/state"
start_broker
start_gateway
start_four_drives
for drive in fan1 pump1 hoist1 mixer1; do wait_until 45 "$drive online" is_retained "$drive/status" online; done
hoist_sets() { expect "hoist1 takes a set-point, $1" written "$(write_registers 7 101 "$2")"; }

say "so many frames"
flood data
p99_before=$p99 percent_before=$percent
hoist_sets "beside frames" 3000
expect "no error yet" 0 "$(bus .error_frames.most)"

say "as many errors"
quiet=$(lines)
(sleep 2; write_registers 7 101 3100 >"$work/meanwhile") &
meanwhile=$!
flood errors
wait "$meanwhile"
expect "hoist1 took a set-point in it" written "$(cat "$work/meanwhile")"
as_beside_frames
expect_at_most "the slowest read, in µs" 500000 "$slowest"
expect "all drives are served" 4 "$(api /health | jq .drives_online)"
expect "no frame is lost" 0 "$(api /api/gateway | jq '.buses[0].frames_lost')"
expect "wiring is suspected" wiring "$(bus .suspicion.kind)"
expect_match "its words" '^wiring or termination may be bad.*: [0-9]{4,} errors in the last minute \([0-9]+ form, [0-9]+ bit, |^wiring or termination may be bad' \
  "$(bus .suspicion.text)"
expect_match "in status" '^bus can0  suspicion: wiring or termination may be bad' "$("$gateway_bin" status --control "$socket")"
expect_at_most "lines of the log for $count errors" 3 $(($(lines) - quiet))
name=$("$gateway_bin" record --bus can0 --control "$socket" | sed -n 's/\.log: .*//p')
wait_until 45 "the record is there" test -s "$work/state/records/$name.json"
expect "every error stands in the record" "$count $count" \
  "$(jq .error_frames "$work/state/records/$name.json") $(grep -c ' 20000088#' "$work/state/records/$name.log")"

say "and a controller that goes to and fro"
quiet=$(lines)
flood states
as_beside_frames
expect "all drives are served" 4 "$(api /health | jq .drives_online)"
expect_match "the bus' alarm was told" 'bus can0: .*error-passive' "$(tail -n +"$((quiet + 1))" "$work/gateway.err")"
# At most two lines a second of the bus, and three of the suspicion.
expect_at_most "lines of the log for $count errors" $((2 * took + 5)) $(($(lines) - quiet))
wait_until 45 "the alarm is over, as the interface says that it is well" \
  bash -c "curl -sS http://127.0.0.1:$port/api/alarms | jq -e 'map(select(.kind == \"bus\")) == []'"
hoist_sets "after it" 3200
