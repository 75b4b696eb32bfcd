#!/bin/bash
# docs/recipes/mosquitto.md and mosquitto-tls.md as they stand: the access rules let pass what they say and nothing else,
# the gateway needs no more than they give it; with TLS and client certificates the same, and certificates that are renewed
# on the disk count at the next connection. By recipe_run.
. "$(dirname "$0")/recipe_lib.sh"
broker_host=broker.plant.example
credentials=(-u dashboard -P change-me-2)
hosts broker.plant.example
recipe mosquitto
recipe_do mosquitto Broker
expect "no password is left in plain text" "" "$(grep change-me "$site/etc/mosquitto/passwd")"

say "how much a subscriber is sent at once"
listens() { wait_until 10 "the broker listens" bash -c "echo >/dev/tcp/$broker_host/$broker_port"; }
# sent_at_once COUNT: so many of 1500 retained topics come to one who subscribes then
sent_at_once() {
  listens
  /usr/bin/python3 - "$broker_host" <<'END'
import sys
import paho.mqtt.client
client = paho.mqtt.client.Client()
client.username_pw_set("line3", "change-me-1")
client.max_queued_messages_set(0)
client.connect(sys.argv[1])
client.loop_start()
for number in range(1500):
    last = client.publish(f"canopen/line3/{number}", "x", 1, True)
last.wait_for_publish()
client.disconnect()
END
  as dashboard change-me-2 mosquitto_sub -q 1 -t 'canopen/#' --retained-only -C "$1" -W 60 2>/dev/null | wc -l
}
sed '/max_queued_messages/d' "$site/etc/mosquitto/conf.d/plant.conf" >"$site/etc/mosquitto/conf.d/default.conf"
recipe_broker mosquitto default.conf
expect "without the page's line: 20 on their way and 1000 more" 1020 "$(sent_at_once 1020)"
dropped='Outgoing messages are being dropped'
expect_match "and no more" "$dropped" "$(cat "$work/mosquitto.err")"
ended mosquitto
recipe_broker mosquitto plant.conf
expect "with it" 1500 "$(sent_at_once 1500)"
expect "what is dropped" "" "$(grep "$dropped" "$work/mosquitto.err")"
ended mosquitto

recipe_broker mosquitto plant.conf
listens
recipe_gateway
recipe_drive
wait_until 15 "the drive is online" is_retained pump1/status online
wait_until 15 "the gateway is online" is_retained status online
wait_until 10 "all subscriptions are there" field_is health '.refused_subscriptions | length' 0

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
refused "the gateway elsewhere" as line3 change-me-1 "${publish[@]}" -t "canopen/line4/status" -m offline
expect "what the drive was told" 30 "$(field pump1/state .values.output_frequency)"

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

say "recipes whose programs are not here read what is there"
order 5 fault 0x0005
wait_until 10 "an alarm is listed" field_is alarms '.[0].drive' pump1
as dashboard change-me-2 mosquitto_sub -t 'canopen/#' --retained-only -W 2 -F '%t %p' >"$work/kept" 2>/dev/null
expect "what does not fit" "" "$("$root/tests/system/recipe_topics.py" <"$work/kept" 2>&1)"
order 5 clear
recipe home-assistant # its rules; the gateway that runs does not look at its file again
recipe_do home-assistant Broker
kill -HUP "${started[mosquitto]}"
discovery=homeassistant/device/canopen_line3
granted "a discovery message" as line3 change-me-1 "${publish[@]}" -r -t $discovery/pump1/config -m '{}'
refused "a device of somebody else" as line3 change-me-1 "${publish[@]}" -r -t homeassistant/device/other/x/config -m '{}'
expect "what Home Assistant finds" "$discovery/pump1/config {}" \
  "$(as homeassistant change-me-10 mosquitto_sub -t 'homeassistant/#' -C 1 -W 5 -F '%t %p')"
granted "a birth message" as homeassistant change-me-10 "${publish[@]}" -t homeassistant/status -m online
granted "a command of Home Assistant" as homeassistant change-me-10 "${publish[@]}" -t "$frequency" -m 12
refused "NMT by Home Assistant" as homeassistant change-me-10 "${publish[@]}" -t "$topics/pump1/nmt/set" -m stop

