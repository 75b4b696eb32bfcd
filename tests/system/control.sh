#!/bin/bash
# The command line through the control socket of the running gateway: what it commands, what it is refused, and what
# becomes of the socket when a gateway dies. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
socket=$work/control
# pump1 takes commands of the command line, the others do not.
sed -e "s|^name = \"line3\"|&\ncontrol = \"$socket\"|" -e '/name = "pump1"/,/writers/s/"mqtt"]/"mqtt", "local"]/' \
  "$root/tests/system/gateway.toml" >"$work/gateway.toml"

# ask_gateway COMMAND…: its output, and a last line with the exit code
ask_gateway() {
  "$gateway_bin" --config "$work/gateway.toml" --profile-dir "$root/config/profiles" "$@" 2>&1
  echo "exit $?"
}
status_of() { # DRIVE JQ-EXPRESSION
  "$gateway_bin" status --json --control "$socket" | jq -r ".drives[] | select(.name == \"$1\") | $2"
}
status_is() { [ "$(status_of "$1" "$2")" = "$3" ]; }
all_online() { [ "$("$gateway_bin" status --json --control "$socket" | jq '[.drives[] | select(.online)] | length')" = 4 ]; }

say "nobody listens"
answer=$(ask_gateway status)
expect_match "it says what to do" "cannot reach the gateway at $socket: No such file or directory; does the gateway run" \
  "$answer"
expect "exit code" "exit 1" "${answer##*$'\n'}"

say "start"
start_broker
start_trace
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
start_four_drives
wait_until 10 "all four drives online" all_online
expect "mode of the socket" 660 "$(stat -c %a "$socket")"
# A margin is known once two heartbeats of a drive were compared.
has_margin() { ask_gateway status | grep -q 'heartbeat margin'; }
wait_until 10 "the bus shows its heartbeat margin" has_margin
table=$(ask_gateway status)
expect_match "the table names the gateway" '^gateway line3 ' "$table"
expect_match "and the bus" '^bus can0  error-active  load [0-9.]+ %  heartbeat margin [0-9]+ % \([a-z0-9]+\)$' "$table"
expect_match "and each drive" '^pump1 +can0 +5 +operational +ok +[0-9.]+ s +yes +no' "$table"

say "every program of this machine may send on CAN, as the security guide says"
mark
setpriv --reuid 65534 --regid 65534 --clear-groups cansend vcan0 7F1#0105 || fail "nobody may not send"
expect_frames "what nobody sent" 1 ' 7F1#0105'

say "set runs a drive"
mark
expect "answer" "ok
exit 0" "$(ask_gateway set pump1 frequency_command=6.0 torque_command=0 control_command=forward)"
expect_frames "it left as one RPDO" 1 ' 205#010058020000'
wait_until 10 "pump1 runs up" register_is 5 2 600
expect "status shows it" true "$(status_of pump1 .values.running)"
expect "with the decimals of its scale" 6.00 \
  "$("$gateway_bin" status --json --control "$socket" | grep -o '"output_frequency":6[.0-9]*' | head -n 1 | cut -d: -f2)"

say "refusals change nothing"
mark
refused() { # WHAT PATTERN COMMAND…
  local what=$1 pattern=$2 told
  shift 2
  told=$(ask_gateway "$@")
  expect_match "$what" "$pattern" "$told"
  expect "$what: exit code" "exit 1" "${told##*$'\n'}"
}
refused "no writer" '^canopen-gateway: forbidden: ' set hoist1 frequency_command=10
refused "no writer, whatever it says" '^canopen-gateway: forbidden: ' set hoist1 no_such_signal=10
refused "no writer of NMT" '^canopen-gateway: forbidden: ' nmt hoist1 stop
refused "no writer of objects" '^canopen-gateway: forbidden: ' sdo write hoist1 0x2103:00 u16 5
refused "out of range" '^canopen-gateway: range: ' set pump1 frequency_command=50.01
refused "no number" '^canopen-gateway: type: ' set pump1 frequency_command=fast
refused "no such drive" 'unknown: no drive "pump9"' set pump9 frequency_command=1
refused "not while it runs" '^canopen-gateway: forbidden: ' nmt pump1 stop
refused "without raw" '^canopen-gateway: forbidden: ' sdo write pump1 0xBF00:00 u16 5
expect_no_frames "no command to any drive" "$nmt|$(commands_to 3579)"
for words in "set pump1" "set pump1 frequency_command" "nmt pump1" "sdo" "sdo write pump1 0x2002:03" "status --xml"; do
  # shellcheck disable=SC2086 # they are words
  expect "wrong usage: $words" "exit 2" "$(ask_gateway $words | tail -n 1)"
