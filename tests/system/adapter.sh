#!/bin/bash
# The gateway at a serial CAN adapter (slcan) whose bus is vcan0, where a drive and the trace are: what the adapter tells
# of its controller, a bus on which nobody acknowledges, bus-off, and an adapter that is pulled and plugged. Each is an
# alarm, each ends, and no command leaves late but the one that the controller holds. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/adapter_lib.sh"
set_point='605#2[BF]302001'  # an SDO download of the frequency command
traced=any  # What the driver was given is on the adapter's interface, what left on vcan0.
left=' vcan0 ([2-5]05#|605#[0-3CD]|000#)'

# bus_is NUMBER NAME: in the diagnostics, in the log, and as an alarm where it is one
bus_is() {
  wait_until 5 "bus is $2" register_is 0 100 "$1"
  wait_until 5 "bus is $2 in the log" bash -c "grep ' bus can0: ' '$work/gateway.err' | tail -n 1 | grep -q '$2'"
  wait_until 5 "alarm of $2" field_is bus/can0/alarm .active "$([ "$1" = 0 ] && echo false || echo true)"
}
is_served() {
  wait_until 10 "pump1 online" is_retained pump1/status online
  wait_until 5 "pump1 has fresh values" field_is pump1/state .fresh true
}
command_later() { # command_later VALUE: the answer goes to $work/answer.VALUE
  write_registers 5 101 "$1" >"$work/answer.$1" &
}

plug
sed "s/\"vcan0\"/\"$can\"/" "$root/tests/system/gateway.toml" |
  awk '/^\[\[drive\]\]/ {drives++} drives == 0 || drives == 2' >"$work/gateway.toml"
printf '\n[drive.signals.rated_voltage]\npoll = "1h"\n' >>"$work/gateway.toml"  # No read comes before a command.
start_broker
start_trace
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
start_drives --drive veichi-ac310:5
is_served
expect_match "it is told that nothing tells of a departure" 'IFF_ECHO' "$(cat "$work/gateway.err")"
expect "a set-point" written "$(write_registers 5 101 1000)"

say "what the controller tells"
adapter say sw100003
bus_is 1 warning
adapter say sp128005
bus_is 2 passive
expect "transmit and receive errors" "5 128" "$(read_register 0 102) $(read_register 0 103)"
expect "a set-point" written "$(write_registers 5 101 1100)"
adapter say sa000000
bus_is 0 error-active

say "nobody acknowledges: one command is in the controller, the others wait"
mark
adapter hold
for value in 1200 1300 1400; do command_later $value; done
adapter say e1a
adapter say sp000128
bus_is 2 passive
wait_until 5 "that nobody acknowledges is in the log" \
  bash -c "grep ' bus can0: ' '$work/gateway.err' | tail -n 1 | grep -q 'nobody acknowledges our frames'"
wait_until 5 "pump1 is lost" field_is pump1/alarm/heartbeat .active true
expect "pump1" offline "$(retained pump1/status)"
for value in 1200 1300 1400; do
  # A later one of the same client supersedes one that waits.
  expect_match "set-point $value is not confirmed" 'respond|device or server failure' "$(cat "$work/answer.$value")"
done
expect "and now it is refused" "Target device failed to respond" "$(write_registers 5 101 1500)"
expect_frames "the driver has one of them" 1 " $can $set_point"
expect_no_frames "no command left" "$left"
adapter on
adapter say sa000000
bus_is 0 error-active
is_served
sleep 2
expect_frames "the one from the controller left, and no other" 1 "$left"
expect_frames "it is the set-point" 1 " vcan0 $set_point"

say "bus-off while commands wait behind one that is under way"
order 5 sdo-drop 100
mark
for value in 2200 2300 2400; do command_later $value; done
wait_until 5 "one is under way" frames " vcan0 $set_point"
adapter off
adapter say sb255255
order 5 behave
bus_is 3 bus-off
for value in 2200 2300 2400; do
  wait_until 5 "set-point $value is answered" test -s "$work/answer.$value"
  expect_match "set-point $value is not confirmed" 'respond|device or server failure' "$(cat "$work/answer.$value")"
done
expect "bus-offs" 1 "$(read_register 0 104)"
expect "pump1" offline "$(retained pump1/status)"
expect "a set-point is refused" "Target device failed to respond" "$(write_registers 5 101 2500)"
adapter on
ip link set "$can" down
ip link set "$can" up
bus_is 0 error-active
is_served
sleep 2
expect_frames "the one that was under way left, and no other" 1 "$left"
expect_frames "nor was another handed over" 1 " $can ([2-5]05#|605#[0-3CD]|000#)"

say "the adapter is pulled, and plugged"
mark
pull
bus_is 4 down
expect "pump1" offline "$(retained pump1/status)"
expect "a set-point is refused" "Target device failed to respond" "$(write_registers 5 101 3500)"
before=$can
plug
expect "the interface's name" "$before" "$can"
bus_is 0 error-active
is_served
expect_no_frames "no command" "$left"
expect "a set-point" written "$(write_registers 5 101 3600)"
