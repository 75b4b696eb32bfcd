#!/bin/bash
# 24 drives power up on a bus of 125 kbit/s: a queue before vcan lets no more frames through, first in first out, and our
# echo comes when a frame leaves it. Nobody is lost, no boot fails, and our heartbeat comes in time. Run inside
# tests/vcan/run.
. "$(dirname "$0")/lib.sh"
drives=24
frames_per_s=926           # of 8 bytes with usual stuffing; each counts 16 bytes with the queue
longest_heartbeat_gap=700  # ms; due each 500 ms

# Frames go back to us by the driver, when they leave the queue, only where vcan was loaded with echo=1. The module may be
# that of the whole machine (see tests/vcan/run), where others want it as it was.
leave() {
  local code=$?
  ip link del vcan0
  modprobe -r vcan && modprobe vcan
  (exit $code)
  finish
}
if [ "$(cat /sys/module/vcan/parameters/echo)" != Y ]; then
  ip link del vcan0
  modprobe -r vcan || fail "vcan is to be loaded with echo=1, but somebody else has an interface of it"
  trap leave EXIT
  modprobe vcan echo=1
  ip link add vcan0 type vcan
fi
tc qdisc add dev vcan0 root tbf rate $((frames_per_s * 16 * 8))bit burst 16 limit 16000 || fail "no tbf"
ip link set vcan0 up

many_drives "$drives" 'bitrate = 125000' >"$work/gateway.toml" <<'END'
profile = "cia402-velocity"
[drive.tpdo1]
event_timer = "500ms"
END
start_trace
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
say "power-up"
# shellcheck disable=SC2046
start_drives --tpdo 500ms $(seq -f '--drive cia402-velocity:%g' "$drives")
sleep 4
wait_until 30 "all online" register_is 0 2 "$drives"
sleep 3
catch_up
read -r operational took <<<"$(power_up "$drives")"
say "$operational operational $took ms after the first boot-up"
expect "operational on the bus" "$drives" "$operational"
gap=$(longest_gap ' 77F#')
say "longest gap of our heartbeat: $gap ms of $(grep -c ' 77F#' "$work/candump.out") heartbeats"
expect_at_most "longest gap of our heartbeat, ms" $longest_heartbeat_gap "$gap"
expect "all online" "$drives" "$(read_register 0 2)"
expect "drives with an alarm" 0 "$(read_register 0 3)"
for node in $(seq "$drives"); do
  expect "node $node: boot result" 0 "$(read_register "$node" 1002)"
  expect "node $node: heartbeat losses" 0 "$(read_register "$node" 1014)"
done
expect "nobody was lost, no alarm" "" "$(lost nobody)"
busiest=$(busiest_second)
say "busiest second: $busiest frames"
expect_at_most "frames of the busiest second, for the queue lets no more through" $((frames_per_s + 10)) "$busiest"
expect "the echo comes from behind the queue" "" "$(grep IFF_ECHO "$work/gateway.err")"
say "SDO of a drive: $(drive_says 1 sdo_reads) reads, $(drive_says 1 sdo_writes) writes"
