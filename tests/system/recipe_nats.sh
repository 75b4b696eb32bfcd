#!/bin/bash
# docs/recipes/nats.md as it stands: the gateway needs no more than the permissions give it, who may not command cannot,
# and the loss of a node changes nothing of that. By recipe_run, in ctest -C long.
. "$(dirname "$0")/recipe_lib.sh"
nodes=(127.0.0.1 127.0.0.2 127.0.0.3)
{
  cat /etc/hosts
  for each in 1 2 3; do printf '127.0.0.%s nats%s.plant.example nats.plant.example\n' $each $each; done
} >"$work/hosts"
mount --bind "$work/hosts" /etc/hosts || fail "no names for the cluster"
recipe mosquitto
recipe nats
for each in 1 2 3; do
  # The routes name all three; what is of this machine alone is its name and what it listens on.
  sed -e "/server_name/s/nats1/nats$each/; /listen/s/nats1/nats$each/; s/127.0.0.1:4222/127.0.0.$each:4222/" \
    -e "s,$site/var/lib/nats,$work/store$each," "$site/etc/nats-server.conf" >"$work/nats$each.conf"
  launch "nats$each" nats-server -c "$work/nats$each.conf"
done
credentials=(-u dashboard -P change-me-2 -V 311)
# Looking takes the only processor from the cluster, so it looks seldom.
wait_long() {
  local what=$1
  shift
  seldom() { "$@" || { sleep 3; false; }; }
  wait_until 120 "$what" seldom "$@"
}
try() { timeout 10 mosquitto_pub -V 311 -h "$broker_host" -p "$broker_port" -q 1 "$@"; }
cluster_works() {
  for broker_host in "${nodes[@]}"; do
    wait_long "the cluster works at $broker_host" try -u line3 -P change-me-1 -r -t "$topics/probe" -m "$SECONDS"
  done
}
commanded() { # commanded ID
  timeout 20 mosquitto_rr -V 311 -h "$broker_host" -p "$broker_port" -W 10 -u scada -P change-me-3 -t "$topics/pump1/set" \
    -e "$topics/result" -m '{"frequency_command":30.0,"torque_command":0.0,"control_command":"forward","id":"'"$1"'"}' |
    grep '"ok":true'
}
log_says() { grep -hq "$1" "$work"/nats?.err; }

cluster_works
recipe_gateway
recipe_drive
wait_long "the gateway is online" is_retained status online
wait_long "the drive is online" is_retained pump1/status online
wait_long "all subscriptions are there" field_is health '.refused_subscriptions | length' 0
wait_long "a command" commanded a1
wait_until 20 "the motor runs" runs_at 30.00

say "who may not"
try -u dashboard -P change-me-2 -t "$topics/pump1/set" -m '{"frequency_command":10.0}'
wait_until 10 "a dashboard that commands" log_says 'Publish Violation.*"dashboard".*pump1.set'
try -u scada -P change-me-3 -t "$topics/pump1/nmt/set" -m stop
wait_until 10 "NMT by the one who commands" log_says 'Publish Violation.*"scada".*nmt.set'
try -u scada -P change-me-3 -t "$topics/pump1/state" -m '{}'
wait_until 10 "a forged value" log_says 'Publish Violation.*"scada".*pump1.state'
try -t "$topics/pump1/set" -m 1 && fail "somebody without a name may write"
expect "what the drive was told" 30.00 "$(drive_says 5 frequency)"

say "a node dies"
node=$(ss -Htnp state established "dport = :$broker_port" | grep "pid=${started[gateway]}," | awk '{print $4}')
node=${node%:*}
kill -9 "${started[nats${node##*.}]}"
wait "${started[nats${node##*.}]}" 2>/dev/null
left=()
for each in "${nodes[@]}"; do [ "$each" = "$node" ] || left+=("$each"); done
nodes=("${left[@]}")
cluster_works
say "the cluster works again"
wait_long "a command" commanded a2
say "a command is carried out"
wait_long "the gateway is online" is_retained status online
