# A serial CAN adapter (slcan) whose bus is vcan0. Sourced after lib.sh, inside tests/vcan/run.
bridge=$(dirname "$gateway_bin")/../tests/vcan/slcan_bridge
modprobe slcan

# The adapter with a console of its own, see slcan_bridge.cpp. The driver can echo on hand-over only.
plug() {
  [ -p "$work/adapter" ] || mkfifo "$work/adapter"
  exec 8<>"$work/adapter"
  "$bridge" vcan0 <"$work/adapter" >"$work/adapter.out" 2>"$work/adapter.err" &
  started[adapter]=$!
  wait_until 10 "the adapter's interface" grep -q . "$work/adapter.out"
  can=$(head -n 1 "$work/adapter.out")
  ip link set "$can" type can bitrate 125000 || fail "bit rate of $can"
  ip link set "$can" txqueuelen 10 up || fail "no $can"
}
pull() {
  kill "${started[adapter]}"
  wait "${started[adapter]}" 2>/dev/null
  unset "started[adapter]"
}
adapter() {
  local before
  before=$(wc -l <"$work/adapter.out")
  printf '%s\n' "$*" >&8
  wait_until 5 "the adapter takes '$*'" bash -c "[ \$(wc -l <'$work/adapter.out') -gt $before ]"
}
