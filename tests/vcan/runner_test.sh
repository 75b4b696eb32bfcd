#!/bin/bash
# What tests/vcan/run promises, tried for real. Takes no arguments; prints what failed.
set -u
here=$(dirname "$(realpath "$0")")
run=$here/run
failed=0

check() {  # check WHAT EXPECTED ACTUAL
  if [ "$2" != "$3" ]; then
    printf 'FAILED: %s\n  expected: %s\n  actual:   %s\n' "$1" "$2" "$3" >&2
    failed=1
  fi
}

outside=$(mktemp -d) || exit 1
trap 'rm -rf "$outside"' EXIT
mkdir "$outside/shared" "$outside/private"
echo untouched >"$outside/private/kept"
export OUTSIDE=$outside PASSED_ON='two  words'

# One machine for everything that needs no machine of its own: starting one takes seconds.
"$run" -t 60 -w "$outside/shared" -- bash -c '
  cd /tmp || exit 1
  candump -n 1 -L vcan0 >heard & listener=$!
  until grep -q "^ *vcan0 " /proc/net/can/rcvlist_all; do :; done  # not "(vcan0: no entry)"
  cansend vcan0 185#0102030405060708
  wait $listener && cut -d" " -f3 heard
  cat /sys/class/net/vcan0/tx_queue_len
  echo "$PASSED_ON|$VCAN_KERNEL"
  echo changed >"$OUTSIDE/private/kept"
  echo new >"$OUTSIDE/private/new"
  cp heard "$OUTSIDE/shared/heard"
  sleep 1000 &
  echo to-stderr >&2
  exit 7' >"$outside/out" 2>"$outside/err"
check "exit status" 7 $?
check "stdout" "185#0102030405060708 1000 two  words" "$(head -n 3 "$outside/out" | paste -sd ' ' | cut -d'|' -f1)"
check "stderr" to-stderr "$(cat "$outside/err")"
check "a shared directory is written" 185#0102030405060708 "$(cut -d' ' -f3 "$outside/shared/heard")"
if grep -q '|uml$' "$outside/out"; then
  check "a file of this machine is not changed" untouched "$(cat "$outside/private/kept")"
  check "no file comes into being on this machine" "" "$(find "$outside/private" -name new)"
  # Inside the user-mode kernel CAN and root are there: the other way of running, a namespace, is taken.
  inside=$("$run" -t 60 -- "$run" -t 20 -- bash -c '
    candump -n 1 -L vcan0 >/tmp/heard & listener=$!
    until grep -q "^ *vcan0 " /proc/net/can/rcvlist_all; do :; done  # not "(vcan0: no entry)"
    cansend vcan0 185#11; wait $listener
    echo "$VCAN_KERNEL $(cut -d" " -f3 /tmp/heard)"; exit 9')
  check "exit status of a network namespace" 9 $?
  check "frames in a network namespace" "host 185#11" "$inside"
fi

"$run" -t 5 -- sleep 1000 >"$outside/out" 2>&1
check "status after the time is over" 124 $?
check "what is said then" "tests/vcan/run: ended after 5 s" "$(cat "$outside/out")"
"$run" -w "$outside/absent" -- true 2>/dev/null
check "status for a missing directory" 125 $?
exit $failed
