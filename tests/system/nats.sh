#!/bin/bash
# The broker is a cluster of three nats-servers (MQTT 3.1.1) behind one name. The node that the gateway is connected to is
# killed: everything works again on another one, and all nodes that are left tell the truth. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"
nodes=(127.0.0.1 127.0.0.2 127.0.0.3)
# The name is known in here only.
{
  cat /etc/hosts
  printf '%s cluster.test\n' "${nodes[@]}"
} >"$work/hosts"
mount --bind "$work/hosts" /etc/hosts || fail "no name for the cluster"
# A cluster that writes everything down three times takes some hundred messages a second, and far less in a user-mode
# kernel: three drives, and no topic for each value.
many_drives 3 '[mqtt]' 'brokers = ["mqtt://cluster.test:1883"]' 'signals = false' 'min_interval = "1s"' \
  >"$work/gateway.toml" <<'DRIVE'
profile = "veichi-ac310"
presets = ["veichi-command-codes"]
[drive.commands]
writers = ["mqtt"]
DRIVE

for node in "${nodes[@]}"; do
  cat >"$work/$node.conf" <<CONFIGURATION
server_name: "n$node"
listen: "$node:4222"
jetstream { store_dir: "$work/$node", max_mem: 64M, max_file: 64M }
cluster { name: cluster, listen: "$node:6222", routes: ["nats://127.0.0.1:6222", "nats://127.0.0.2:6222", "nats://127.0.0.3:6222"] }
mqtt { listen: "$node:$broker_port" }
CONFIGURATION
  launch "$node" nats-server -c "$work/$node.conf"
done
# Looking takes the only processor from the cluster, so it looks seldom.
wait_long() { # wait_long WHAT COMMAND…
  local what=$1
  shift
  seldom() { "$@" || { sleep 3; false; }; }
  wait_until 120 "$what" seldom "$@"
}
# A node answers nobody until the cluster has elected who keeps its store.
cluster_works() {
  for node in "${nodes[@]}"; do
    wait_long "the cluster works at $node" \
      timeout 10 mosquitto_pub -V 311 -h "$node" -p "$broker_port" -q 1 -r -t test -m "$SECONDS"
  done
}
cluster_works

# commanded TOPIC PAYLOAD: it is carried out, and the answer comes where all without a response topic come. While the
# cluster elects it refuses who connects and subscribes, so it may take several times; then the answer tells of the first.
commanded() {
  mosquitto_rr -V 311 -h "$broker_host" -p "$broker_port" -W 10 -t "$topics/$1" -e "$topics/result" -m "$2" |
    grep '"ok":true'
}
# all_true FAULTY HEALTHY: what every node tells; the drives with and without a fault
all_true() {
  local node drive asked=()
  for node in "${nodes[@]}"; do
    look "$node" 8 &
    asked+=($!)
  done
  wait "${asked[@]}"
  for node in "${nodes[@]}"; do
    is_kept "$node" status online && is_kept "$node" health .drives_online 3 || return 1
    for drive in fan1 fan2 fan3; do
      is_kept "$node" "$drive/status" online && is_kept "$node" "$drive/state" '[.online, .fresh] | @json' '[true,true]' ||
        return 1
    done
    is_kept "$node" fan3/state .values.output_frequency "$(jq -n "$(drive_says 3 frequency)")" &&
      is_kept "$node" "$1/alarm/emcy" .active true && is_kept "$node" "$2/alarm/emcy" .active false || return 1
  done
}

start_trace
start_gateway
start_drives --drive veichi-ac310:1 --drive veichi-ac310:2 --drive veichi-ac310:3
wait_until 10 "all drives online" register_is 0 2 3
wait_long "connected to the cluster" register_is 0 4 1
order 1 fault 0x0006
wait_long "every node tells the truth" all_true fan1 fan2
expect "it speaks" 3.1.1 "$(kept 127.0.0.1 health .protocol)"
wait_long "a motor runs" \
  commanded fan3/set '{"frequency_command":30.0,"torque_command":0.0,"control_command":1,"id":"a1"}'
wait_until 10 "30 Hz" register_is 3 2 3000

node=$(ss -Htnp state established "dport = :$broker_port" | grep "pid=${started[gateway]}," | awk '{print $4}')
node=${node%:*}
expect_match "the gateway is connected to a node" '^127' "$node"
say "the gateway's node $node is killed"
mark
killed=$(date +%s%3N)
kill -9 "${started[$node]}"
wait "${started[$node]}" 2>/dev/null
order 1 clear
order 2 fault 0x0005
left=()
for each in "${nodes[@]}"; do
  [ "$each" = "$node" ] || left+=("$each")
done
nodes=("${left[@]}")
cluster_works
say "the cluster works again after $(($(date +%s%3N) - killed)) ms"
wait_long "connected again" register_is 0 4 1
say "connected again after $(($(date +%s%3N) - killed)) ms"
wait_long "every node tells the truth" all_true fan2 fan1
say "everything true after $(($(date +%s%3N) - killed)) ms"
expect_no_frames "nothing was sent to a drive" "$nmt|$(commands_to 123)"
for broker_host in "${nodes[@]}"; do
  wait_long "a command by $broker_host" \
    commanded fan3/set "{\"frequency_command\":2${broker_host##*.}.0,\"id\":\"$broker_host\"}"
done
order 2 clear
order 1 fault 0x0006
wait_long "alarms go on" all_true fan1 fan2
expect_frames "each command once" 2 "$nmt|$(commands_to 123)"
