#!/bin/bash
# What `doctor` says of a machine on which all is well, and of what is broken: each has a line of its own that names it
# and a remedy behind it, and stands in docs/DOCTOR.md. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
traced=vcan0

# examine EXIT-CODE: its lines are in $work/doctor.out
examine() {
  local code
  "$gateway_bin" --config "$work/gateway.toml" --profile-dir "$root/config/profiles" doctor --listen "${listening:-1s}" \
    >"$work/doctor.out" 2>"$work/doctor.err"
  code=$?
  expect "exit code of doctor, which says $(cat "$work/doctor.out" "$work/doctor.err")" "$1" $code
}
# says WHAT VERDICT PATTERN: there is such a line, and behind it a remedy
says() {
  local line
  line=$(grep -E -A1 -- "^$2 +.*$3" "$work/doctor.out" | head -n 2)
  [ -n "$line" ] || fail "$1: no line '$2 $3' in: $(cat "$work/doctor.out")"
  [ "$2" = ok ] || expect_match "remedy of '$1'" '^ +-> .' "$(tail -n 1 <<<"$line")"
  [ "$2" = ok ] && return
  line=$(head -n 1 <<<"$line" | sed "s#$work#…#g; s/  */ /; s/\`/'/g; s/ (non-authoritative).*//")
  grep -qF "| $1 | \`$line\` |" "$root/docs/DOCTOR.md" || fail "docs/DOCTOR.md has no row '| $1 | \`$line\` |'"
  checks=$((checks + 1))
}

useradd --system canopen-gateway || fail "no user"
chmod 711 "$work"
install -d -o canopen-gateway "$work/state"
printf 'secret\n' >"$work/password"
chgrp canopen-gateway "$work/password"
chmod 640 "$work/password"
sed -e "/^\[gateway\]/a state_dir = \"$work/state\"\ncontrol = \"$work/control\"" \
  -e "/^\[mqtt\]/a username = \"line3\"\npassword_file = \"$work/password\"" "$root/tests/system/gateway.toml" >"$work/gateway.toml"
chmod 644 "$work/gateway.toml"
sysctl -qw net.core.rmem_max=4194304
start_broker
start_four_drives

say "before the gateway is started"
examine 0
says "drives that nobody has set up are silent" warning "bus can0: nothing was heard"
says "nothing" ok "files: canopen-gateway may use all"
says "nothing" ok "broker 127.0.0.1:1883: something answers"
says "nothing" ok "port 127.0.0.1:1502: free"
expect_match "the sum" '^0 errors' "$(tail -n 1 "$work/doctor.out")"

say "the gateway runs"
start_gateway
wait_until 10 "all four drives online" register_is 0 2 4
examine 0
cat "$work/doctor.out"
says "nothing, and the gateway runs" ok "gateway: it runs"
says "nothing, and the gateway runs" ok "bus can0: .* all 4 drives heard"
says "nothing, and the gateway runs" ok "port 127.0.0.1:1502: in use"
expect "what it takes for somebody else" "" "$(grep -E 'another master|node id 127' "$work/doctor.out")"
wait_until 5 "the gateway never noticed" register_is 0 2 4
kill "${started[gateway]}"
wait "${started[gateway]}"
unset "started[gateway]"

say "what is broken"
sysctl -qw net.core.rmem_max=212992
chmod 600 "$work/password"
chown root "$work/state" && chmod 700 "$work/state"
kill "${started[mosquitto]}" && wait "${started[mosquitto]}" 2>/dev/null
unset "started[mosquitto]"
order 9 mute on
launch squatter /usr/bin/python3 -c 'import socket, time
s = socket.create_server(("127.0.0.1", 1502))
time.sleep(100)'
launch strangers bash -c 'while sleep 0.2; do cansend vcan0 77F#05; cansend vcan0 70C#05; cansend vcan0 080#; done'
wait_until 5 "somebody has the port" bash -c 'echo >/dev/tcp/127.0.0.1/1502'
examine 1
says "a small receive buffer" warning "receive buffer: net.core.rmem_max is 212992"
says "the password is root's alone" error "file .*/password: canopen-gateway may not read it"
says "so is the state directory" error "file .*/state: canopen-gateway may not write to it"
says "the broker is not there" error "broker 127.0.0.1:1883: not reached"
says "a drive is mute" warning "bus can0: not heard in .*node 9"
says "another program has the port" error "port 127.0.0.1:1502: another program"
says "a device has our node id" error "bus can0: somebody else has the gateway's node id 127"
says "a device that nobody configured" warning "bus can0: heard, and not in the configuration: node 12"
says "another master" warning "bus can0: another master is at work: SYNC"
kill "${started[strangers]}" "${started[squatter]}"

listening=200ms
sed -i 's#mqtt://127.0.0.1:1883#mqtt://broker.invalid:1883#' "$work/gateway.toml"
ip link set vcan0 down
examine 1
says "the interface is switched off" error "bus can0: vcan0 is down"
says "a name that nobody knows" error "broker broker.invalid:1883: no address is known"
sed -i 's/"vcan0"/"can7"/' "$work/gateway.toml"
examine 1
says "the adapter is not plugged in" error "bus can0: there is no interface can7; those of CAN are .*vcan0"
sed -i 's/"can7"/"lo"/' "$work/gateway.toml"
examine 1
says "an interface of another kind" error "bus can0: lo is no CAN interface"

modprobe slcan
mkfifo "$work/adapter"
exec 8<>"$work/adapter"
ip link set vcan0 up
launch adapter bash -c "exec $(dirname "$gateway_bin")/../tests/vcan/slcan_bridge vcan0 <$work/adapter"
wait_until 10 "the adapter's interface" grep -q . "$work/adapter.out"
can=$(head -n 1 "$work/adapter.out")
ip link set "$can" type can bitrate 125000 && ip link set "$can" up
sed -i "s/\"lo\"/\"$can\"/" "$work/gateway.toml"
examine 1
says "two bit rates" warning "bus can0: the interface runs at 125000 bit/s"
says "no restart-ms" warning "bus can0: restart-ms is 0"
sed -i 's/^node = 3/node = 300/' "$work/gateway.toml"
examine 1
says "a configuration with an error" error "configuration: .*1 error"
