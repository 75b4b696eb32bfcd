#!/bin/bash
# What the gateway tells of the health of a bus, at a serial CAN adapter (slcan) that says what a controller would: a clean
# bus has figures and no suspicion; missing termination, a missing acknowledgement, a doubled node id, an overload and a
# wrong bit rate have the sentence that fits. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/adapter_lib.sh"
port=9464
socket=$work/control

bus() { curl -sS --max-time 10 "http://127.0.0.1:$port/api/buses" | jq -r ".[0] | $1"; }
bus_has() { [ "$(bus "$1")" = "$2" ]; }
suspected() { wait_until "$2" "$1 is suspected" bus_has '.suspicion.kind // "none"' "$1"; }
metric() { curl -sS --max-time 10 "http://127.0.0.1:$port/metrics" | sed -n "s/^canopen_gateway_$1 //p"; }
gateway_says() { "$gateway_bin" status --control "$socket" "$@"; }
errors() { # errors COUNT LINE: as often the adapter says so
  local i
  for ((i = 0; i < $1; i++)); do adapter say "$2"; done
}
restart_gateway() {
  kill "${started[gateway]}"
  wait "${started[gateway]}"
  start_gateway
  wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
}
told_once() { # told_once PATTERN: in the log
  expect "lines with '$1'" 1 "$(grep -c -- "$1" "$work/gateway.err")"
}

plug
sed -e "s/\"vcan0\"/\"$can\"/" -e "s|^name = \"line3\"|&\ncontrol = \"$socket\"|" "$root/tests/system/gateway.toml" |
  awk '/^\[\[drive\]\]/ {drives++} drives == 0 || drives == 2
    /name = "pump1"/ {print "heartbeat_timeout = \"15s\""}' >"$work/gateway.toml"  # A busy machine is no bad bus.
printf '[http]\nlisten = "127.0.0.1:%s"\n' "$port" >>"$work/gateway.toml"
start_broker
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
start_drives --drive veichi-ac310:5
wait_until 10 "pump1 online" is_retained pump1/status online

say "a clean bus"
wait_until 10 "heartbeats are timed" bus_has '.nodes[0].margin.least > 0.2' true
sleep 5
expect "no suspicion" null "$(bus .suspicion)"
expect "nor in the log" 0 "$(grep -c suspicion "$work/gateway.err")"
expect "the drive" "5 pump1" "$(bus '.nodes[0] | "\(.node) \(.drive)"')"
expect "SDO answers" true "$(bus '.nodes[0].sdo | .count > 0 and .p50 > 0 and .p50 <= .p99')"
expect "its heartbeat" true "$(bus '.cob_ids[] | select(.cob_id == "0x705") | .p50 > 0.1 and .p50 < 1 and .worst >= .p50 * 0.9')"
expect "its TPDO" true "$(bus '[.cob_ids[].cob_id] | index("0x185") != null')"
expect "a burst" true "$(bus '.burst.frames >= 1')"
expect "load" true "$(bus '.load.most > 0 and .load.most < 0.9')"
expect "errors" "0 0 0" "$(bus '"\(.transmit_errors.most) \(.receive_errors.most) \(.error_frames.most)"')"
expect_match "margin" '^0\.[2-9]' "$(metric 'drive_heartbeat_margin_ratio{drive="pump1"}')"
expect_match "an SDO answer" '^[0-9.e-]+$' "$(metric 'drive_sdo_answer_seconds{drive="pump1",percentile="99"}')"
expect "no series says otherwise" 0 "$(metric 'bus_suspicion{bus="can0",kind="wiring"}')"
expect_match "status" '^bus can0 .* heartbeat margin [0-9]+ % \(pump1\)$' "$(gateway_says)"
expect_match "status --buses" '^  suspicion: none$' "$(gateway_says --buses)"
expect_match "has the drive" '^  5 +pump1 +[0-9.]+ ms +[0-9.]+ ms +[0-9]+ % +[0-9.]+ ms +[0-9.]+ ms +[0-9]+$' \
  "$(gateway_says --buses)"
expect_match "and the COB-IDs" '^  0x185 +[0-9.]+ ms' "$(gateway_says --buses)"

say "missing termination: errors beside frames, and counters that come and go"
errors 4 e1s
adapter say sw100003
errors 4 e1b
adapter say sa000000
errors 4 e2cf
suspected wiring 10
expect_match "the sentence" \
  '^wiring or termination may be bad: 12 errors in the last minute \(.*4 stuff.*\); .* frames received.* Look first at the two terminators' \
  "$(bus .suspicion.text)"
told_once 'can0: suspicion: wiring or termination may be bad'
expect "as a series" 1 "$(metric 'bus_suspicion{bus="can0",kind="wiring"}')"
expect_match "status" '^bus can0  suspicion: wiring or termination may be bad' "$(gateway_says)"
expect "counters of the day" 100 "$(bus .receive_errors.most)"

say "two nodes with one id"
for ((i = 0; i < 40; i++)); do
  cansend vcan0 705#7F
  sleep 0.1
done &
suspected doubled_id 20
wait $!
expect_match "the sentence" '^a node id may be there twice(, seen until [0-9]+ s ago)?: node 5: .*Look first at drives that were exchanged' \
  "$(bus .suspicion.text)"
told_once 'can0: suspicion: a node id may be there twice'
told_once 'can0: suspicion: a node id may be there twice: .* (before: wiring or termination may be bad)'
expect "what was displaced is not said to be gone" 0 "$(grep -c 'no longer suspected' "$work/gateway.err")"

say "nobody acknowledges"
restart_gateway
wait_until 20 "pump1 online" is_retained pump1/status online
adapter hold
for ((i = 0; i < 6; i++)); do
  adapter say e1a
  adapter say sp000128
  sleep 1
done
suspected alone 10
expect_match "the sentence" \
  '^the gateway may be alone on the bus: nobody acknowledges .* is error-passive \(128 transmit, 0 receive errors\)\. Look first at whether the drives have power' \
  "$(bus .suspicion.text)"
told_once 'can0: suspicion: the gateway may be alone on the bus'
adapter say sa000000
adapter on

say "another bit rate than everybody else's"
adapter off
restart_gateway
for ((i = 0; i < 6; i++)); do
  adapter say e2fs
  adapter say sp135000
  sleep 0.5
done
suspected bit_rate 10
expect_match "the sentence" \
  '^the bit rate may be wrong: no frame was received since the gateway opened the interface; .* \(.*6 form.*\)\. Look first at the bit rate, here 125000 bit/s' \
  "$(bus .suspicion.text)"
told_once 'can0: suspicion: the bit rate may be wrong'
adapter say sa000000
adapter on

say "more frames than the bus has room for, which at 20 kbit/s are some 170 a second"
ip link set "$can" down
ip link set "$can" type can bitrate 20000 || fail "bit rate of $can"
ip link set "$can" up
restart_gateway
wait_until 20 "pump1 online" is_retained pump1/status online
launch flood cangen vcan0 -g 2 -I 28A -L 8 -D 0102030405060708
suspected overload 20
expect_match "the sentence" '^the bus may be overloaded: load (9[0-9]|100) %; .*Look first at inhibit times' \
  "$(bus .suspicion.text)"
expect_match "who sends most" 'COB-ID is 0x28A' "$(bus .suspicion.text)"
told_once 'can0: suspicion: the bus may be overloaded'