done

say "objects"
expect "of a signal, its type known" "600
exit 0" "$(ask_gateway sdo read pump1 0x2021:02)"
expect "of no signal" "exit 0" "$(ask_gateway sdo read hoist1 0x1018:01 u32 | tail -n 1)"
refused "its type not known" 'type: "type" is missing' sdo read hoist1 0x1018:01
refused "no such object" 'refused: .*0x0602' sdo read hoist1 0x5FFF:01 u8
expect "a write of a signal's object" "ok
exit 0" "$(ask_gateway sdo write pump1 "$("$gateway_bin" map --format json --config "$work/gateway.toml" \
  --profile-dir "$root/config/profiles" 2>/dev/null | jq -r '.drives[1].signals[] | select(.name == "frequency_command") | .object')" 0x12C)"
wait_until 10 "pump1 slows down" register_is 5 2 300

say "stop and NMT"
expect "one stop for all who take it" "ok
exit 0" "$(ask_gateway stop)"
wait_until 10 "pump1 stands" status_is pump1 .values.running false
expect "now it may leave operational" "ok
exit 0" "$(ask_gateway nmt pump1 pre-operational)"
wait_until 5 "it has" status_is pump1 .nmt pre-operational
expect "and come back" "exit 0" "$(ask_gateway nmt pump1 start | tail -n 1)"
wait_until 10 "it is back" status_is pump1 .nmt operational

say "a gateway that stands still, and a second one that leaves it its socket"
kill -STOP "${started[gateway]}"
ask_gateway set pump1 frequency_command=10 >"$work/patience.out" &
asking=$!
sed -e '/^\[modbus\]/,/^$/d' -e '/^\[mqtt\]/,/^$/d' -e 's/"vcan0"/"virtual"/' "$work/gateway.toml" |
  sed -e 's/writers = .*/writers = ["local"]/' -e 's/line3/line4/' >"$work/second.toml"
launch second "$gateway_bin" run --config "$work/second.toml" --profile-dir "$root/config/profiles"
wait_until 10 "it says so" grep -q 'control socket .*: another process listens there' "$work/second.err"
wait_until 10 "everything else goes on" grep -q ' serves ' "$work/second.err"
wait "$asking"
kill -CONT "${started[gateway]}"
answer=$(cat "$work/patience.out")
expect_match "the client gives up" 'has not answered within [0-9]+ s; what became of the request is unknown' "$answer"
expect "exit code" "exit 1" "${answer##*$'\n'}"
wait_until 10 "all four drives online again" all_online
expect "the first answers" line3 "$("$gateway_bin" status --json --control "$socket" | jq -r .gateway)"
say "and takes over where the first is dead"
kill -9 "${started[gateway]}"
wait_until 10 "the second answers" bash -c "'$gateway_bin' status --json --control '$socket' | grep -q '\"gateway\":\"line4\"'"
kill -9 "${started[second]}"
wait "${started[second]}" 2>/dev/null
expect "a dead socket is left" "srw" "$(stat -c %A "$socket" | cut -c1-3)"
refused "nobody behind it" 'Connection refused; does the gateway run' status
start_gateway
wait_until 15 "it is replaced" all_online
kill "${started[gateway]}"
wait "${started[gateway]}"
expect "an orderly end" 0 "$?"
expect "removes it" gone "$([ -e "$socket" ] || echo gone)"
