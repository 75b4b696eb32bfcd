#!/bin/bash
# What may happen to a broker: it is killed and comes back without its store, it freezes while TCP stands and its port
# says nothing to new connections, it refuses the password. 10 s after the cure every retained topic is true, and no
# command of the past was carried out. Run inside tests/vcan/run. broker.sh [SECONDS]: how long it freezes.
. "$(dirname "$0")/lib.sh"
freeze=${1:-26}
sed -e "/^\[gateway\]/a state_dir = \"$work/state\"" \
  -e "/^\[mqtt\]/a username = \"gateway\"\npassword_file = \"$work/password\"" \
  "$root/tests/system/gateway.toml" >"$work/gateway.toml"
printf 'right\n' >"$work/password"
chmod 600 "$work/password"

# The retained topics of the gateway.
tree() {
  mosquitto_sub "${credentials[@]}" -h 127.0.0.1 -p "$broker_port" -t "$topics/#" --retained-only -W 1 -F '%t' | sort
}
# What the topics say is what the plant is.
all_true() {
  local drive
  is_retained status online && field_is health .drives_online 4 || return 1
  for drive in fan1 pump1 hoist1 mixer1; do
    is_retained "$drive/status" online && field_is "$drive/state" .fresh true || return 1
  done
  field_is fan1/alarm/emcy '[.active, .id] | @json' "[true,\"$alarm\"]" && [ "$(tree)" = "$all" ]
}

start_broker
start_trace
start_gateway
start_four_drives
wait_until 10 "all four drives online" register_is 0 2 4
wait_until 10 "connected to the broker" register_is 0 4 1
order 3 fault 0x0006
wait_until 5 "an alarm stands" field_is fan1/alarm/emcy .active true
alarm=$(field fan1/alarm/emcy .id)
wait_until 5 "health" field_is health .drives_online 4
all=$(tree)
wait_until 10 "everything is true" all_true
expect_match "the list of topics" "$topics/pump1/output_frequency" "$all"

say "the broker is killed and comes back without its store, with a command of the past in it"
kill -9 "${started[mosquitto]}"
wait "${started[mosquitto]}" 2>/dev/null
wait_until 5 "the gateway notices" register_is 0 4 0
mark
start_broker
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -r -t "$topics/pump1/frequency_command/set" -m 12.5
wait_until 10 "everything is true" all_true
checks=$((checks + 1))
expect_no_frames "nothing was sent to a drive" "$nmt|$(commands_to 3579)"

say "the broker freezes for $freeze s; TCP stands, and its port says nothing"
mark
kill -STOP "${started[mosquitto]}"
sleep "$freeze"
expect "the gateway has noticed" 0 "$(read_register 0 4)"
kill -CONT "${started[mosquitto]}"
wait_until 10 "everything is true" all_true
checks=$((checks + 1))
expect_no_frames "nothing was sent to a drive" "$nmt|$(commands_to 3579)"

say "the broker refuses the password"
kill "${started[mosquitto]}"
wait "${started[mosquitto]}" 2>/dev/null
mosquitto_passwd -c -b "$work/users" gateway right
mosquitto_passwd -b "$work/users" witness right
chmod 644 "$work/users"
printf 'wrong\n' >"$work/password"
kill -TERM "${started[gateway]}"
wait "${started[gateway]}" 2>/dev/null
printf 'user root\nlistener %s 127.0.0.1\nallow_anonymous false\npassword_file %s\n' "$broker_port" "$work/users" \
  >"$work/mosquitto.conf"
launch mosquitto mosquitto -c "$work/mosquitto.conf"
wait_until 10 "the broker listens" bash -c "echo >/dev/tcp/127.0.0.1/$broker_port"
start_gateway
wait_until 10 "the log says so" grep -iq 'password\|authori' "$work/gateway.err"
printf 'right\n' >"$work/password"
kill -TERM "${started[gateway]}"
wait "${started[gateway]}" 2>/dev/null
start_gateway
credentials=(-u witness -P right)
wait_until 10 "everything is true" all_true
checks=$((checks + 1))
