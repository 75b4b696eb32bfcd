#!/bin/bash
# simulate refuses node ids that are on the bus already, and joins no bus unheard. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
simulate() { "$gateway_bin" --profile-dir "$root/config/profiles" simulate "$@" </dev/null >"$work/second.out" 2>"$work/second.err"; }
simulated() { grep -q ' simulated' "$work/$1.out"; }

say "a quiet bus"
start_trace
mark
start_drives --drive veichi-ac310:5 --drive vacon-opte6:9
expect_match "it says that it listens" '^Listening on vcan0 for 2 s' "$(head -n 1 "$work/simulate.out")"
expect_frames "both have booted" 2 ' 70[59]#00'

say "the same node ids again"
send_each() { # FRAME…: again and again
  while true; do
    for frame; do cansend vcan0 "$frame"; done
    sleep 0.2
  done
}
send_each 705#7F 289#0102 083#0010010000000000 "58B#4300100000000000" &
started[frames]=$!
mark
simulate --interface vcan0 --drive veichi-ac300:3 --drive veichi-ac310:5 --drive invt-goodrive600:7 \
  --drive vacon-opte6:9 --drive cia402-velocity:11
expect "exit code" 1 $?
expect_match "by its heartbeat" '^canopen-gateway: vcan0: node 5 is there already: its heartbeat \(0x705\) was heard' \
  "$(cat "$work/second.err")"
expect_match "by a TPDO" 'node 9 is there already: its TPDO2 \(0x289\) was heard' "$(cat "$work/second.err")"
expect_match "by an emergency" 'node 3 is there already: an emergency \(0x083\) was heard' "$(cat "$work/second.err")"
expect_match "by an SDO answer" 'node 11 is there already: an SDO answer \(0x58B\) was heard' "$(cat "$work/second.err")"
expect "no other" 4 "$(grep -c 'is there already' "$work/second.err")"
expect_no_frames "it sent nothing" ' 707#'

say "others beside them"
launch third "$gateway_bin" simulate --interface vcan0 --drive veichi-ac310:21
wait_until 10 "node 21 is simulated" simulated third

say "drives of a configuration, whose gateway asks for them already"
kill "${started[third]}" "${started[frames]}" "${started[simulate]}"
wait "${started[third]}" "${started[frames]}" "${started[simulate]}" 2>/dev/null
sed -e '/^\[mqtt\]/,/^$/d' "$root/tests/system/gateway.toml" >"$work/gateway.toml"
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
launch site "$gateway_bin" --profile-dir "$root/config/profiles" simulate --config "$work/gateway.toml"
wait_until 10 "all of them are simulated" grep -q '^4 drives simulated' "$work/site.out"
for drive in fan1 pump1 hoist1 mixer1; do
  wait_until 20 "$drive is online" grep -q "$drive: online" "$work/gateway.err"
done
simulate --config "$work/gateway.toml"
expect "the same again: exit code" 1 $?
expect "each is refused" 4 "$(grep -c 'is there already' "$work/second.err")"

say "an interface that is not there yet"
ip link set vcan0 down
launch late "$gateway_bin" simulate --interface vcan0 --drive veichi-ac310:22
sleep 3
expect "it waits" "" "$(grep simulated "$work/late.out")"
ip link set vcan0 up
wait_until 10 "and joins once it has listened" simulated late
kill -INT "${started[late]}"
wait "${started[late]}"
expect "it ends in order" 0 $?
