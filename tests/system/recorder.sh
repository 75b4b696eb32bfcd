#!/bin/bash
# The recorder on a real file system: the log of a drive that trips holds what was before and after, and others read it; a
# disk that is full delays nobody and is told; when there is room again the record is written whole, the one that had to
# wait, too. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
port=9464
state=$work/state
records=$state/records

api() { curl -sS --max-time 10 "http://127.0.0.1:$port$1"; }
# record_of DRIVE: the name of its newest record of an emergency, or nothing
record_of() {
  api /api/records | jq -r "[.[] | select(.drive == \"$1\" and .kind == \"emcy\").name][-1] // \"\""
}
recorded() { [ -n "$(record_of "$1")" ]; }
received() { api /metrics | sed -n 's/^canopen_gateway_bus_frames_received_total{bus="can0"} //p'; }
logged() { grep -c -- "$1" "$work/gateway.err"; }
is_logged() { grep -q -- "$1" "$work/gateway.err"; }

# expect_whole NAME: the JSON and the log agree, the fault stands in it, and 10 s before it and 5 s after it are there.
# An independent decoder reads all of it, and so does the gateway.
expect_whole() {
  local log=$records/$1 json=$records/${1%.log}.json begun
  expect "$1: frames" "$(jq .frames "$json")" "$(wc -l <"$log")"
  expect "$1: nothing is missing" "0 false false null" \
    "$(jq -r '"\(.frames_lost) \(.begin_missing) \(.shortened) \(.ended)"' "$json")"
  begun=$(date -d "$(jq -r .ts "$json")" +%s.%N)
  expect_match "$1: ms before and after" '^(9[5-9]|10[0-5])[0-9]{2} (4[5-9]|5[0-5])[0-9]{2}$' "$(awk -v t="$begun" '
    {at = substr($1, 2) + 0} NR == 1 {before = t - at} END {printf "%.0f %.0f\n", before * 1000, (at - t) * 1000}' "$log")"
  tshark -r "$log" -d can.subdissector,canopen -T fields -e can.id 2>/dev/null >"$work/decoded"
  expect "$1: frames that tshark reads" "$(wc -l <"$log")" "$(grep -c '^[0-9]' "$work/decoded")"
  "$gateway_bin" --config "$work/gateway.toml" --profile-dir "$root/config/profiles" trace "$log" >"$work/words" 2>&1
  expect_match "$1: trace knows the fault" '^[0-9:.]+ can0  08[35] .* EMCY +0x0004 fault: ' "$(grep EMCY "$work/words")"
}

# The gateway with a disk of its own.
mkdir "$state"
mount -t tmpfs -o size=2m,mode=700 none "$state" || fail "no tmpfs"
# The long time: a busy machine loses no drive.
sed -e "/^\[gateway\]/a state_dir = \"$state\"" -e '/^node = /a heartbeat_timeout = "15s"' "$root/tests/system/gateway.toml" >"$work/gateway.toml"
printf '[http]\nlisten = "127.0.0.1:%s"\n[recorder]\n' "$port" >>"$work/gateway.toml"
start_broker
start_gateway
start_four_drives
for drive in fan1 pump1 hoist1 mixer1; do wait_until 45 "$drive online" is_retained "$drive/status" online; done
served_at=$SECONDS

say "a set-point, then pump1 trips"
expect "hoist1: a set-point" written "$(write_registers 7 101 3000)"
while [ $((SECONDS - served_at)) -lt 10 ]; do sleep 0.2; done  # what is before a fault
expect "and another" written "$(write_registers 7 101 3100)"
order 5 fault 4
wait_until 45 "the record is there" recorded pump1
first=$(record_of pump1)
expect_match "its name" '^[0-9]{8}T[0-9]{6}\.[0-9]{3}Z-pump1-emcy\.log$' "$first"
expect_whole "$first"
expect_match "the command of that time stands in it" '31' \
  "$(jq -r '.commands[] | select(.drive == "hoist1") | tostring' "$records/${first%.log}.json")"
expect "the alarm names it" "$first" "$(api /api/alarms | jq -r '.[] | select(.drive == "pump1" and .kind == "emcy").record')"

say "the disk gets full, and fan1 trips"
dd if=/dev/zero of="$state/filler" bs=4k 2>/dev/null
expect "no room" 0 "$(df --output=avail "$state" | tail -n 1 | tr -d ' ')"
frames_before=$(received)
order 3 fault 4
wait_until 45 "it is told" is_logged 'recorder: .*records are not kept meanwhile'
expect_match "with the reason" 'recorder: .*(No space left on device|no room|full).*; records are not kept meanwhile' \
  "$(grep 'records are not kept' "$work/gateway.err")"
told_at=$SECONDS
for ((i = 0; i < 20; i++)); do
  expect "hoist1 takes a set-point $i" written "$(write_registers 7 101 $((3000 + i)))"
  expect "and holds it" $((3000 + i)) "$(read_register 7 101)"
done
while [ $((SECONDS - told_at)) -lt 6 ]; do sleep 0.2; done  # it was tried again
metric() { api /metrics | sed -n "s/^canopen_gateway_recorder_$1 //p"; }
expect "the monitor is told, and that no record is lost yet" "0 0" "$(metric works) $(metric records_lost_total)"
expect "still told once" 1 "$(logged 'records are not kept meanwhile')"
expect "and not said to be over" 0 "$(logged 'records are kept again')"
expect "frames went on" yes "$([ $(($(received) - frames_before)) -gt 200 ] && echo yes)"
expect "no frame is lost" 0 "$(api /metrics | sed -n 's/^canopen_gateway_bus_frames_lost_total{bus="can0"} //p')"
expect "all drives are online" 4 "$(api /health | jq .drives_online)"
expect "nothing half is listed" "" "$(record_of fan1)"
expect "the first one is as it was" "$(jq .frames "$records/${first%.log}.json")" "$(wc -l <"$records/$first")"

say "there is room again"
rm "$state/filler"
wait_until 45 "the record that waited is there" recorded fan1
wait_until 30 "that is told" is_logged 'recorder: records are kept again'
expect "so is the monitor" "1 0" "$(metric works) $(metric records_lost_total)"
second=$(record_of fan1)
expect_match "its name" 'Z-fan1-emcy\.log$' "$second"
expect_whole "$second"
expect "no file is left half written" "" "$(ls "$records" | grep '\.new$')"
kill -TERM "${started[gateway]}"
wait "${started[gateway]}"
expect "the orderly end" 0 $?
unset "started[gateway]"
expect "both are there" "$first $second" "$(cd "$records" && echo *emcy.log)"
kill "${started[simulate]}"; wait "${started[simulate]}" 2>/dev/null; unset "started[simulate]"
umount "$state"
