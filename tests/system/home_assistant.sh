#!/bin/bash
# Home Assistant, as its documentation says what it does (hass/): the discovery messages of the four systems are taken
# whole; each entity shows what the drive says, `unknown` where its value is not fresh, and `unavailable` where drive or
# gateway is not there; what people press and choose there reaches the drives. What is renamed, removed or switched off is
# gone there, and what somebody else told it stays. Run inside tests/vcan/run. home_assistant.sh long: also a gateway that
# stands still until its values expire, a drive that is away, and another prefix.
. "$(dirname "$0")/lib.sh"

long=${1:-}
home() { /usr/bin/python3 "$root/tests/system/home_assistant.py" "$@"; }
seen=$work/witness.out
shown=$work/shown
shows() { sed -n "s/^line3 $1 $2 //p" "$shown"; } # shows DRIVE ENTITY
shows_so() { grep -qxF "line3 $1 $2 $3" "$shown"; }
shows_no() { ! grep -qE "$1" "$shown"; }
answered_more() { [ "$(grep -c " $topics/result " "$seen")" -gt "$1" ]; }
# offered DRIVE|ENTITY|VALUE…: what setting them sends is known then; one start of Python for all of them
offered() { printf 'line3 %s\n' "$@" | home commands "$seen" >"$work/commands" || fail "$* cannot be pressed"; }
# press DRIVE|ENTITY|VALUE: as people do; prints what the gateway answers
press() {
  local topic qos payload answers
  read -r topic qos payload < <(sed -n "s/^line3 $1 //p" "$work/commands")
  answers=$(grep -c " $topics/result " "$seen")
  mosquitto_pub -h 127.0.0.1 -p "$broker_port" -q "$qos" -t "$topic" -m "$payload"
  wait_until 5 "an answer to $1" answered_more "$answers"
  grep " $topics/result " "$seen" | tail -n 1 | cut -d' ' -f4- | jq -r '"\(.ok) \(.code) \(.topic)"'
}
of=homeassistant/device/canopen_line3
told() { grep -c " $of/$1/config {" "$seen"; }
told_more() { [ "$(told "$1")" -gt "$2" ]; }
# As a client that comes now finds them.
devices() { mosquitto_sub -h 127.0.0.1 -p "$broker_port" -t '+/device/#' --retained-only -W 1 -F %t 2>/dev/null | sort; }
devices_are() { [ "$(devices)" = "$(printf '%s\n' "$@" | sort)" ]; }
site() {
  sed -e "/^\[gateway\]/a state_dir = \"$work/state\"\ncontrol = \"$work/control\"" \
    -e '/^\[mqtt\]/a expiry = "6s"' "$@" "$root/tests/system/gateway.toml"
}
end_gateway() {
  kill -TERM "${started[gateway]}"
  wait "${started[gateway]}" 2>/dev/null
}

site -e '/^\[mqtt\]/a home_assistant = "homeassistant"' >"$work/gateway.toml"
start_broker
start_witness
launch home home follow "$seen" "$shown"
lamp=$of/lamp/config
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -r -t $lamp -m "$(jq -nc '{device: {identifiers: ["lamp"], name: "lamp"},
  origin: {name: "x"}, availability: [{topic: "lamp/status"}], availability_mode: "all",
  components: {sensor_l: {platform: "sensor", unique_id: "l", name: "L", value_template: "{{ value }}", expire_after: 9,
                          state_topic: "l"}}}')"
start_gateway
start_four_drives
for drive in fan1 pump1 hoist1 mixer1; do
  wait_until 20 "$drive is there" shows_so "$drive" sensor_nmt operational
done
expect "all of it is taken" "5 devices, 0 faults" "$(home validate "$seen")"

say "commands and readings"
frequency_set="true null canopen/line3/pump1/frequency_command/set"
control_set="true null canopen/line3/pump1/control_command/set"
offered "pump1|number_frequency_command|30" "pump1|select_control_command|forward" "pump1|button_stop|" "mixer1|button_stop|"
expect "a set-point" "$frequency_set" "$(press "pump1|number_frequency_command|30")"
expect "which is never shown as if it were the drive's" unknown "$(shows pump1 number_frequency_command)"
expect "forward" "$control_set" "$(press "pump1|select_control_command|forward")"
wait_until 10 "it turns" shows_so pump1 binary_sensor_running on
wait_until 10 "its frequency" shows_so pump1 sensor_output_frequency 30.0
for entity in sensor_output_current sensor_dc_bus_voltage sensor_module_temperature sensor_motor_speed; do
  expect_match "pump1 $entity" '^-?[0-9.]+$' "$(shows pump1 $entity)"
