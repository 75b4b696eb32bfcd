#!/bin/bash
# docs/recipes/mosquitto-pair.md as it stands: the first broker dies, everything is at the second within 10 s, and true
# there although the second kept something else. By recipe_run.
. "$(dirname "$0")/recipe_lib.sh"
credentials=(-u dashboard -P change-me-2)
hosts_of_pair() {
  {
    cat /etc/hosts
    printf '127.0.0.1 broker-a.plant.example\n127.0.0.2 broker-b.plant.example\n'
  } >"$work/hosts"
  mount --bind "$work/hosts" /etc/hosts || fail "no names for the brokers"
}
hosts_of_pair
recipe mosquitto
recipe_do mosquitto Broker
recipe mosquitto-pair
# Two machines in one: each has its address.
for each in a b; do
  address=127.0.0.$([ $each = a ] && echo 1 || echo 2)
  sed "s/^listener 1883/listener 1883 $address/" "$site/etc/mosquitto/conf.d/plant.conf" >"$site/etc/mosquitto/conf.d/$each.conf"
  recipe_broker $each $each.conf
  wait_until 10 "broker $each listens" bash -c "echo >/dev/tcp/broker-$each.plant.example/$broker_port"
done
broker_host=broker-b.plant.example
as line3 change-me-1 mosquitto_pub -r -q 1 -t "$topics/pump1/alarm/emcy" -m '{"active":true,"text":"of long ago"}'

recipe_gateway
recipe_drive
broker_host=broker-a.plant.example
wait_until 15 "the drive is online at the first" is_retained pump1/status online
wait_until 10 "so is the gateway" is_retained status online
order 5 fault 0x0006
wait_until 10 "its alarm is there" field_is pump1/alarm/emcy .active true
order 5 clear
wait_until 10 "and over" field_is pump1/alarm/emcy .active false

say "the first broker dies"
killed=$(date +%s%3N)
kill -9 "${started[a]}"
wait "${started[a]}" 2>/dev/null
broker_host=broker-b.plant.example
wait_until 15 "the gateway is online at the second" is_retained status online
expect_at_most "milliseconds until then" 10000 $(($(date +%s%3N) - killed))
expect "the drive there" online "$(retained pump1/status)"
expect "the alarm of long ago" false "$(field pump1/alarm/emcy .active)"
expect_match "a command there" '"ok":true' "$(as scada change-me-3 mosquitto_rr -V 5 -W 5 -t "$topics/pump1/set" \
  -e answers/scada/1 -m '{"frequency_command":20.0,"torque_command":0.0,"control_command":"forward"}')"
