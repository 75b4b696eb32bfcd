#!/bin/bash
# The HTTP server of the program, asked by curl: metrics read by promtool and by Prometheus' Python library, health
# beside what the broker has, the API, who is refused, and many readers that do not read. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
promtool=$root/build/promtool/usr/bin/promtool
port=9464
sed -e "s|^name = \"line3\"|&\nstate_dir = \"$work/state\"|" "$root/tests/system/gateway.toml" >"$work/gateway.toml"
cat >>"$work/gateway.toml" <<TOML
[http]
listen = "127.0.0.1:$port"
hosts = ["line3.plant.example"]
TOML

page() { curl -sS --max-time 10 "$@"; }                                     # page URL…: the text
get() { page "http://127.0.0.1:$port$1"; }                                 # get TARGET
status_of() { page -o /dev/null -w '%{http_code}' "$@"; }                  # status_of CURL-ARGUMENTS…
metric() { get /metrics | "$root/tests/system/http/read_metrics.py" | sed -n "s/^canopen_gateway_$1 //p"; }  # metric SERIES
metric_is() { [ "$(metric "$1")" = "$2" ]; }
all_online() { [ "$(get /health | jq .drives_online)" = 4 ]; }

say "start"
start_broker
start_witness
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
expect "without a drive it is not well" 503 "$(status_of "http://127.0.0.1:$port/health")"
start_four_drives
wait_until 10 "all four drives online" all_online
wait_until 10 "MQTT is connected" metric_is 'mqtt_connected{}' 1

say "health"
expect "it is well" 200 "$(status_of "http://127.0.0.1:$port/health")"
stable='del(.ts, .uptime, .memory, .journal, .buses[].load)'
same_health() { [ "$(get /health | jq -S "$stable")" = "$(retained health | jq -S "$stable")" ]; }
wait_until 10 "it is what the broker has" same_health

say "metrics"
get /metrics | "$promtool" check metrics >"$work/promtool" 2>&1 || fail "promtool: $(cat "$work/promtool")"
expect "promtool has nothing to say" "" "$(cat "$work/promtool")"
expect "a drive" 1 "$(metric 'drive_online{drive="pump1"}')"
expect "its boot" 1 "$(metric 'drive_boot_result{drive="pump1",result="ok"}')"
expect "the bus" 1 "$(metric 'bus_state{bus="can0",state="active"}')"
expect_match "its load" '^0\.[0-9]+$' "$(metric 'bus_load_ratio{bus="can0"}')"
expect_match "messages" '^[1-9]' "$(metric 'mqtt_messages_published_total{}')"
before=$(metric 'modbus_requests_total{}')
read_register 5 0 >/dev/null
read_register 77 0 >/dev/null
expect "Modbus requests" $((before + 2)) "$(metric 'modbus_requests_total{}')"
expect "and their exceptions" 1 "$(metric 'modbus_exceptions_total{code="0x0A"}')"
expect "a command" written "$(write_registers 5 101 600)"
expect "is counted" 1 "$(metric 'commands_total{drive="pump1",outcome="ok",writer="modbus"}')"
expect "and timed" 1 "$(metric 'command_confirmation_seconds_count{drive="pump1",writer="modbus"}')"
expect_match "another one" failed\|Illegal "$(write_registers 5 101 60000)"
expect "is counted by its outcome" 1 "$(metric 'commands_total{drive="pump1",outcome="range",writer="modbus"}')"

say "the API"
expect "drives" fan1,pump1,hoist1,mixer1 "$(get /api/drives | jq -r 'map(.name) | join(",")')"
expect "one drive" 5 "$(get /api/drives/pump1 | jq .node)"
expect "what there is in place of another" fan1,pump1,hoist1,mixer1 \
  "$(get /api/drives/pump9 | jq -r '.drives | join(",")')"
expect "the map" "$("$gateway_bin" --config "$work/gateway.toml" --profile-dir "$root/config/profiles" map --format json)" \
  "$(get /api/map)"
journal_has() { [ "$(get /api/commands | jq -r '.[-1].outcome')" = range ]; }
wait_until 5 "the newest commands" journal_has
expect "as they stand in the journal" "$(tail -n 1 "$work"/state/journal/*.jsonl)" \
  "$(get '/api/commands?count=1' | sed 's/^\[//; s/\]$//')"
expect "no alarm" '[]' "$(get /api/alarms)"
order 5 fault 5
alarm_is_there() { [ "$(get /api/alarms | jq -r '.[0].drive')" = pump1 ]; }
wait_until 5 "an alarm" alarm_is_there
same_alarms() { [ "$(get /api/alarms)" = "$(retained alarms)" ]; }
wait_until 5 "as the broker has it" same_alarms
expect "is counted" 1 "$(metric 'alarms_active{kind="emcy",severity="fault"}')"

say "who is refused"
at=http://127.0.0.1:$port
for method in POST PUT DELETE OPTIONS; do
  expect "$method" 405 "$(status_of -X $method -d 'control_command=1' $at/api/drives/pump1)"
done
expect "a page that was made to look like ours" 421 "$(status_of -H 'Host: attacker.example' $at/api/drives)"
expect "a name from the configuration" 200 "$(status_of -H 'Host: line3.plant.example:9464' $at/health)"
expect "half a percent sign" 400 "$(status_of "$at/api/commands?count=%4")"
expect "HEAD" 200 "$(status_of -I $at/metrics)"
expect_match "nothing runs in a browser" "Content-Security-Policy: default-src 'none'" "$(page -I $at/health)"

say "readers that do not read"
launch slow "$root/tests/system/http/slow_readers.py" $port 200 /api/live
wait_until 20 "200 of them" grep -q connected "$work/slow.out"
lost_before=$(metric 'bus_frames_lost_total{bus="can0"}')
expect_match "they are connected" '^(19|20)[0-9]$' "$(metric 'http_clients{}')"
for _ in $(seq 20); do expect_match "registers are read" '^[0-9]+$' "$(read_register 5 0)"; done
expect "all drives are online" 4 "$(get /health | jq .drives_online)"
expect "no frame was lost" "$lost_before" "$(metric 'bus_frames_lost_total{bus="can0"}')"
expect_at_most "the memory is bounded" 100000000 "$(get /metrics | "$root/tests/system/http/read_metrics.py" |
  sed -n 's/^process_resident_memory_bytes{} //p')"
kill "${started[slow]}"

say "a bus that is down"
ip link set vcan0 down
is_down() { [ "$(status_of $at/health)" = 503 ]; }
wait_until 5 "is not well" is_down
expect "and named" down "$(get /health | jq -r '.buses[0].state')"
expect "in the metrics too" 0 "$(metric 'bus_up{bus="can0"}')"
