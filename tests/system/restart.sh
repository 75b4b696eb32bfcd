#!/bin/bash
# The gateway is killed while a motor runs, and starts again: nothing is sent to the drive, and its values are live at
# once. The broker restarts, too. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
sed "/^\[gateway\]/a state_dir = \"$work/state\"" "$root/tests/system/gateway.toml" >"$work/gateway.toml"

start_broker
start_trace
start_gateway
start_four_drives
wait_until 10 "all four drives online" register_is 0 2 4
wait_until 10 "connected to the broker" register_is 0 4 1

say "a motor runs"
expect_match "run" '"ok":true' \
  "$(ask pump1/set '{"frequency_command":30.0,"torque_command":0.0,"control_command":1}')"
wait_until 10 "30 Hz" register_is 5 2 3000
order 3 fault 0x0006
wait_until 5 "an alarm stands" field_is fan1/alarm/emcy .active true
alarm=$(field fan1/alarm/emcy .id)

say "kill -9 and start again"
kill -9 "${started[gateway]}"
wait "${started[gateway]}" 2>/dev/null
# The broker gives the gateway 5 s to come back before it tells (will delay).
wait_until 10 "the will says so" is_retained status offline
mark
begin=$(date +%s%3N)
start_gateway
wait_until 5 "values live again" register_is 5 2 3000
say "values live again after $(($(date +%s%3N) - begin)) ms, the start of the program included"
wait_until 5 "all four online" register_is 0 2 4
say "all four drives online after $(($(date +%s%3N) - begin)) ms"
wait_until 5 "MQTT too" is_retained pump1/status online
wait_until 5 "MQTT values" is_retained pump1/output_frequency 30.00
say "on MQTT after $(($(date +%s%3N) - begin)) ms"
expect_no_frames "no NMT command" "$nmt"
expect_no_frames "no RPDO, no SDO write" "$(commands_to 3579)"
expect "the motor still runs" 30.00 "$(drive_says 5 frequency)"
wait_until 10 "the alarm is confirmed again" field_is fan1/alarm/emcy .confirmed true
expect "it is active" true "$(field fan1/alarm/emcy .active)"
expect "and still the same alarm" "$alarm" "$(field fan1/alarm/emcy .id)"
expect "the list names it" fan1 "$(field alarms '.[] | select(.kind == "emcy") | .drive')"

say "an alarm that somebody empties is put right"
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -r -n -t "$topics/fan1/alarm/emcy"
wait_until 5 "the alarm is there again" field_is fan1/alarm/emcy .id "$alarm"

say "a set-point does not carry the old run command"
mark
expect "set-point" written "$(write_registers 5 101 2500)"
expect_frames "one SDO write, no RPDO" 1 "$(commands_to 5)"
expect_frames "of the set-point" 1 ' 605#2B302001C4090000'

say "the broker restarts"
kill "${started[mosquitto]}"
wait "${started[mosquitto]}" 2>/dev/null
wait_until 20 "the gateway notices" register_is 0 4 0
mark
start_broker
wait_until 30 "connected again" register_is 0 4 1
wait_until 5 "everything retained is there again" is_retained status online
for drive in fan1 pump1 hoist1 mixer1; do
  wait_until 5 "$drive" is_retained "$drive/status" online
done
wait_until 5 "the alarm" field_is fan1/alarm/emcy .active true
expect_no_frames "nothing was sent to a drive" "$nmt|$(commands_to 3579)"
