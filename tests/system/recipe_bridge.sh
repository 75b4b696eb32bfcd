#!/bin/bash
# docs/recipes/mosquitto-bridge.md as it stands: everything is at the far broker, with its expiry; nothing comes back, but
# what the page lets in; a link that was down leaves no old value and no late command. With an expiry of 12 s in place of
# 90 s. Run inside tests/vcan/run.
. "$(dirname "$0")/recipe_lib.sh"
broker_host=broker.plant.example
credentials=(-u dashboard -P change-me-2)
hosts broker.plant.example cloud.example
recipe mosquitto
recipe_do mosquitto Broker
recipe mosquitto-bridge
recipe_do mosquitto-bridge Elsewhere
sed -i '/^\[mqtt\]/a expiry = "12s"' "$site/etc/canopen-gateway/gateway.toml"
mkdir -p "$site/etc/mosquitto/certs"
"$root/scripts/test-ca" "$work/cloud" server cloud.example
install -m 644 "$work/cloud/ca.crt" "$site/etc/mosquitto/certs/cloud-ca.crt"
install -m 644 "$work/cloud/cloud.example.crt" "$site/etc/mosquitto/certs/cloud.crt"
install -m 600 -o mosquitto "$work/cloud/cloud.example.key" "$site/etc/mosquitto/certs/cloud.key"
sed -i 's/^restart_timeout .*/restart_timeout 1/' "$site/etc/mosquitto/conf.d/bridge.conf" # for less waiting

# far USER PASSWORD COMMAND…: a client at the far broker
far() {
  local user=$1 password=$2 command=$3
  shift 3
  "$command" -V 5 -h cloud.example -p 8883 --cafile "$work/cloud/ca.crt" -u "$user" -P "$password" "$@"
}
# SECONDS-LEFT TOPIC PAYLOAD of what is kept there; 0 where it stays
kept_far() {
  far viewer change-me-6 mosquitto_sub -t 'canopen/#' -t 'links/#' --retained-only -W 2 -F '%E %t %p' 2>/dev/null |
    sed 's/^ /0 /'
}
far_has() { kept_far | grep -Eq "$1"; }
far_is_whole() {
  kept_far >"$work/far.kept"
  grep -Eq "^[1-9][0-9]* $topics/status online$" "$work/far.kept" &&
    grep -Eq "^[1-9][0-9]* $topics/pump1/status online$" "$work/far.kept" &&
    grep -Eq "^[1-9][0-9]* $topics/pump1/state .*\"online\":true" "$work/far.kept" &&
    grep -Eq "^0 $topics/pump1/alarm/emcy .*\"active\":true" "$work/far.kept" &&
    grep -Eq "^0 links/line3 1$" "$work/far.kept"
}

recipe_broker far cloud.conf
wait_until 10 "the far broker listens" bash -c "echo >/dev/tcp/cloud.example/8883"
recipe_broker mosquitto plant.conf bridge.conf
wait_until 10 "the broker listens" bash -c "echo >/dev/tcp/$broker_host/$broker_port"
recipe_gateway
recipe_drive
wait_until 15 "the drive is online" is_retained pump1/status online
order 5 fault 0x0005
wait_until 20 "the far broker has it all, live topics with their expiry" far_is_whole

say "nothing comes back"
refused "a viewer's command" far viewer change-me-6 mosquitto_pub -q 1 -t "$topics/pump1/set" -m '{}'
launch heard mosquitto_sub "${credentials[@]}" -h "$broker_host" -t "$topics/+/set" -t "$topics/probe" -F '%t %p' -W 60
far line3-bridge change-me-5 mosquitto_pub -q 1 -t "$topics/pump1/set" -m '{"frequency_command":5.0}'
sleep 1
as line3 change-me-1 mosquitto_pub -q 1 -t "$topics/probe" -m 1
wait_until 5 "the plant is heard" grep -q probe "$work/heard.out"
expect "commands that came over the bridge" "" "$(grep /set "$work/heard.out")"

say "the plant is cut off: broker and gateway are gone"
kill -9 "${started[gateway]}" "${started[mosquitto]}"
wait "${started[gateway]}" "${started[mosquitto]}" 2>/dev/null
wait_until 10 "the far broker knows of the link" far_has '^0 links/line3 0$'
gone() { ! far_has 'status online$|"online":true|"fresh":true'; }
wait_until 20 "nothing there is said to live" gone
kept_far >"$work/far.kept"
expect_match "the alarm stays" "^0 $topics/pump1/alarm/emcy " "$(cat "$work/far.kept")"

say "commands from elsewhere, by the lines of the page"
further /etc/mosquitto/conf.d/bridge.conf
further /etc/mosquitto/cloud-acl
(cd "$work" && bash -euc "$(recipe_commands mosquitto-bridge "Commands from elsewhere")") || fail "the password"
kill -HUP "${started[far]}"
order 5 clear
recipe_broker mosquitto plant.conf bridge.conf
recipe_gateway
back() { far_has "^[1-9][0-9]* $topics/status online$" && far_has "^0 $topics/pump1/alarm/emcy .*\"active\":false"; }
wait_until 30 "the far broker has it all again" back
command='{"frequency_command":20.0,"torque_command":0.0,"control_command":"forward","id":"'
expect_match "a command from there is answered there" '"ok":true.*"id":"c1"' \
  "$(far remote change-me-9 mosquitto_rr -W 10 -q 1 -t "$topics/pump1/set" -e answers/cloud/1 -m "${command}c1\"}")"
refused "NMT from there" far remote change-me-9 mosquitto_pub -q 1 -t "$topics/pump1/nmt/set" -m stop

say "the link is down while somebody there commands"
ended mosquitto
far remote change-me-9 mosquitto_pub -q 1 -t "$topics/pump1/set" -m "${command}late\"}"
recipe_broker mosquitto plant.conf bridge.conf
launch heard mosquitto_sub "${credentials[@]}" -h "$broker_host" -t "$topics/+/set" -F '%t %p' -W 60
wait_until 30 "the link is back" far_has '^0 links/line3 1$'
wait_until 15 "so is the gateway" is_retained status online
expect_match "the next one passes" '"ok":true.*"id":"c2"' \
  "$(far remote change-me-9 mosquitto_rr -W 10 -q 1 -t "$topics/pump1/set" -e answers/cloud/1 -m "${command}c2\"}")"
expect "what came late" "" "$(grep late "$work/heard.out")"
expect_match "what came" c2 "$(cat "$work/heard.out")"