say "readers without a name"
sed -i 's/allow_anonymous false/allow_anonymous true/' "$site/etc/mosquitto/conf.d/plant.conf"
ended mosquitto
recipe_broker mosquitto plant.conf
wait_until 15 "the gateway is back" is_retained status online
anonymous=(mosquitto_sub -h "$broker_host" -W 2 -F %t)
expect "what nobody in particular reads" "$topics/status" "$("${anonymous[@]}" -t 'canopen/#' 2>/dev/null)"
refused "nobody's command" mosquitto_pub -V 5 -h "$broker_host" -q 1 -t "$frequency" -m 10

say "TLS"
recipe mosquitto-tls
recipe_do mosquitto-tls Certificates
sed -i 's/allow_anonymous true/allow_anonymous false/' "$site/etc/mosquitto/conf.d/plant.conf"
ended gateway
ended mosquitto
recipe_broker mosquitto plant.conf plant-tls.conf
recipe_gateway
wait_until 15 "the gateway is online by TLS" is_retained status online
expect "the broker that it names" broker.plant.example:8883 "$(field health .broker)"
tls() {
  mosquitto_pub -V 5 -h "$broker_host" -p 8883 --cafile "$work/certificates/ca.crt" -q 1 -t canopen/line4/status -m x "$@"
}
expect_match "no client certificate" 'error|Error' "$(tls 2>&1)"
refused "another tree than its name's" tls --cert "$work/certificates/line3.crt" --key "$work/certificates/line3.key"

say "the gateway's certificate is renewed, first by a stranger"
gateway_etc=$site/etc/canopen-gateway
connected() { grep -c 'MQTT: connected' "$work/gateway.err"; }
again() { [ "$(connected)" -gt "$connections" ]; }
reconnect() {
  connections=$(connected)
  ended mosquitto
  recipe_broker mosquitto plant.conf plant-tls.conf
}
install_client() { # install_client AUTHORITY
  "$root/scripts/test-ca" "$work/$1" client line3
  install -m 600 "$work/$1/line3.key" "$gateway_etc/line3.key"
  install -m 644 "$work/$1/line3.crt" "$gateway_etc/line3.crt"
}
install_server() {
  "$root/scripts/test-ca" "$work/$1" server broker.plant.example
  install -m 644 "$work/$1/broker.plant.example.crt" "$site/etc/mosquitto/certs/broker.crt"
  install -m 600 -o mosquitto "$work/$1/broker.plant.example.key" "$site/etc/mosquitto/certs/broker.key"
}
install_client stranger
expect "nothing happens while the connection stands" online "$(retained status)"
reconnect
wait_until 20 "the log says so" grep -q 'refuses the client certificate' "$work/gateway.err"
expect "connections without the right one" "$connections" "$(connected)"
install_client certificates
wait_until 20 "connected again" is_retained status online

say "the broker's certificate is renewed"
serial() {
  openssl s_client -connect "$broker_host:8883" -servername "$broker_host" -CAfile "$work/certificates/ca.crt" </dev/null \
    2>/dev/null | openssl x509 -noout -serial
}
connections=$(connected)
before=$(serial)
install_server certificates
kill -HUP "${started[mosquitto]}" # systemctl reload
changed() { [ -n "$(serial)" ] && [ "$(serial)" != "$before" ]; }
wait_until 10 "new connections see it" changed
expect "the connection stands meanwhile" "$connections" "$(connected)"
expect "the drive" online "$(retained pump1/status)"

say "the gateway's connection is ended at a time of one's own, as the page does"
launch watch mosquitto_sub "${credentials[@]}" -h "$broker_host" -t "$topics/status" -F %p -W 60
sleep 0.5
breaks() { grep -c 'the connection broke' "$work/gateway.err"; }
broken=$(breaks)
eval "$(recipe_commands mosquitto-tls "A certificate is renewed" | sed 's/ dst .*//')" >/dev/null 2>&1
sleep 1
if [ "$(breaks)" -gt "$broken" ]; then
  wait_until 10 "it is back" again
  expect "what others saw" online "$(uniq "$work/watch.out")"
else
  say "this kernel does not end connections of others (ss -K)"
fi

say "the authority is renewed: at both sides the old and the new one, then the certificates"
cat "$work/certificates/ca.crt" "$work/stranger/ca.crt" >"$work/both.crt"
install -m 644 "$work/both.crt" "$gateway_etc/plant-ca.crt"
install -m 644 "$work/both.crt" "$site/etc/mosquitto/certs/plant-ca.crt"
reconnect
wait_until 15 "with the old certificates" again
install_client stranger
install_server stranger
reconnect
wait_until 15 "with the new ones" again
expect "nothing secret in the log" "" "$(grep -E 'change-me|PRIVATE' "$work/gateway.err")"
