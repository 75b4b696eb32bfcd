#!/bin/bash
# 126 drives on one bus power up; then ten of them are dead, and one reboots again and again. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
drives=126
longest=5000  # ms from the first boot-up until all are operational

many_drives "$drives" 'bitrate = 1000000' >"$work/gateway.toml" <<'END'
profile = "cia402-velocity"
[drive.tpdo1]
event_timer = "500ms"
END
start_trace nice
start_gateway
wait_until 20 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
say "power-up"
# shellcheck disable=SC2046
start_drives --tpdo 500ms $(seq -f '--drive cia402-velocity:%g' "$drives")
sleep 5  # Asking takes processes, of which each takes milliseconds of the one processor.
wait_until 60 "all online" register_is 0 2 "$drives"
catch_up
read -r operational took <<<"$(power_up "$drives")"
expect "frames that the trace lost" "" "$(grep DROPCOUNT "$work/candump.out")"
say "$operational operational $took ms after the first boot-up"
say "longest gap of our heartbeat: $(longest_gap ' 77F#') ms"
say "busiest second: $(busiest_second) frames"
say "SDO of a drive: $(drive_says 1 sdo_reads) reads, $(drive_says 1 sdo_writes) writes"
expect "operational on the bus" "$drives" "$operational"
expect "nobody was lost, no alarm" "" "$(lost nobody)"
expect_at_most "ms until all were operational" $longest "$took"

say "ten are dead, one reboots again and again"
mark
dead="11 22 33 44 55 66 77 88 99 110"
for node in $dead; do order "$node" mute on; done
troubled="fan(50|${dead// /|})"
for _ in 1 2 3 4 5 6; do
  order 50 reboot 100
  sleep 1
done
catch_up
expect "boot-ups of the one" 6 "$(frames ' 732#00' | grep -c .)"
expect "nobody else is lost, no alarm" "" "$(lost "$troubled")"
expect "no letter" "" "$(grep ' alarm boot active' "$work/gateway.err")"
wait_until 10 "all others online" register_is 0 2 $((drives - 10))
expect "drives with an alarm: the dead" 10 "$(read_register 0 3)"
expect "what was commanded: NMT start of the one" "" "$(frames "$nmt" | grep -v ' 000#0132$')"
gap=$(longest_gap ' 77F#')
say "longest gap of our heartbeat over all: $gap ms"
