#!/bin/bash
# The configuration is reloaded while the plant works: what did not change does not notice, not even while a program sends
# bursts of 8 000 frames a second. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
traced='vcan0,7A0~7FF'  # without the bursts: candump takes four system calls a frame

bursts=$(dirname "$gateway_bin")/../tests/system/frame_bursts

# site LINE…: the four drives, each with its own lines by name: fan1, pump1, hoist1, mixer1, and more tables behind
control="$work/control"
write_site() {
  sed -e "/^\[gateway\]/a control = \"$control\"\nstate_dir = \"$work/state\"" -e '/^\[mqtt\]/,/^brokers/d' \
    "$root/tests/system/gateway.toml" >"$work/next.toml"
  cat >>"$work/next.toml" <<END
[http]
listen = "127.0.0.1:9465"
END
}
take_site() { cp "$work/next.toml" "$work/gateway.toml"; }

# reload: SIGHUP, until the log says how it ended
said() { grep -cE "$1" "$work/gateway.err"; }
reload() {
  local before
  before=$(said "$ended")
  kill -HUP "${started[gateway]}"
  wait_until 10 "the reload ends" is_said_more "$before" "$ended"
}
is_longer() { [ "$(wc -c <"$work/$1.out")" -gt "$2" ]; }
is_said_more() { [ "$(said "$2")" -gt "$1" ]; }
ended='reload: (done|nothing was changed|the configuration has errors|drive .* waits)'
api() { curl -s --max-time 5 "http://127.0.0.1:9465/api/$1"; }
of_drive() { api "drives/$1" | jq -r "$2"; }
drive_is() { [ "$(of_drive "$1" "$2")" = "$3" ]; }
set_drive() { "$gateway_bin" set --control "$control" "$@"; }

# A drive that is the same is not lost: unless its simulation, on a machine with too much to do, was silent that long.
expect_not_lost() {
  local gap
  gap=$(longest_gap " $2#")
  say "longest gap between heartbeats of $1: $gap ms"
  [ "$gap" -ge 1400 ] || expect "$1 was not lost" "" "$(tail -n +"$((online + 1))" "$work/gateway.err" | grep -E "$1: offline|$1: alarm .* active")"
}

write_site
# The command line may command, and a command may take long.
sed -i 's/^writers = .*/writers = ["modbus", "local"]\ndeadline = "5s"/' "$work/next.toml"
cp "$work/next.toml" "$work/base.toml"
take_site
start_trace
start_gateway
start_four_drives
wait_until 20 "all four drives online" register_is 0 2 4
wait_until 5 "values" register_is 5 2 0
sleep 2  # alarms of the start are over
online=$(wc -l <"$work/gateway.err")
begun=$(date +%s)
launch client "$root/tests/system/stays_connected.py" 127.0.0.1 "$modbus_port" 7 2
launch live curl -sN "http://127.0.0.1:9465/api/live"
launch watch "$gateway_bin" status --watch --json --control "$control"
launch trace "$gateway_bin" trace hoist1 --control "$control"
sleep 0.5

say "the same again"
mark
reload
expect_no_frames "no NMT command" "$nmt"
expect_no_frames "nothing is written" "$(commands_to 3579)"

say "one with an error changes nothing, and says why"
sed -i 's/^node = 5/node = 300/' "$work/gateway.toml"
reload
expect_match "why" 'gateway.toml:[0-9:]+ error: .*node 300 is out of range' "$(cat "$work/gateway.err")"
expect "four drives" 4 "$(read_register 0 2)"
take_site

say "what needs a restart is refused as a whole"
sed -i -e 's/^name = "line3"/name = "line4"/' -e '/^name = "hoist1"/,$d' "$work/gateway.toml"
sed -i '$d' "$work/gateway.toml"
reload
expect_match "it names the key" 'nothing was changed: another value of name in .gateway. needs a restart' "$(cat "$work/gateway.err")"
expect "still four drives" 4 "$(read_register 0 2)"

