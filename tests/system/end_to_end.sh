#!/bin/bash
# Four simulated drives on a real SocketCAN interface, seen and commanded through Modbus TCP and MQTT by independent
# clients. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
cp "$root/tests/system/gateway.toml" "$work/gateway.toml"

online() { # seconds since $1 (ms) until all four drives are online
  wait_until 10 "all four drives online" register_is 0 2 4
}

say "start: broker, trace, gateway, drives"
start_broker
start_witness
start_trace
begin=$(date +%s%3N)
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
start_four_drives
online
say "online $(($(date +%s%3N) - begin)) ms after the gateway was launched, the start of all programs included"
catch_up
say "on the bus: $(awk '/ 70[3579]#00/ {last = $1} / 000#01/ {start = $1} END {gsub(/[()]/, "", last);
  gsub(/[()]/, "", start); printf "%.0f ms from the last boot-up to the last NMT start", (start - last) * 1000}' "$work/candump.out")"
for drive in fan1 pump1 hoist1 mixer1; do
  wait_until 5 "$drive online on MQTT" is_retained "$drive/status" online
  wait_until 5 "$drive has fresh values" field_is "$drive/state" .fresh true
done
expect "broker status" online "$(retained status)"
expect "gateway unit: drives" 4 "$(read_register 0 1)"
expect "gateway unit: mqtt" 1 "$(read_register 0 4)"

say "TPDO values on both sides"
status=$(read_register 5 0)
expect_match "pump1 status word" '^[0-9]+$' "$status"
expect "pump1 running" false "$(retained pump1/running)"
expect "pump1 output_frequency" 0.00 "$(retained pump1/output_frequency)"
expect_match "hoist1 dc_bus_voltage" '^[0-9]{3}\.[0-9]$' "$(retained hoist1/dc_bus_voltage)"
expect_match "mixer1 status word" '^[0-9]+$' "$(read_register 9 0)"

say "no command moved anything so far"
for node in 3 5 7 9; do
  expect "node $node: no run command" 0.00 "$(drive_says "$node" frequency)"
done
expect_no_frames "no RPDO without a command" ' [2-5]0[3579]#'

say "a Modbus write runs a motor; it is answered after it took effect"
expect "hoist1: frequency and run in two writes" written "$(write_registers 7 101 3000)"
expect_frames "the set-point alone went by SDO" 1 ' 607#2B002103B80B0000'
expect "hoist1: run" written "$(write_registers 7 100 1)"
wait_until 10 "hoist1 runs up" register_is 7 2 3000
expect "hoist1 running" true "$(retained hoist1/running)"
expect "reads what was confirmed" 3000 "$(read_register 7 101)"

say "an MQTT set runs a motor up"
answer=$(ask pump1/set '{"frequency_command":30.0,"torque_command":0.0,"control_command":1,"id":"a1"}')
expect_match "answer" '"ok":true' "$answer"
expect_match "answer's id" '"id":"a1"' "$answer"
expect_frames "it left as one RPDO" 1 ' 205#0100B80B0000'
wait_until 10 "pump1 runs up" register_is 5 2 3000
answer=$(ask pump1/frequency_command/set 20.5)
expect_match "a single set-point" '"ok":true' "$answer"
wait_until 10 "pump1 slows down" is_retained pump1/output_frequency 20.50

say "refusals change nothing"
mark
expect_match "out of range" '"code":"range"' "$(ask pump1/frequency_command/set 50.01)"
expect_match "no number" '"code":"type"' "$(ask pump1/frequency_command/set fast)"
expect_match "read-only" '"code":"read-only"' "$(ask pump1/output_frequency/set 1)"
expect_match "not while running" '"code":"forbidden"' "$(ask pump1/nmt/set stop)"
expect "Modbus: out of range" "Illegal data value" "$(write_registers 5 101 5001)"
expect "Modbus: no such address" "Illegal data address" "$(write_registers 5 2 1)"
expect "Modbus: no such unit" "Gateway path unavailable" "$(read_register 77 0)"
retained_command=$topics/fan1/frequency_command/set
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -r -t "$retained_command" -m 10
wait_until 5 "a retained command is emptied" is_emptied "$retained_command"
wait_until 5 "and refused" grep -q '"code":"retained"' "$work/witness.out"
expect_no_frames "no command to any drive" "$nmt|$(commands_to 3579)"

