#!/bin/bash
# docs/recipes/node-red.md as it stands: Node-RED shows values and alarms, sets a frequency and shows the answer, over MQTT
# and with the access rules of the page; and reads registers over Modbus. By recipe_run.
. "$(dirname "$0")/recipe_lib.sh"
broker_host=broker.plant.example
credentials=(-u dashboard -P change-me-2)
hosts broker.plant.example
recipe mosquitto
recipe_do mosquitto Broker
recipe node-red
recipe_do node-red Broker
sed -i 's/^writers = .*/writers = ["mqtt", "modbus"]/' "$site/etc/canopen-gateway/gateway.toml"
short_expiry 6
# What hangs on the expiry: two thirds of it and, here, 2 s. recipe_mosquitto.sh compares the page's own number.
sed -i 's/"duration": "65"/"duration": "6"/' "$site/etc/node-red/drive.json"
recipe_broker mosquitto plant.conf
wait_until 10 "the broker listens" bash -c "echo >/dev/tcp/$broker_host/$broker_port"
recipe_gateway
recipe_drive
wait_until 15 "the drive is online" is_retained pump1/status online

say "Node-RED"
mkdir -p "$work/node-red"
ln -s "$root/build/npm_node_red/node_modules" "$work/node-red/node_modules"
cp "$site/etc/node-red/settings.js" "$work/node-red/settings.js"
# What one imports in the editor, with user and password of the broker given there.
jq -s '.[0] + .[1] | map(if .id == "broker" then .credentials = {user: "nodered", password: "change-me-8"} else . end)' \
  "$site/etc/node-red/drive.json" "$site/etc/node-red/modbus.json" >"$work/flows.json"
begun=$SECONDS
launch node_red node "$root/build/npm_node_red/node_modules/node-red/red.js" --userDir "$work/node-red"
# editor PATH [FILE]: what the editor sends
editor() {
  /usr/bin/python3 - "$@" <<'END'
import sys, urllib.request
body = open(sys.argv[2], "rb").read() if len(sys.argv) > 2 else b"{}"
request = urllib.request.Request("http://127.0.0.1:1880" + sys.argv[1], body, {"Content-Type": "application/json"})
urllib.request.urlopen(request, timeout=30).read()
END
}
wait_until 120 "it has started" grep -q 'Started flows' "$work/node_red.out"
say "it has started after $((SECONDS - begun)) s"
editor /flows "$work/flows.json" || fail "the flows are not taken"
shows() { tail -n +"$((seen + 1))" "$work/node_red.out" | grep -Fq "$1"; }
from_here() { seen=$(wc -l <"$work/node_red.out"); }
seen=0
wait_until 30 "the gateway is there" shows "gateway = online"
wait_until 20 "values" shows "output_frequency = 0"
wait_until 20 "no alarm" shows "alarms = none"
wait_until 20 "a register" shows "register 2 = 0"

say "run at 30 Hz"
from_here
editor /inject/run
wait_until 10 "the answer" shows "answer = done"
wait_until 20 "the value" shows "output_frequency = 30"
wait_until 20 "the register" shows "register 2 = 30"
wait_until 10 "the drive" runs_at 30.00
from_here
editor /inject/slower
wait_until 10 "20 Hz: the answer" shows "answer = done"
wait_until 20 "the value" shows "output_frequency = 20"
from_here
editor /inject/too_fast
wait_until 10 "60 Hz is refused" shows "answer = range: "
from_here
editor /inject/stop
wait_until 10 "stop: the answer" shows "answer = done"
wait_until 20 "the motor comes to rest" shows "output_frequency = 0"

say "an answer that somebody else has sent here"
from_here
as scada change-me-3 mosquitto_pub -V 5 -q 1 -t "$topics/pump1/frequency_command/set" -m '{"value":10,"id":"foreign"}' \
  -D publish response-topic answers/nodered/pump1
wait_until 10 "it is not taken for one's own" shows "answer = to nothing that was sent here"

say "a fault; a drive that is gone"
from_here
order 5 fault 0x0005
wait_until 20 "its alarm" shows "alarms = pump1: "
from_here
order 5 unplug on
wait_until 20 "its values are unknown, not 0" shows "output_frequency = unknown"
wait_until 20 "its registers, too" shows "register 2 = unknown"
from_here
kill -STOP "${started[gateway]}"
wait_until 20 "the gateway says nothing, and nobody says so" shows "gateway = silent"
kill -9 "${started[gateway]}"
wait "${started[gateway]}" 2>/dev/null
wait_until 20 "its will" shows "gateway = offline"