say "during bursts: one drive is changed, one removed, one added"
launch bursts "$bursts" vcan0 8000 6
mark
sed -e '/^name = "fan1"/a on_stale = "zero"' -e 's/^name = "mixer1"/name = "blender"/' "$work/base.toml" >"$work/gateway.toml"
reload
expect_match "the log names it" 'reload: drive fan1 is changed' "$(cat "$work/gateway.err")"
expect_match "and what went" 'reload: drive mixer1 is removed' "$(cat "$work/gateway.err")"
expect_match "and what came" 'reload: drive blender is new' "$(cat "$work/gateway.err")"
expect "nothing of those that are the same" 0 "$(said 'reload: drive (pump1|hoist1)')"
wait_until 10 "all four online again" register_is 0 2 4
expect "no such drive any more" 'null' "$(of_drive mixer1 .online)"
cp "$work/base.toml" "$work/gateway.toml"
reload
wait_until 10 "and back" register_is 0 2 4
expect_no_frames "no NMT command to those that are the same" ' 000#..0[57]'
expect_no_frames "no NMT command to all" ' 000#..00'
expect_no_frames "nothing is written to them" "$(commands_to 57)"
wait "${started[bursts]}" || fail "the bursts: $(cat "$work/bursts.err")"
unset 'started[bursts]'
say "bursts: $(cut -d' ' -f1 "$work/bursts.out") frames, $(cut -d' ' -f2 "$work/bursts.out") a second"
rate=$(cut -d' ' -f2 "$work/bursts.out")
[ "${rate%.*}" -ge 7000 ] || say "NOT SHOWN: this machine sends fewer than 7 000 frames a second"
expect "no frame was lost" 0 "$(api gateway | jq .buses[0].frames_lost)"
expect_not_lost pump1 705
expect_not_lost hoist1 707

say "a drive that runs keeps its section until it stands still"
set_drive pump1 frequency_command=30 torque_command=0 control_command=forward >"$work/set.out" || fail "set: $(cat "$work/set.out")"
wait_until 10 "it runs" drive_is pump1 .values.running true
mark
sed '/^name = "pump1"/a on_stale = "zero"' "$work/base.toml" >"$work/gateway.toml"
reload
expect_match "the log says so" 'reload: drive pump1 waits for standstill' "$(cat "$work/gateway.err")"
expect "the API too" "waits for standstill" "$(of_drive pump1 .reload)"
expect_match "and the table" 'pump1: its new configuration waits for standstill' \
  "$("$gateway_bin" status --control "$control")"
sleep 1
expect_no_frames "nothing is written to it" "$(commands_to 3579)"
expect "it runs" true "$(of_drive pump1 .values.running)"
set_drive pump1 control_command=stop >/dev/null
wait_until 20 "it is changed at standstill" is_said_more 0 'reload: drive pump1 is changed'
wait_until 10 "online again" drive_is pump1 .online true
expect "nothing waits" null "$(of_drive pump1 .reload)"

say "a command under way to a drive that changes is answered"
order 3 sdo-delay 3000
set_drive fan1 frequency_command=10 >"$work/set.out" 2>&1 &
pending=$!
sleep 0.2
sed '/^name = "fan1"/a on_stale = "zero"' "$work/gateway.toml" >"$work/next.toml" && take_site
reload
wait $pending
expect "it failed" 1 $?
expect_match "as offline" 'offline' "$(cat "$work/set.out")"
order 3 sdo-delay 0
wait_until 20 "all four" register_is 0 2 4

expect_not_lost hoist1 707
# Where the machine is late, the simulated drives beside it are, too.
expect_at_most "ms between two heartbeats of the gateway" $(($(longest_gap ' 707#') + 1000)) "$(longest_gap ' 77F#')"
expect "its values were always there" 0 "$(grep -c exception "$work/client.out")"

say "the bus changes"
sed -i 's/^interface = "vcan0"/interface = "vcan0"\nsdo_load = 0.6/' "$work/gateway.toml"
reload
expect_match "it is told" 'reload: bus can0 is changed' "$(cat "$work/gateway.err")"
wait_until 20 "all four online again" register_is 0 2 4

say "whoever was connected is"
for name in client live watch trace; do
  kill -0 "${started[$name]}" 2>/dev/null || fail "$name has ended: $(cat "$work/$name.err")"
done
checks=$((checks + 1))
# It asks ten times a second.
asked=$((($(date +%s) - begun) * 5))
[ "$(wc -l <"$work/client.out")" -ge $asked ] || fail "fewer than $asked answers to one client: $(wc -l <"$work/client.out")"
for name in client live watch trace; do
  lines=$(wc -c <"$work/$name.out")
  wait_until 10 "$name goes on" is_longer "$name" "$lines"
done
expect "candump lost nothing" 0 "$(grep -c DROPCOUNT "$work/candump.out")"

say "the end during a reload"
kill -HUP "${started[gateway]}"
kill "${started[gateway]}"
wait "${started[gateway]}"
expect "in order" 0 $?
unset 'started[gateway]'
