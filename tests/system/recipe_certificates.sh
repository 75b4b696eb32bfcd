#!/bin/bash
# The slow half of docs/recipes/mosquitto.md and mosquitto-tls.md: how much a subscriber is sent at once, and certificates
# that are renewed on the disk and count at the next connection, are withdrawn, or whose authority is renewed. By recipe_run,
# in ctest -C long.
. "$(dirname "$0")/recipe_lib.sh"
broker_host=broker.plant.example
credentials=(-u dashboard -P change-me-2)
hosts broker.plant.example
recipe mosquitto
recipe_do mosquitto Broker

say "how much a subscriber is sent at once"
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

recipe mosquitto-tls
recipe_do mosquitto-tls Certificates
recipe_broker mosquitto plant.conf plant-tls.conf
listens
recipe_gateway
recipe_drive
wait_until 15 "the drive is online" is_retained pump1/status online
wait_until 15 "the gateway is online by TLS" is_retained status online

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

say "its certificate is withdrawn"
refusals() { grep -c 'refuses the client certificate' "$work/gateway.err"; }
before=$(refusals)
cp "$work/certificates/line3.crt" "$work/stolen.crt"
cp "$work/certificates/line3.key" "$work/stolen.key"
recipe_do mosquitto-tls "A certificate is withdrawn"
further /etc/mosquitto/conf.d/plant-tls.conf
reconnect
refused_again() { [ "$(refusals)" -gt "$before" ]; }
wait_until 20 "the log says so" refused_again
expect "connections with it" "$connections" "$(connected)"
install_client certificates
wait_until 20 "connected with a new one of the same name" again
expect_match "what the gateway said of the old one" 'certificate revoked' "$(cat "$work/gateway.err")"
strangers() { grep -c 'certificate verify failed' "$work/mosquitto.err"; }
before=$(strangers)
mosquitto_pub -V 5 -h "$broker_host" -p 8883 --cafile "$work/certificates/ca.crt" -q 1 -t "$topics/probe" -m x \
  --cert "$work/stolen.crt" --key "$work/stolen.key" >/dev/null 2>&1 && fail "who has the old one may write"
not_let_in() { [ "$(strangers)" -gt "$before" ]; }
wait_until 5 "the broker did not let it in" not_let_in
sed -i '/^crlfile/d' "$site/etc/mosquitto/conf.d/plant-tls.conf" # what follows has another authority, with no list
reconnect
wait_until 20 "connected without the list" again

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
launch watch mosquitto_sub -u service -P change-me-4 -h "$broker_host" -t "$topics/status" -F %p -W 60
sleep 0.5
connections=$(connected)
ended_by=$(eval "$(recipe_commands mosquitto-tls "A certificate is renewed" | sed 's/ dst .*//')" 2>&1)
# Where the kernel knows no `ss -K`, it shows no connection and ends none, and the page says what to do instead.
if [ "$(wc -l <<<"$ended_by")" -gt 1 ]; then # more than the heading
  wait_until 10 "the connection has ended" grep -q 'Client line3 \(disconnected\|closed\)' "$work/mosquitto.err"
  wait_until 10 "it is back" again
  expect "what others saw" online "$(uniq "$work/watch.out")"
else
  say "this kernel does not end connections of others (ss -K): the broker is restarted"
  reconnect
  wait_until 15 "it is back" again
fi
ended watch

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
