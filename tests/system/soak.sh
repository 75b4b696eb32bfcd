#!/bin/bash
# Ten minutes of trouble: drives fault, fall silent and reboot, the broker restarts, clients read and command all the
# while. Afterwards everything is as at the beginning, and the gateway holds no more memory and descriptors than before.
# Run inside tests/vcan/run; SOAK_SECONDS shortens it.
. "$(dirname "$0")/lib.sh"
cp "$root/tests/system/gateway.toml" "$work/gateway.toml"
seconds=${SOAK_SECONDS:-600}

memory() { awk '/^VmRSS/ {print $2}' "/proc/${started[gateway]}/status"; } # KiB
descriptors() { ls "/proc/${started[gateway]}/fd" | wc -l; }

all_well() {
  wait_until 30 "connected to the broker" register_is 0 4 1
  wait_until 30 "all four drives online" register_is 0 2 4
  for drive in fan1 pump1 hoist1 mixer1; do
    wait_until 20 "$drive: online on MQTT" is_retained "$drive/status" online
    wait_until 20 "$drive: fresh" field_is "$drive/state" .fresh true
    wait_until 20 "$drive: no emergency" field_is "$drive/alarm/emcy" .active false
    wait_until 20 "$drive: no lost heartbeat" field_is "$drive/alarm/heartbeat" .active false
    wait_until 20 "$drive: no boot alarm" field_is "$drive/alarm/boot" .active false
  done
}

trouble() { # once around
  expect_match "hoist1 runs" '"ok":true' "$(ask hoist1/set '{"frequency_command":25.0,"control_command":1}')"
  order 5 fault 0x0005
  wait_until 10 "the fault is an alarm" field_is pump1/alarm/emcy .active true
  order 5 clear
  order 9 mute on
  wait_until 10 "the silence is an alarm" field_is mixer1/alarm/heartbeat .active true
  order 9 mute off
  order 3 reboot
  write_registers 7 101 "$((2000 + RANDOM % 1000))" >/dev/null
  expect "hoist1 is told to stop" written "$(write_registers 7 100 5)"
  all_well
}

start_broker
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
start_four_drives
all_well
# A client that never stops reading.
(while sleep 0.05; do read_register 5 2; done) >"$work/reader.out" 2>&1 &
started[reader]=$!

trouble
trouble
memory_before=$(memory)
descriptors_before=$(descriptors)
say "after two rounds: $memory_before KiB, $descriptors_before descriptors"
end=$((SECONDS + seconds))
rounds=0
while [ "$SECONDS" -lt "$end" ]; do
  if [ $((rounds % 4)) = 3 ]; then
    kill "${started[mosquitto]}"
    wait "${started[mosquitto]}" 2>/dev/null
    wait_until 20 "the gateway notices" register_is 0 4 0
    start_broker
    all_well
  fi
  trouble
  rounds=$((rounds + 1))
done
say "after $rounds rounds more: $(memory) KiB, $(descriptors) descriptors, $(wc -l <"$work/reader.out") values read"
[ "$(memory)" -le $((memory_before + 2048)) ] || fail "memory grew from $memory_before to $(memory) KiB"
[ "$(descriptors)" -le $((descriptors_before + 2)) ] || fail "descriptors grew from $descriptors_before to $(descriptors)"
checks=$((checks + 2))