say "emergencies become alarms with the drive's own texts"
order 5 fault 0x0005
wait_until 5 "AC310: alarm" field_is pump1/alarm/emcy .active true
expect_frames "EMCY frame of the AC310" 1 ' 085#0500010500000000'
expect "AC310 text" "Overcurrent during acceleration" "$(field pump1/alarm/emcy .text)"
expect "AC310 code" 0x0005 "$(field pump1/alarm/emcy .code)"
expect "register 1003" 5 "$(read_register 5 1003)"
order 3 fault 0x0004
wait_until 5 "AC300: code 0x0004 is an alarm, not a reset" field_is fan1/alarm/emcy .active true
expect "AC300 text" "Overcurrent during acceleration" "$(field fan1/alarm/emcy .text)"
order 7 fault 1
wait_until 5 "Goodrive: alarm" field_is hoist1/alarm/emcy .active true
expect_frames "EMCY frame of the Goodrive" 1 ' 087#0030040100000000'
expect "Goodrive code" 0x3000 "$(field hoist1/alarm/emcy .code)"
expect "Goodrive register" 0x04 "$(field hoist1/alarm/emcy .register)"
expect "Goodrive vendor" 0100000000 "$(field hoist1/alarm/emcy .vendor)"
expect_match "Goodrive text" "OUt1.*[Ii]nverter unit.*phase U" "$(field hoist1/alarm/emcy .text)"
for node in 3 5 7; do order $node clear; done
for drive in fan1 pump1 hoist1; do
  wait_until 10 "$drive: alarm over" field_is "$drive/alarm/emcy" .active false
done

say "a drive that falls silent"
order 7 clear
write_registers 7 100 1 >/dev/null
mark
order 5 mute on
wait_until 5 "heartbeat alarm" field_is pump1/alarm/heartbeat .active true
expect "status" offline "$(retained pump1/status)"
expect "reads are answered 0x0B" "Target device failed to respond" "$(read_register 5 2)"
expect "online bit in the diagnostics" 0 "$(($(read_register 5 1000) & 1))"
expect "heartbeat losses" 1 "$(read_register 5 1014)"
expect "a command is refused" "Target device failed to respond" "$(write_registers 5 101 1000)"
for unit in 3 7 9; do
  expect_match "unit $unit is undisturbed" '^[0-9]+$' "$(read_register $unit 0)"
  expect "unit $unit: online, operational, fresh" 19 "$(($(read_register $unit 1000) & 19))"
done
expect "drives with an alarm: this one alone" 1 "$(read_register 0 3)"
for drive in fan1 hoist1 mixer1; do
  expect "$drive: no lost heartbeat" false "$(field "$drive/alarm/heartbeat" .active)"
  expect "$drive: no emergency" false "$(field "$drive/alarm/emcy" .active)"
done
expect_no_frames "no NMT command" "$nmt"

say "and returns"
mark
order 5 mute off
wait_until 10 "pump1 online again" is_retained pump1/status online
wait_until 5 "values again" field_is pump1/state .fresh true
wait_until 5 "heartbeat alarm over" field_is pump1/alarm/heartbeat .active false
expect_match "reads again" '^[0-9]+$' "$(read_register 5 2)"
expect_no_frames "no RPDO to it before a new command" ' [2-5]05#'
expect_no_frames "the set-point is not remembered as commanded" ' 605#2[BF3]3020'

say "a reboot of a drive"
mark
order 9 reboot
wait_until 5 "mixer1 gone or rebooted" frames ' 709#00'
wait_until 10 "mixer1 online again" is_retained mixer1/status online
expect_no_frames "no RPDO to it" ' [2-5]09#'

say "the orderly end says so and sends the drives nothing"
mark
kill -TERM "${started[gateway]}"
wait "${started[gateway]}"
expect "exit code" 0 $?
unset "started[gateway]"
expect "B/status" offline "$(retained status)"
expect "pump1 status" offline "$(retained pump1/status)"
# The last polls (uploads: 0x4., 0x6., 0x7.) may still come before the signal; nothing else, an SDO abort neither.
expect_no_frames "nothing was sent to a drive" "$nmt| [2-5]0[3579]#| 60[3579]#[^467]"

say "the recorded trace, read by an independent decoder"
grep -v ' 7F0#' "$work/candump.out" >"$work/trace.log"  # without those of catch_up
[ -n "${KEEP_TRACE:-}" ] && cp "$work/trace.log" "$KEEP_TRACE"
tshark -r "$work/trace.log" -d can.subdissector,canopen -T fields -e can.id -e _ws.malformed >"$work/decoded" 2>/dev/null
expect "every frame was decoded" "$(wc -l <"$work/trace.log")" "$(grep -c '^[0-9]' "$work/decoded")"
expect "frames that it calls malformed, but for the AC300CAN1's short answers" "" \
  "$(awk -F '\t' '$2 != "" && $1 !~ /^(0x0*583|0x0*585|1411|1413)$/' "$work/decoded")"
