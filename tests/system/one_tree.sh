#!/bin/bash
# The gateway's topics at the broker. What a renamed drive, a removed one, and signals that were switched off have left
# is emptied at the next start, and what others keep there stays. A second gateway of this name is told on both, and
# nothing is emptied for it. Run inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"

# site NAME SED-ARGUMENTS…: the site, with what changes in it; the name is that of its state
site() {
  local name=$1
  shift
  sed -e "/^\[gateway\]/a state_dir = \"$work/$name\"\ncontrol = \"$work/$name.control\"" \
    -e '/^\[mqtt\]/a expiry = "4s"\nstale_payload = "stale"' "$@" "$root/tests/system/gateway.toml"
}
# The retained topics of the gateway, without the part that all have.
tree() {
  mosquitto_sub -h 127.0.0.1 -p "$broker_port" -t "$topics/#" --retained-only -W 1 -F '%t' 2>/dev/null |
    sed "s,^$topics/,," | sort
}
# The same as it has to be with these drives, without topics of signals.
tree_of() {
  local drive
  printf '%s\n' alarms bus/can0/alarm health info status
  for drive in "$@"; do
    printf "$drive/%s\n" status state control alarm/{emcy,heartbeat,boot,data,control}
  done
}
tree_is() { [ "$(tree)" = "$1" ]; }
# tells_of INSTANCE OTHER: the one has told of the other in its health
tells_of() { grep -Eq " $topics/health .*\"instance\":\"$1\".*\"another_instance\":\"$2\"" "$work/witness.out"; }
end_of() {
  kill -TERM "${started[$1]}"
  wait "${started[$1]}" 2>/dev/null
}

site first >"$work/gateway.toml"
start_broker
start_gateway
start_four_drives
wait_until 10 "all four drives online" register_is 0 2 4
wait_until 10 "values" is_retained mixer1/status online
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -r -t "$topics/notes/page" -m 'a page'
mosquitto_pub -h 127.0.0.1 -p "$broker_port" -r -t "$topics/fan1/Remark" -m 'a remark'
end_of gateway
before=$(tree)
for topic in hoist1/state hoist1/output_frequency mixer1/alarm/emcy fan1/output_frequency; do
  expect_match "left of before" "^$topic\$" "$before"
done

say "a drive renamed, one removed, signals switched off"
site first -e 's/^name = "hoist1"/name = "hoist2"/' -e '/^\[mqtt\]/a signals = false' >"$work/all.toml"
mixer1=$(grep -n '^\[\[drive\]\]' "$work/all.toml" | tail -n 1 | cut -d: -f1)
head -n "$((mixer1 - 1))" "$work/all.toml" >"$work/gateway.toml"
start_gateway
wait_until 10 "three drives online" register_is 0 2 3
expected=$( (tree_of fan1 pump1 hoist2; printf '%s\n' notes/page fan1/Remark) | sort)
wait_until 10 "what is gone is emptied, and nothing else" tree_is "$expected"
for topic in hoist1/status hoist1/alarm/emcy mixer1/state fan1/output_frequency; do
  expect_match "the log names it" "emptied.* $topics/$topic( |\$)" "$(grep emptied "$work/gateway.err")"
done

say "a second gateway of this name, with another client id and another drive"
start_witness
cat >"$work/second.toml" <<END
[gateway]
name = "line3"
state_dir = "$work/second"
control = "$work/second.control"
[[bus]]
name = "can9"
interface = "virtual"
[mqtt]
brokers = ["mqtt://127.0.0.1:$broker_port"]
client_id = "second"
expiry = "4s"
[[drive]]
name = "other1"
node = 1
profile = "veichi-ac300"
enabled = false
END
first=$(field info .instance)
launch second "$gateway_bin" run --config "$work/second.toml" --profile-dir "$root/config/profiles"
wait_until 10 "it is there" is_retained other1/status offline
second=$(field info .instance)
expect_match "instances" '^[0-9A-F]{16} [0-9A-F]{16}$' "$first $second"
expect_match "two of them" different "$([ "$first" != "$second" ] && echo different)"
wait_until 10 "the first tells of the second" tells_of "$first" "$second"
wait_until 10 "the second tells of the first" tells_of "$second" "$first"
for bus in can0 can9; do
  wait_until 5 "an alarm of $bus" field_is "bus/$bus/alarm" '[.active, .reason, .severity] | @json' \
    '[true,"other-gateway","warning"]'
done
for log in gateway second; do
  expect_match "the log of $log" "another gateway of our name lives" "$(cat "$work/$log.err")"
done
wait_until 10 "the second empties nothing" grep -q 'topics that this gateway does not publish are left' "$work/second.err"
expect "gone meanwhile" "" "$(comm -23 <(printf '%s\n' "$expected") <(tree))"
expect "put right at once a second, said once" 1 "$(grep -c 'somebody else wrote' "$work/gateway.err")"

say "the second one ends"
end_of second
wait_until 5 "the first is online" is_retained status online
wait_until 10 "the alarm is over" field_is bus/can0/alarm .active false
wait_until 5 "health tells of nobody" field_is health .another_instance null
