#!/bin/bash
# What `doctor` says of a machine on which all is well, and of what is broken: each has a line of its own that names it
# and a remedy behind it, and stands in docs/DOCTOR.md. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"

# examine EXIT-CODE: its lines are in $work/doctor.out
examine() {
  local code
  "$gateway_bin" --config "${configuration:-$work/gateway.toml}" --profile-dir "$root/config/profiles" doctor --listen "${listening:-1s}" \
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
  line=$(head -n 1 <<<"$line" | sed "s#$work#…#g; s/  */ /; s/\`/'/g; s/ (non-authoritative).*//; s/: heard: .*node id/: heard: … node id/")
  grep -qF "| $1 | \`$line\` |" "$root/docs/DOCTOR.md" || fail "docs/DOCTOR.md has no row '| $1 | \`$line\` |'"
  checks=$((checks + 1))
}

# squat: another program has the port of Modbus
squat() {
  launch squatter /usr/bin/python3 -c 'import socket, time
s = socket.create_server(("127.0.0.1", 1502))
time.sleep(100)'
  wait_until 20 "somebody has the port" bash -c 'echo >/dev/tcp/127.0.0.1/1502'
}
end_gateway() {
  kill "${started[gateway]}"
  wait "${started[gateway]}"
  unset "started[gateway]"
}

useradd --system canopen-gateway || fail "no user"
chmod 711 "$work"
install -d -o canopen-gateway "$work/state"
printf 'secret\n' >"$work/password"
chown canopen-gateway "$work/password"
chmod 600 "$work/password"
sed -e "/^\[gateway\]/a state_dir = \"$work/state\"\ncontrol = \"$work/control\"" \
  -e "/^\[mqtt\]/a username = \"line3\"\npassword_file = \"$work/password\"" "$root/tests/system/gateway.toml" >"$work/gateway.toml"
chmod 644 "$work/gateway.toml"
sysctl -qw net.core.rmem_max=4194304
start_broker
start_four_drives
start_trace

say "before the gateway is started"
mark
examine 0
expect_no_frames "frames while doctor runs without a gateway" ' ([0-6]..|7[0-9A-E].)#'  # all but catch_up's own
says "the gateway is not started" warning "gateway: it does not run"
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
says "nothing, and the gateway runs" ok "port 127.0.0.1:1502: the gateway listens there"
expect "what it takes for somebody else" "" "$(grep -E 'another master|node id 127' "$work/doctor.out")"
wait_until 5 "the gateway never noticed" register_is 0 2 4

say "whether the gateway runs is not known: nobody is accused"
sed "s#^control = .*#control = \"\"#" "$work/gateway.toml" >"$work/mute.toml"
configuration=$work/mute.toml
examine 0
says "the gateway has no control socket" warning "gateway: .control. is empty"
says "its frames may be anybody's" warning "bus can0: heard: .*node id 127; from the gateway or from somebody else"
says "so may its port" warning "port 127.0.0.1:1502: in use, by the gateway or by another program"
expect "what it takes for somebody else" "" "$(grep -E 'another master|another program listens|somebody else has' "$work/doctor.out")"
configuration=$work/gateway.toml
kill -STOP "${started[gateway]}"
examine 0
kill -CONT "${started[gateway]}"
says "the gateway hangs" warning "gateway: whether it works is not known"
says "nothing, and the gateway hangs" ok "port 127.0.0.1:1502: the gateway listens there"
end_gateway

say "a port below 1024, and no unit that opens it"
sed "s#127.0.0.1:1502#127.0.0.1:502#" "$work/gateway.toml" >"$work/low.toml"
configuration=$work/low.toml
examine 0
says "port 502, and nothing opens it for the service" warning "port 127.0.0.1:502: free, but canopen-gateway may not take it"
configuration=$work/gateway.toml

say "somebody has the port, and the gateway runs without it"
squat
start_gateway
wait_until 10 "the gateway answers" "$gateway_bin" status --control "$work/control"
examine 1
says "another program had the port first" error "port 127.0.0.1:1502: another program listens there, and the gateway"
end_gateway
kill "${started[squatter]}" && wait "${started[squatter]}" 2>/dev/null

say "a secret that only the service sees"
sed "s#^password_file = .*#password_file = \"mqtt-password\"#" "$work/gateway.toml" >"$work/credential.toml"
configuration=$work/credential.toml
examine 0
says "a secret is not beside the configuration" warning "file .*/mqtt-password: it is not beside the configuration"
says "nothing" ok "broker 127.0.0.1:1883: something answers"

say "what is no broker"
launch impostors /usr/bin/python3 -c 'import socket, threading, time
def serve(port, words):
    server = socket.create_server(("127.0.0.1", port))
    while True:
        client, _ = server.accept()
        client.sendall(words)
        client.recv(100)
        client.close()
for port, words in (1884, b"SSH-2.0-OpenSSH_9.2\r\n"), (1885, b""):
    threading.Thread(target=serve, args=(port, words), daemon=True).start()
time.sleep(100)'
wait_until 5 "they listen" bash -c 'echo >/dev/tcp/127.0.0.1/1884 && echo >/dev/tcp/127.0.0.1/1885'
openssl req -x509 -newkey rsa:2048 -nodes -keyout "$work/key.pem" -out "$work/cert.pem" -days 2 -subj /CN=localhost \
  2>/dev/null || fail "no certificate"
launch tls openssl s_server -accept 127.0.0.1:8883 -key "$work/key.pem" -cert "$work/cert.pem" -quiet
wait_until 10 "the port for TLS is open" bash -c 'echo >/dev/tcp/127.0.0.1/8883'
brokers='"mqtt://127.0.0.1:1884", "mqtt://127.0.0.1:1885", "mqtt://127.0.0.1:8883"'
sed "s#^brokers = .*#brokers = [$brokers]#" "$work/gateway.toml" >"$work/brokers.toml"
configuration=$work/brokers.toml
examine 1
says "the broker's port is that of SSH" error "broker 127.0.0.1:1884: what answers there is no MQTT broker"
says "the broker only closes" warning "broker 127.0.0.1:1885: it closes the connection"
says "the broker's port is one for TLS, and it is named mqtt://" error "broker 127.0.0.1:8883: what answers there speaks TLS"
kill "${started[impostors]}" "${started[tls]}"
configuration=$work/gateway.toml

say "what is broken"
sysctl -qw net.core.rmem_max=212992
chown root "$work/password"
chown root "$work/state" && chmod 700 "$work/state"
kill "${started[mosquitto]}" && wait "${started[mosquitto]}" 2>/dev/null
unset "started[mosquitto]"
order 9 mute on
squat
launch strangers bash -c 'while sleep 0.2; do cansend vcan0 77F#05; cansend vcan0 70C#05; cansend vcan0 080#; done'
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
