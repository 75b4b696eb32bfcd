#!/bin/bash
# docs/recipes/mosquitto.md and mosquitto-tls.md as they stand: the access rules let pass what they say and nothing else,
# the gateway needs no more than they give it, and nobody takes its client id; with TLS and client certificates the same.
# The times that pages name are those that the gateway gives its messages. By recipe_run.
. "$(dirname "$0")/recipe_lib.sh"
broker_host=broker.plant.example
credentials=(-u dashboard -P change-me-2)
hosts broker.plant.example
recipe mosquitto
recipe_do mosquitto Broker
expect "no password is left in plain text" "" "$(grep change-me "$site/etc/mosquitto/passwd")"

recipe_broker mosquitto plant.conf
listens
# watch_status: hears who is there at the moment when it is said; told_expiry: how many seconds the newest `online` lives
watch_status() {
  launch told stdbuf -oL mosquitto_sub -d -V 5 -h "$broker_host" -u service -P change-me-4 -t "$topics/status" -F '%E %p' -W 60
  wait_until 5 "somebody watches" grep -q '^Subscribed' "$work/told.out"
}
told_expiry() { sed -n 's/ online$//p' "$work/told.out" | tail -n 1; }
watch_status
recipe_gateway
recipe_drive
wait_until 15 "the drive is online" is_retained pump1/status online
wait_until 15 "the gateway is online" is_retained status online
wait_until 10 "all subscriptions are there" field_is health '.refused_subscriptions | length' 0
expiry=$(told_expiry)
ended told

say "the command of the page"
answer=$(bash -euc "$(recipe_commands mosquitto "A command, and who may not")")
expect "its answer" '{"ok":true,"topic":"canopen/line3/pump1/set","id":"a1"}' "$answer"
wait_until 10 "the motor runs at 30 Hz" field_is pump1/state .values.output_frequency 30

say "who may not"
publish=(mosquitto_pub -V 5 -q 1)
frequency=$topics/pump1/frequency_command/set
refused "a dashboard that commands" as dashboard change-me-2 "${publish[@]}" -t "$frequency" -m 10
refused "a dashboard that stops" as dashboard change-me-2 "${publish[@]}" -t "$topics/stop" -m 1
refused "a dashboard that forges a value" as dashboard change-me-2 "${publish[@]}" -t "$topics/pump1/state" -m '{}'
refused "NMT by the one who commands" as scada change-me-3 "${publish[@]}" -t "$topics/pump1/nmt/set" -m stop
refused "raw objects by the one who commands" as scada change-me-3 "${publish[@]}" -t "$topics/pump1/sdo/request" -m '{}'
refused "an alarm that he forges" as scada change-me-3 "${publish[@]}" -r -t "$topics/pump1/alarm/emcy" -m '{}'
refused "a wrong password" as scada change-me-2 "${publish[@]}" -t "$frequency" -m 10
refused "nobody's command" mosquitto_pub -V 5 -h "$broker_host" -q 1 -t "$frequency" -m 10
refused "a device of Home Assistant, forged" as scada change-me-3 "${publish[@]}" -r -t homeassistant/device/canopen_line3/pump1/config -m '{}'
expect "what the drive was told" 30 "$(field pump1/state .values.output_frequency)"

say "who takes the gateway's client id"
# By the broker's log: the gateway tells of a break a moment later.
thrown_out() { grep -c 'line3 already connected, closing old connection' "$work/mosquitto.err"; }
for id in line3 canopen-gateway-line3; do
  expect "a dashboard that calls itself $id" online "$(as dashboard change-me-2 mosquitto_sub -V 5 -i $id -t "$topics/status" -C 1 -W 5)"
done
expect "how often the gateway was thrown out" 0 "$(thrown_out)"
refused "somebody without a name" mosquitto_sub -V 5 -h "$broker_host" -i x -t "$topics/status" -C 1 -W 5

say "who may"
answer=$(as service change-me-4 mosquitto_rr -V 5 -W 5 -t "$topics/pump1/sdo/request" -e answers/service/1 \
  -m '{"id":"7","op":"read","object":"0x2021:02","type":"u16"}')
expect "the service engineer reads an object" '{"id":"7","ok":true,"value":3000}' "$answer"
launch results mosquitto_sub "${credentials[@]}" -h "$broker_host" -t "$topics/result" -C 1 -W 20
sleep 0.5
as scada change-me-3 "${publish[@]}" -t "$frequency" -m 10 -D publish response-topic "elsewhere/1"
wait "${started[results]}"
expect_match "an answer outside of answers/#" '"code":"forbidden"' "$(cat "$work/results.out")"
expect_match "stop" '"ok":true' "$(as scada change-me-3 mosquitto_rr -V 5 -W 5 -t "$topics/stop" -e answers/scada/2 -m 1)"

