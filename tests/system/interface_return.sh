#!/bin/bash
# The interface goes and comes back while the drives send: switched off, deleted and made anew with its index, moved to
# another network namespace. Each time that is an alarm, and afterwards the drives are served again within 2 s. Nothing is
# commanded to them, a command given meanwhile neither. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
limit=2000  # ms from the return of the interface until the last drive is online
interface=vcan5
traced=any  # vcan0 is for catch_up
sed "s/\"vcan0\"/\"$interface\"/" "$root/tests/system/gateway.toml" >"$work/gateway.toml"

create() { ip link add $interface index 77 type vcan && ip link set $interface up; }
go_down() { ip link set $interface down; }
come_down() { ip link set $interface up; }
go_deleted() { ip link del $interface; }
come_deleted() { create; }
go_moved() { ip link set $interface netns away; }
come_moved() { ip -n away link set $interface netns $$ && ip link set $interface up; }

# served: ms from $begin until the last drive came online, by the gateway's log
served() {
  local last
  last=$(tail -n +"$((log_before + 1))" "$work/gateway.err" | grep ': online' | tail -n 1 | cut -d ' ' -f 1)
  echo $(($(date -d "$last" +%s%3N) - begin))
}

is_live() { [ $(($(read_register "$1" 1000) & 19)) = 19 ]; }  # online, operational, all values fresh

goes_and_returns() { # goes_and_returns WAY
  say "$1"
  mark
  log_before=$(wc -l <"$work/gateway.err")
  "go_$1" || fail "$1"
  wait_until 5 "alarm on MQTT" field_is bus/can0/alarm .active true
  expect "bus in the diagnostics: down" 4 "$(read_register 0 100)"
  expect "drives online" 0 "$(read_register 0 2)"
  for drive in fan1 pump1 hoist1 mixer1; do
    expect "$drive" offline "$(retained "$drive/status")"
  done
  expect "a command is refused" "Target device failed to respond" "$(write_registers 5 101 1000)"
  begin=$(date +%s%3N)
  "come_$1" || fail "$1: return"
  wait_until 10 "all drives online" register_is 0 2 4
  expect_at_most "ms until all were online" $limit "$(served)"
  say "all online $(served) ms after the return began"
  for node in 3 5 7 9; do wait_until 5 "node $node has fresh values" is_live "$node"; done
  wait_until 5 "alarm over" field_is bus/can0/alarm .active false
  expect "bus in the diagnostics: error-active" 0 "$(read_register 0 100)"
  expect "index" 77 "$(cat /sys/class/net/$interface/ifindex)"
  expect_no_frames "nothing was commanded" "$nmt|$(commands_to 3579)"
}

create || fail "no $interface"
ip netns add away || fail "no network namespace"
start_broker
start_trace
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
start_four_drives
wait_until 10 "all four drives online" register_is 0 2 4
wait_until 10 "connected to the broker" register_is 0 4 1
for way in down deleted moved; do goes_and_returns $way; done
