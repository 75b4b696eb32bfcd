# A part of plant.sh, which has the functions and a gateway that runs: the two lists of addresses that docs/SECURITY.md gives,
# letter for letter (/shared/drop-ins has them out of the page), are tried from the addresses that stand there. The machines of
# the site are a network namespace behind a veth, so that their packets come in by an interface, as those of others do.
# What is refused with the lists was let through before, at the same place.
gateway=192.168.10.1
scada=(192.168.10.11 192.168.10.12)
stranger=192.168.10.13
broker=192.168.30.5
other_broker=192.168.30.6
asked=/root/brokers

# from ADDRESS: connections to the gateway come from there, from now on.
from() { ip -n site route replace $gateway dev site src "$1"; }
in_site() { ip netns exec site "$@"; }
drives_online() {
  in_site mbpoll -m tcp -p 502 -o 5 -a 0 -0 -t 4 -r 2 -1 -q $gateway | grep -q '^\[2\]:[[:space:]]*2$'
}
answered() {
  from "$1"
  wait_until 20 "Modbus is answered to $1" drives_online
}
let_in() {
  from "$1"
  in_site timeout 10 bash -c "exec 3<>/dev/tcp/$gateway/$2" || fail "$1 has no connection to port $2"
  checks=$((checks + 1))
}
# Connections from ADDRESS to PORT that its own machine is trying to open.
asking() { in_site ss -Htn state syn-sent "src $1 and dst $gateway and dport = :$2" | wc -l; }
asks() { [ "$(asking "$1" "$2")" = 1 ]; }
# refused ADDRESS:PORT...: questions from there remain without an answer, the repeated ones (after 1 s), too.
refused() {
  local each clients=()
  for each; do
    from "${each%:*}"
    (exec ip netns exec site bash -c "exec 3<>/dev/tcp/$gateway/${each#*:} && sleep 60") &
    clients+=($!)
    wait_until 5 "a connection is asked for by $each and not given" asks "${each%:*}" "${each#*:}"
  done
  sleep 1.3
  for each; do expect "connections that $each still asks for" 1 "$(asking "${each%:*}" "${each#*:}")"; done
  kill "${clients[@]}"
  wait "${clients[@]}" 2>/dev/null
}
# was_asked BROKER: for MQTT, after $since.
was_asked() { awk -v broker="$1" -v since="$since" '$1 == broker && $2 >= since { was = 1 } END { exit !was }' $asked; }
restart() {
  systemctl restart canopen-gateway || fail "restart"
  since=$(property ExecMainStartTimestampMonotonic | awk '{ print $1 / 1e6 }')
}

begin_site() {
  local address
  { ip netns add site && ip link add plant type veth peer name site netns site; } || fail "a wire to the machines of the site"
  ip address add $gateway/24 dev plant
  ip address add 192.168.30.1/24 dev plant
  ip link set plant up
  for address in "${scada[@]}" $stranger $broker $other_broker; do ip -n site address add "$address/24" dev site; done
  ip -n site link set site up
  # Both brokers: they write down where and when (/proc/uptime) somebody asked for MQTT, and hang up. Each connection has its
  # own process: one that the lists cut off stays silent.
  in_site perl -MIO::Socket::INET -e '$| = 1; $SIG{CHLD} = "IGNORE";
    my $all = IO::Socket::INET->new(LocalPort => 1883, Listen => 8, ReuseAddr => 1) or die $@;
    while (my $one = $all->accept) {
      next if fork;
      sysread $one, my $said, 999;
      open my $uptime, "<", "/proc/uptime";
      print $one->sockhost, " ", <$uptime> if $said =~ /MQTT/;
      exit;
    }' >$asked &
  brokers=$!
  cp /etc/canopen-gateway/gateway.toml /root/good.toml
  sed -i 's/^\[http\]$/&\nlisten = "0.0.0.0:9464"\nread_from = ["192.168.0.0\/16"]/' /etc/canopen-gateway/gateway.toml
  printf '[mqtt]\nbrokers = ["mqtt://%s:1883", "mqtt://%s:1883"]\n' $other_broker $broker >>/etc/canopen-gateway/gateway.toml
  restart
}

# An open connection is asked for a register before and after the reload: the bytes of the answers.
reload_with_open_connection() {
  in_site bash -c 'exec 3<>"/dev/tcp/$1/502"
    ask() { printf "\0\1\0\0\0\6\0\3\0\2\0\1" >&3; timeout "$1" head -c 11 <&3 | wc -c; }
    ask 10
    systemctl daemon-reload
    for _ in 1 2 3; do left=$(ask 3); [ "$left" != 0 ] || break; done
    echo $left' - $gateway | paste -sd ' '
}

filter_addresses() {
  local address
  let_in $stranger 9464
  let_in $broker 502
  wait_until 10 "$other_broker is asked" was_asked $other_broker
  (cd /shared/drop-ins && cp --parents etc/systemd/system/canopen-gateway.{socket,service}.d/addresses.conf /) || fail "drop-ins"
  from $stranger
  expect "bytes over the open connection of $stranger, before the lists and with them" "11 0" "$(reload_with_open_connection)"
  say "the lists of addresses in docs/SECURITY.md: a daemon-reload, and an open Modbus connection of $stranger is dead"

  restart
  for address in "${scada[@]}"; do answered "$address"; done
  expect "Modbus on this machine" 2 "$(read_register 0 2)"
  # The broker is in the service's list, and not in the socket's.
  refused $stranger:502 $stranger:9464 $broker:502
  let_in "${scada[0]}" 9464
  let_in $broker 9464
  wait_until 20 "$broker is asked" was_asked $broker
  was_asked $other_broker && fail "$other_broker is asked, which is in no list"
  say "after a restart: Modbus for ${scada[*]}, not for $stranger and $broker; HTTP for ${scada[0]} and $broker, not for $stranger"
  say "and MQTT goes to $broker, not to $other_broker"

  rm -r /etc/systemd/system/canopen-gateway.socket.d
  systemctl daemon-reload
  from $stranger
  answered $stranger
  say "with the service's list alone Modbus is open to $stranger"
}

end_site() {
  rm -r /etc/systemd/system/canopen-gateway.service.d
  cp /root/good.toml /etc/canopen-gateway/gateway.toml
  kill $brokers
  ip netns delete site
}

# systemd says at the first unit with a list that it can do nothing with it.
systemd_cannot_filter() {
  systemd-run --quiet --wait -p IPAddressDeny=any true
  journalctl --sync
  cannot=$(journalctl -b -o cat --no-pager | grep 'configures an IP firewall, but')
}

systemd_cannot_filter && fail "this systemd filters no addresses: $cannot"
begin_site
filter_addresses
end_site