say "what listens, and where the password is not"
gateway_process=$(ss -Htnp state established "dport = :$broker_port" | sed -n 's/.*"[a-z_-]*",pid=\([0-9]*\),.*/\1/p')
expect_match "the gateway" '^[0-9]+$' "$gateway_process"
expect "what it listens on" "" "$(ss -Hltunp | grep "pid=$gateway_process,")"
as dashboard change-me-2 mosquitto_sub -t 'canopen/#' --retained-only -W 2 >"$work/kept" 2>/dev/null
expect "where the password is" "" \
  "$(grep -l change-me-1 "$work/kept" "$work/gateway.err" "/proc/$gateway_process/cmdline" "/proc/$gateway_process/environ")"

say "recipes whose programs are not here read what is there"
order 5 fault 0x0005
wait_until 10 "an alarm is listed" field_is alarms '.[0].drive' pump1
as dashboard change-me-2 mosquitto_sub -t 'canopen/#' --retained-only -W 2 -F '%t %p' >"$work/kept" 2>/dev/null
expect "what does not fit" "" "$("$root/tests/system/recipe_topics.py" topics <"$work/kept" 2>&1)"
order 5 clear
recipe telegraf
recipe_do telegraf "Broker and gateway"
recipe home-assistant # its rules; the gateway that runs does not look at its file again
recipe_do home-assistant Broker
kill -HUP "${started[mosquitto]}"
discovery=homeassistant/device/canopen_line3
granted "a discovery message" as line3 change-me-1 "${publish[@]}" -r -t $discovery/pump1/config -m '{}'
refused "a device of somebody else" as line3 change-me-1 "${publish[@]}" -r -t homeassistant/device/other/x/config -m '{}'
expect "what Home Assistant finds" "$discovery/pump1/config {}" \
  "$(as homeassistant change-me-10 mosquitto_sub -t 'homeassistant/#' -C 1 -W 5 -F '%t %p')"
expect "what Telegraf hears" "$topics/pump1/state" \
  "$(as telegraf-values change-me-11 mosquitto_sub -t 'canopen/+/+/state' -C 1 -W 5 -F %t)"
granted "a birth message" as homeassistant change-me-10 "${publish[@]}" -t homeassistant/status -m online
granted "a command of Home Assistant" as homeassistant change-me-10 "${publish[@]}" -t "$frequency" -m 12
refused "NMT by Home Assistant" as homeassistant change-me-10 "${publish[@]}" -t "$topics/pump1/nmt/set" -m stop

say "TLS, with an expiry that nobody has set"
recipe mosquitto-tls
recipe_do mosquitto-tls Certificates
"$root/scripts/test-ca" "$work/certificates" client dashboard
# Somebody listens in on the way to the broker, and for comparison where nothing is encrypted.
listen_in() { # listen_in PORT TO
  launch "listens$1" "$root/tests/system/listen_in.py" "$1" "$2" "$work/heard$1"
  wait_until 15 "somebody listens in" grep -q listens "$work/listens$1.out"
}
# heard PORT OPTIONS…: what tshark reads of it
heard() {
  local port=$1
  shift
  text2pcap -q -D -T "50000,$port" "$work/heard$port" "$work/heard$port.pcap" 2>/dev/null
  tshark -r "$work/heard$port.pcap" -d "tcp.port==$port,$([ "$port" = 8884 ] && echo tls || echo mqtt)" "$@" 2>/dev/null
}
listen_in 8884 8883
listen_in 1884 1883
sed -i -e '/^expiry/d' -e 's/:8883/:8884/' "$site/etc/canopen-gateway/gateway.toml"
ended gateway
ended mosquitto
recipe_broker mosquitto plant.conf plant-tls.conf
listens
watch_status
recipe_gateway
wait_until 15 "the gateway is online by TLS" is_retained status online
expect "the broker that it names" broker.plant.example:8884 "$(field health .broker)"
expect "the name that the broker is asked for (SNI)" broker.plant.example \
  "$(heard 8884 -Y tls.handshake.extensions_server_name -T fields -e tls.handshake.extensions_server_name | sort -u)"
expect_match "records of TLS that carry messages" '^[0-9]{2,}$' "$(heard 8884 -Y tls.app_data | wc -l)"
expect "who listens in reads of topics" 0 "$(heard 8884 -Y "frame contains \"$topics\"" | wc -l)"
as service change-me-4 mosquitto_sub -p 1884 -t "$topics/status" -C 1 -W 5 >/dev/null
expect_match "and without TLS" '^[1-9]' "$(heard 1884 -Y "frame contains \"$topics\"" | wc -l)"
expect "what does not fit the times of the pages" "" \
  "$("$root/tests/system/recipe_topics.py" times "$expiry" "$(told_expiry)" 2>&1)"
tls() {
  mosquitto_pub -V 5 -h "$broker_host" -p 8883 --cafile "$work/certificates/ca.crt" -q 1 -t canopen/line4/status -m x "$@"
}
mine=(--cert "$work/certificates/dashboard.crt" --key "$work/certificates/dashboard.key")
for id in line3 canopen-gateway-line3; do
  refused "what the name of a certificate may not" tls "${mine[@]}" -i $id
done
expect "how often that threw the gateway out" 0 "$(thrown_out)"
tls >/dev/null 2>&1 && fail "somebody without a certificate may write"
wait_until 5 "the broker says why" grep -q 'peer did not return a certificate' "$work/mosquitto.err"
