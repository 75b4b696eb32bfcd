#!/bin/bash
# check --live: the configuration beside the drives of the running gateway. Drives are changed as somebody at their keypad
# or with another tool would, and each difference has its line. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
socket=$work/control
sed -e "s|^name = \"line3\"|&\ncontrol = \"$socket\"|" -e 's/writers = .*/writers = ["local"]\nraw = true/' \
  -e 's/^profile = "vacon-opte6"/&\nsupervise_gateway = "2s"/' -e '/^\[mqtt\]/,/^$/d' "$root/tests/system/gateway.toml" >"$work/gateway.toml"
touch -d '-1 hour' "$work/gateway.toml"
program=("$gateway_bin" --config "$work/gateway.toml" --profile-dir "$root/config/profiles")

# look: what check --live prints goes to $work/live.out, its exit code to $code
look() {
  "${program[@]}" check --live "$@" >"$work/live.out" 2>&1
  code=$?
}
expect_line() { expect_match "$1" "$2" "$(cat "$work/live.out")"; }
expect_no_line() { expect "$1" "" "$(grep -E -- "$2" "$work/live.out")"; }
all_online() { [ "$("$gateway_bin" status --json --control "$socket" | jq '[.drives[] | select(.online)] | length')" = 4 ]; }

say "nobody runs"
look
expect "exit code" 1 $code
expect_line "it says how to start one" "^canopen-gateway: cannot reach the gateway at $socket: .*systemctl start canopen-gateway"
expect_no_line "and nothing of drives" '^(live|ok):'

say "all is as configured"
start_trace
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
start_four_drives
wait_until 20 "all four drives online" all_online
mark
look
expect "exit code" 0 $code
expect_line "all were compared" '^live: 4 drives compared, [0-9]+ objects as configured, [0-9]+ that a drive does not have$'
expect_line "the last line is that of check" '^ok: 1 bus, 4 drives, [0-9]+ signals$'
expect_no_line "no finding of a drive" '^drive "'
expect_no_frames "it only read" "$nmt|$(commands_to 3579)"
look --control "$socket"
expect "by --control: exit code" 0 $code

say "each difference has its line"
change() { expect "sdo write $*" ok "$("${program[@]}" sdo write "$@" 2>&1)"; }
change fan1 0x2000:03 u16 0
change fan1 0x1017:00 u16 600
change pump1 0x2001:03 u16 1
change pump1 0x2001:0B u16 4000
# What the gateway sets up itself it lets nobody change; another tool on the bus asks nobody.
shows() { [ "$("${program[@]}" sdo read "$1" "$2" "$3" 2>&1)" = "$4" ]; }
tool() { # FRAME DRIVE OBJECT TYPE VALUE: writes it, and waits until the drive shows it
  cansend vcan0 "$1"
  wait_until 10 "$2: $3 is $5" shows "${@:2}"
}
tool 607#2B011805F4010000 hoist1 0x1801:05 u16 500
tool 607#2B0C1000BC020000 hoist1 0x100C:00 u16 700
tool 607#2F0D100003000000 hoist1 0x100D:00 u8 3
tool 609#2316100188137F00 mixer1 0x1016:01 u32 8328072
look
cat "$work/live.out"
expect "exit code" 78 $code
expect_line "where commands come from" \
  '^drive "fan1": warning: 0x2000:03 command source: expected 2, found 0; at the keypad: F00\.02 = 2 \(RS485\)$'
expect_line "a heartbeat that will do" '^drive "fan1": warning: 0x1017:00 heartbeat time: expected 500, found 600, which will do$'
expect_line "where the frequency comes from" \
  '^drive "pump1": warning: 0x2001:03 frequency source: expected 10, found 1; at the keypad: F01\.02 = 10 \(option card\)$'
expect_line "a limit" '^drive "pump1": warning: 0x2001:0B maximum output frequency is 40 Hz, and frequency_command may be .* 50 Hz'
expect_line "a PDO" '^drive "hoist1": error: 0x1801:05 TPDO2 event timer: expected 100, found 500; the gateway writes it when'
expect_line "guarding" '^drive "hoist1": warning: 0x100C guard time 700 ms and 0x100D life time factor 3: no guarding is'
expect_line "supervision" \
  '^drive "mixer1": error: 0x1016 supervision of the gateway \(node 127\): expected 2000 ms, found 5000 ms; the gateway writes it'
expect_no_line "no ok" '^ok:'
expect "and no other" 7 "$(grep -c '^drive "' "$work/live.out")"

say "what the gateway writes is right again once it has configured the drive"
resets() { [ "$("${program[@]}" nmt "$1" reset-communication 2>&1)" = ok ]; }
expect "mixer1" ok "$("${program[@]}" nmt mixer1 reset-communication)"
# Its TPDO2 comes half as often as its values are good for, and without them nobody can tell that the motor stands.
wait_until 10 "hoist1 is seen to stand, and takes the command" resets hoist1
wait_until 20 "both are back" all_online
look_until_right() { look; ! grep -q ': error: ' "$work/live.out"; }
wait_until 20 "no error is left" look_until_right
expect "exit code" 0 $code
expect_line "warnings change nothing about it" '^ok: '

say "a drive whose boot ends with a letter"
order 9 absent 0x1A00
look
expect "what the next boot would say: exit code" 78 $code
expect_line "the object is missing" '^drive "mixer1": error: 0x1A00:00 TPDO1 mapping: the drive does not have it'
order 9 reboot
letter_of_mixer() { "$gateway_bin" status --json --control "$socket" | jq -r '.drives[] | select(.name == "mixer1") | .boot'; }
has_letter() { [ "$(letter_of_mixer)" = J ]; }
wait_until 20 "mixer1 has the letter" has_letter
look
expect "exit code" 78 $code
expect_line "the letter" '^drive "mixer1": error: boot J: 0x1A00:00 TPDO1 mapping: the drive does not have it'
expect_no_line "no ok" '^ok:'
order 9 behave
order 9 reboot
wait_until 20 "all are back" all_online

say "drives that are not there, or do not answer"
order 7 unplug on
order 9 sdo-drop 100000
wait_until 20 "hoist1 is offline" bash -c "'$gateway_bin' status --json --control '$socket' |
  jq -e '.drives[] | select(.name == \"hoist1\") | .online == false'"
look
expect "exit code" 0 $code
expect_line "offline" '^drive "hoist1": warning: is offline, so it was not compared'
expect_line "silent" '^drive "mixer1": warning: does not answer, so the rest of it was not compared: 0x'
expect_line "the others are" '^live: 2 drives compared'

say "a file that is not what the gateway runs"
sed -i -e 's/^node = 3$/node = 33/' "$work/gateway.toml"
look
expect_line "it is newer" 'gateway\.toml: warning: it was changed after the gateway started'
expect_line "and has another node" '^drive "fan1": warning: in the running gateway it is node 3 on bus can0, here node 33'
