#!/bin/bash
# The gateway stands still beside 20 drives with 600 TPDOs a second: nobody is taken for lost afterwards, nothing is sent
# to a drive, and values are live again. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
drives=20
{
  printf '[gateway]\nname = "line3"\n[[bus]]\nname = "can0"\ninterface = "vcan0"\n[modbus]\nlisten = ["127.0.0.1:%s"]\n' \
    "$modbus_port"
  for node in $(seq "$drives"); do
    printf '[[drive]]\nname = "fan%s"\nbus = "can0"\nnode = %s\nprofile = "veichi-ac310"\n' "$node" "$node"
  done
} >"$work/gateway.toml"

start_trace
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
# shellcheck disable=SC2046
start_drives $(seq -f '--drive veichi-ac310:%g' "$drives")
wait_until 30 "all online" register_is 0 2 "$drives"
sleep 2

# losses: drives that were said to be offline after they had all come online
log_before=$(wc -l <"$work/gateway.err")
losses() { tail -n +"$((log_before + 1))" "$work/gateway.err" | grep -Ec 'offline|alarm'; }

for time in 1.45 5; do
  say "the gateway stands still for $time s"
  mark
  kill -STOP "${started[gateway]}"
  sleep "$time"
  kill -CONT "${started[gateway]}"
  sleep 3
  expect "nobody is lost, no alarm" 0 "$(losses)"
  expect "all online" "$drives" "$(read_register 0 2)"
  expect_match "values are live" '^-?[0-9]+$' "$(read_register 7 2)"
  expect_no_frames "no command" "$nmt| [2-5][01][0-9A-F]#| 6[01][0-9A-F]#[0-3CD]"
done

say "a drive that falls silent meanwhile is found"
kill -STOP "${started[gateway]}"
order 7 mute on
sleep 5
kill -CONT "${started[gateway]}"
wait_until 3 "it is lost" register_is 0 2 "$((drives - 1))"
expect "it alone" 1 "$(tail -n +"$((log_before + 1))" "$work/gateway.err" | grep -c offline)"
