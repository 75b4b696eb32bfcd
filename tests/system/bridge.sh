#!/bin/bash
# The gateway's machine is switched off behind a bridge: its own broker goes with it, and nobody tells the far one, which
# keeps what was retained. A client that subscribes there when `expiry` is over finds no `online` and no live value. That
# is so because a bridge of MQTT 5 passes on what is left of the expiry, which is shown before. Run inside tests/vcan/run;
# takes 2.5 min, by ctest -C long. bridge.sh [EXPIRY]: in seconds, at least 30.
. "$(dirname "$0")/lib.sh"
expiry=${1:-90}
far_port=1884
sed "/^\[mqtt\]/a expiry = \"${expiry}s\"" "$root/tests/system/gateway.toml" >"$work/gateway.toml"

start_far() {
  launch far mosquitto -c "$work/far.conf"
  wait_until 10 "the far broker listens" bash -c "echo >/dev/tcp/127.0.0.1/$far_port"
}
printf 'listener %s 127.0.0.1\nallow_anonymous true\n' "$far_port" >"$work/far.conf"
start_far
printf '%s\n' "listener $broker_listener" "allow_anonymous true" "connection far" "address 127.0.0.1:$far_port" \
  "bridge_protocol_version mqttv50" "notifications false" "restart_timeout 1" \
  "topic canopen/# out 1" >"$work/mosquitto.conf"
launch_broker

# What a client that subscribes at a broker now finds: SECONDS-LEFT TOPIC PAYLOAD, 0 where it stays.
at() {
  mosquitto_sub -V 5 -h 127.0.0.1 -p "$1" -t 'canopen/#' --retained-only -W 2 -F '%E %t %p' 2>/dev/null | sed 's/^ /0 /'
}
# All that says there that the gateway or a drive lives: statuses, health, states, values.
live_at() {
  at "$1" | grep -E '^[0-9]+ canopen/line3/(status|health|[a-z0-9]+/(status|state|[a-z_]+)) ' |
    grep -Ev '/control |/status offline$'
}
lists() { # lists TOPIC…: each is live there
  local found topic
  found=$(live_at "$far_port" | cut -d' ' -f2)
  for topic; do
    grep -qx "$topics/$topic" <<<"$found" || return 1
  done
}
far_is_whole() {
  lists status health {fan1,pump1,hoist1,mixer1}/{status,state} {fan1,pump1,hoist1}/output_frequency mixer1/actual_velocity
}

start_gateway
start_four_drives
wait_until 10 "all four drives online" register_is 0 2 4
order 3 fault 0x0006
wait_until 10 "an alarm stands" field_is fan1/alarm/emcy .active true
wait_until 10 "the far broker has it all" far_is_whole

say "what is left of the expiry goes over the bridge"
mosquitto_pub -V 5 -h 127.0.0.1 -p "$broker_port" -r -t canopen/probe -m probe -D publish message-expiry-interval 60
probe_left() { at "$far_port" | sed -n 's|^\([0-9]*\) canopen/probe probe$|\1|p'; }
probe_came() { [ -n "$(probe_left)" ]; }
wait_until 5 "a message of our own comes" probe_came
kill -9 "${started[far]}"
wait "${started[far]}" 2>/dev/null
sleep 12
start_far
wait_until 20 "the bridge brings it all again" far_is_whole
live_at "$far_port" | sort -k2,2 >"$work/far.live"
live_at "$broker_port" | sort -k2,2 >"$work/near.live"
# TOPIC FAR NEAR; a topic that is refreshed in between has more left at the near broker, which was asked last.
join -1 2 -2 2 -o 0,1.1,2.1 "$work/far.live" "$work/near.live" >"$work/left"
say "seconds left at the far and at the near broker:" "$(awk '{printf "%s %s, ", $2, $3}' "$work/left")"
expect "every one has its expiry, and none has more at the far broker" "" \
  "$(awk '!$2 || $2 > $3 + 4' "$work/left")"
expect_at_most "seconds left of the 60 of our own" $((60 - 12)) "$(probe_left)"

say "the gateway's machine is switched off"
off=$SECONDS
kill -9 "${started[gateway]}" "${started[mosquitto]}"
wait "${started[gateway]}" "${started[mosquitto]}" 2>/dev/null
sleep 5
far_is_whole || fail "the far broker knows it at once"
sleep $((expiry + (expiry + 8) / 9 - (SECONDS - off)))
expect "what is live after $((SECONDS - off)) s" "" "$(live_at "$far_port")"
kept=$(at "$far_port")
expect "what says so" "" "$(grep -E 'status online|"online":true|"fresh":true' <<<"$kept")"
expect_match "the far broker still answers" "^0 $topics/fan1/alarm/emcy .*\"active\":true" "$kept"
