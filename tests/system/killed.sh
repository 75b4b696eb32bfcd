#!/bin/bash
# killed.sh [ROUNDS [SEED]]: the gateway is killed at random moments while commands come over MQTT and Modbus and alarms come
# and go. Each time its journal verifies and it goes on; of every start of a motor on the bus the journal has a line from
# before; and an alarm that was told a second before goes on with its id, count and beginning.
# Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
rounds=${1:-20}
seed=${2:-$RANDOM}
RANDOM=$seed
say "$rounds rounds, seed $seed"
# pump1 and hoist1 are the drives that are commanded, fan1 is the one that trips; a fourth would only take the guest's time.
sed "/^\[gateway\]/a state_dir = \"$work/state\"" "$root/tests/system/gateway.toml" |
  awk 'BEGIN {RS = "\\[\\[drive\\]\\]\n"} NR == 1 {printf "%s", $0} /^name = "(fan1|pump1|hoist1)"/ {printf "[[drive]]\n%s", $0}' \
    >"$work/gateway.toml"
journal=$work/state/journal

verify() { "$gateway_bin" journal verify --config "$work/gateway.toml" --profile-dir "$root/config/profiles" "$@"; }

# The commanders start no process for each command: that takes longer than all that the gateway does of it, and the guest
# has one processor. pause SECONDS: nobody ever writes there.
mkfifo "$work/nothing"
exec 6<>"$work/nothing"
pause() { read -rt "$1" -u 6 _; }

# Runs and stops in turn, each with a frequency of its own by which its frame is known. The word is the drive's run or stop.
set_points() {
  local raw=0
  while :; do
    raw=$((raw % 4998 + 1))
    printf '{"frequency_command":%d.%02d,"torque_command":0.0,"control_command":%d}\n' \
      $((raw / 100)) $((raw % 100)) $((raw % 2 ? 1 : 5))
    pause 0.03
  done
}
# Register 100 of hoist1, function 6. Answers hold zeros, which `read` leaves out, so it takes what is there and goes on
# when its time is over; it ends early where the gateway has gone.
run_and_stop() {
  local word=1
  trap '' PIPE
  while :; do
    if { exec 8<>"/dev/tcp/127.0.0.1/$modbus_port"; } 2>/dev/null; then
      while printf '\0\1\0\0\0\6\7\6\0\144\0\'"$word" >&8; do
        word=$((word == 1 ? 5 : 1))
        read -rt 0.05 -N 64 -u 8 _
        [ $? -gt 128 ] || break
      done 2>/dev/null
      exec 8>&-
    fi
    pause 0.05
  done
}

start_broker
start_trace
start_drives --drive veichi-ac300:3 --drive veichi-ac310:5 --drive invt-goodrive600:7
start_gateway
wait_until 10 "all drives online" register_is 0 2 3
expect "hoist1: its frequency" written "$(write_registers 7 101 3000)"
mkfifo "$work/set_points"
set_points >"$work/set_points" &
started[set_points]=$!
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -t "$topics/pump1/set" -l <"$work/set_points" &
started[publish]=$!
run_and_stop &
started[run_and_stop]=$!

# What fan1's alarm is known by. Its topic is emptied with each kill, so what stands there is this gateway's word, and what
# it did not hear since its start it has from its memory.
identity() { field fan1/alarm/emcy '[.active, .id, .count, .since] | map(tostring) | join(" ")'; }
now_ms() { echo "${EPOCHREALTIME/[.,]/}" | cut -c1-13; }
faulty=no
known=
kept=0
check_alarm() {  # check_alarm ROUND
  local found
  wait_until 10 "round $1: the alarm is told" field_is fan1/alarm/emcy .confirmed true
  found=$(identity)
  if [ $((killed_at - known_since)) -ge 1000 ]; then
    expect "round $1: fan1's alarm after $((killed_at - known_since)) ms" "$known" "$found"
    kept=$((kept + 1))
  elif [ "$found" != "$known" ]; then
    known=$found
    known_since=$(now_ms)
  fi
}
turn_fault() {
  if [ $faulty = no ]; then order 3 fault 0x0006; faulty=true; else order 3 clear; faulty=no; fi
  wait_until 5 "the alarm follows the drive" field_is fan1/alarm/emcy .active "${faulty/no/false}"
  known=$(identity)
  known_since=$(now_ms)
}

lines=0
for round in $(seq "$rounds"); do
  [ "$round" = 1 ] || start_gateway
  wait_until 10 "the drives are back" register_is 0 2 3
  [ "$round" = 1 ] || check_alarm "$round"
  [ $((round % 4)) != 1 ] || turn_fault
  pause "0.$((RANDOM % 5))$((RANDOM % 10))$((RANDOM % 10))"
  kill -9 "${started[gateway]}"
  killed_at=$(now_ms)
  wait "${started[gateway]}" 2>/dev/null
  mosquitto_pub -h 127.0.0.1 -p "$broker_port" -r -n -t "$topics/fan1/alarm/emcy"
  verify >"$work/verify.out" 2>"$work/verify.err"
  expect "round $round: the journal is whole, $(cat "$work/verify.out" "$work/verify.err"): exit code" 0 $?
  now=$(sed -n 's/^ok: \([0-9]*\) lines.*/\1/p' "$work/verify.out")
  expect_at_most "round $round: it grew from $lines lines to" 1000000 "$((now - lines))"
  lines=$now
done
kill "${started[run_and_stop]}" "${started[set_points]}"
catch_up

# frequencies of the frames in which pump1 was started: RPDO1 is word, frequency, torque, low byte first
sed -n 's/.* 205#0100\(..\)\(..\)0000.*/\2\1/p' "$work/candump.out" | while read -r raw; do echo $((16#$raw)); done |
  sort -u >"$work/started"
jq -r 'select(.phase == "begun" and .drive == "pump1") | [.fields[] | {(.signal): .asked}] | add |
  select(.control_command == 1) | .frequency_command * 100 | round' "$journal"/*.jsonl | sort -u >"$work/begun"
expect_at_most "starts of pump1 on the bus" 1000000 "$(wc -l <"$work/started")"
expect "starts of pump1 without their line" "" "$(comm -23 "$work/started" "$work/begun" | tr '\n' ' ')"
say "$(wc -l <"$work/started") starts of pump1 on the bus, $(wc -l <"$work/begun") begun in the journal"

# of hoist1 by its own object or by RPDO; a command has one frame
hoist_frames=$(grep -Ec ' 207#0100| 607#2B0121000100' "$work/candump.out")
hoist_begun=$(jq -r 'select(.phase == "begun" and .drive == "hoist1") | .fields[] |
  select(.signal == "control_command" and .asked == 1) | 1' "$journal"/*.jsonl | wc -l)
expect_at_most "starts of hoist1 on the bus, of $hoist_begun in the journal" "$hoist_begun" "$hoist_frames"
expect_at_most "alarms that were older than a second, of $rounds kills" "$rounds" "$kept"
say "$lines lines of $rounds rounds, $kept times an alarm older than a second"