done
expect "no fault" off "$(shows pump1 binary_sensor_fault)"
order 5 fault 0x0005
wait_until 10 "a fault" shows_so pump1 binary_sensor_fault on
order 5 clear
wait_until 10 "none" shows_so pump1 binary_sensor_fault off
expect "stop" "$control_set" "$(press "pump1|button_stop|")"
wait_until 10 "it stands" shows_so pump1 binary_sensor_running off
expect "and again, which is no repetition" "$control_set" "$(press "pump1|button_stop|")"
expect "a stop without names" "true null canopen/line3/mixer1/control_command/set" "$(press "mixer1|button_stop|")"
expect "of words without names nothing is offered" "" \
  "$(grep -E '^line3 (fan1|hoist1) (select|button|number_control)|^line3 mixer1 (select|number_control)' "$shown")"

say "a drive whose values are not fresh"
order 7 nmt pre-operational
wait_until 10 "not fresh" shows_so hoist1 sensor_output_frequency unknown
wait_until 10 "nor this" shows_so hoist1 binary_sensor_running unknown
expect "but there" pre-operational "$(shows hoist1 sensor_nmt)"
if [ "$long" = long ]; then
  say "a drive that is gone"
  order 9 mute on
  wait_until 10 "gone" shows_so mixer1 sensor_actual_velocity unavailable
  expect "nor can it be commanded" unavailable "$(shows mixer1 button_stop)"
  wait_until 10 "others are there" shows_so pump1 sensor_output_frequency 0.0
  order 9 mute off
  wait_until 20 "there again" shows_so mixer1 binary_sensor_running off
fi

say "somebody else makes the stop of a drive a start"
before=$(told pump1)
grep " $of/pump1/config {" "$seen" | tail -n 1 | cut -d' ' -f4- |
  sed 's/"payload_press":"{[^}]*}"/"payload_press":"{\\"value\\":\\"forward\\"}"/g' >"$work/forged"
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -r -t $of/pump1/config -m "$(cat "$work/forged")"
wait_until 15 "it is put right" told_more pump1 "$((before + 1))"
expect_match "as the log says" "somebody else wrote on $of/pump1/config" \
  "$(cat "$work/gateway.err")"
offered "pump1|button_stop|"
expect "it stops" "$control_set" "$(press "pump1|button_stop|")"
expect "and starts nothing" off "$(shows pump1 binary_sensor_running)"

say "Home Assistant starts"
before=$(told fan1)
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -t homeassistant/status -m online
wait_until 15 "it is told again" told_more fan1 "$before"

if [ "$long" = long ]; then
  say "a gateway that stands still, and says nothing of it"
  kill -STOP "${started[gateway]}"
  wait_until 10 "its values end" shows_so pump1 sensor_output_frequency unavailable
  expect "that it is offline was not said" 0 "$(grep -c " $topics/status offline" "$seen")"
  kill -CONT "${started[gateway]}"
  wait_until 10 "and come again" shows_so pump1 sensor_output_frequency 0.0
fi
end_gateway
wait_until 5 "an orderly end" shows_so pump1 sensor_output_frequency unavailable

say "a drive renamed, one removed, a signal removed"
site -e '/^\[mqtt\]/a home_assistant = "homeassistant"' -e 's/^name = "hoist1"/name = "hoist2"/' \
  -e 's/^\[drive.signals.torque_command\]/[drive.signals.rated_voltage]\nenabled = false\n\n&/' >"$work/all.toml"
mixer1=$(grep -n '^\[\[drive\]\]' "$work/all.toml" | tail -n 1 | cut -d: -f1)
head -n "$((mixer1 - 1))" "$work/all.toml" >"$work/gateway.toml"
expect_match "it was there" '^[a-z0-9.]+$' "$(shows pump1 sensor_rated_voltage)"
start_gateway
wait_until 15 "what is gone shows nowhere" shows_no '^line3 (hoist1|mixer1) |sensor_rated_voltage'
wait_until 15 "devices" devices_are $lamp $of/fan1/config $of/pump1/config $of/hoist2/config
wait_until 10 "values" shows_so pump1 sensor_output_frequency 0.0
expect_match "the log names it" " $of/mixer1/config" "$(grep emptied "$work/gateway.err")"
expect_match "all of it is taken" ", 0 faults" "$(home validate "$seen")"
end_gateway

if [ "$long" = long ]; then
  say "another prefix"
  sed -i 's/^home_assistant = .*/home_assistant = "home"/' "$work/gateway.toml"
  start_gateway
  wait_until 15 "devices" devices_are $lamp home/device/canopen_line3/{fan1,pump1,hoist2}/config
  end_gateway
fi
say "none"
sed -i '/^home_assistant = /d' "$work/gateway.toml"
start_gateway
wait_until 15 "nothing is left to be shown" shows_no '^line3 '
wait_until 15 "no devices" devices_are $lamp
