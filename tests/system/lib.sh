# Shared by the system tests: the real program on real SocketCAN, a real broker, and independent clients.
# Each test sources this inside tests/vcan/run. Every wait has a bound; a failed expectation ends the test.
set -u
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
gateway_bin=${GATEWAY_BIN:?the canopen-gateway executable}
work=$(mktemp -d /tmp/gateway-system.XXXXXX)
broker_host=127.0.0.1
broker_port=1883
broker_listener="$broker_port 127.0.0.1"
modbus_port=1502
topics=canopen/line3
interface=vcan0  # of the drives
traced=vcan0     # or `any`
declare -A started=()
checks=0

say() { printf '%s %s\n' "$(date +%T.%3N)" "$*"; }

fail() {
  say "FAILED: $*"
  for log in "$work"/*.err; do
    [ -s "$log" ] && { echo "--- ${log##*/}"; tail -n 40 "$log"; }
  done
  [ -s "$work/witness.out" ] && { echo "--- the newest messages"; tail -n 30 "$work/witness.out" | cut -c1-300; }
  exit 1
}

finish() {
  local code=$?
  for pid in "${started[@]}"; do kill "$pid" 2>/dev/null; done
  wait 2>/dev/null
  [ "$code" = 0 ] && say "passed, $checks expectations"
  [ -n "${leave_nothing:-}" ] && rm -rf "$work"
  exit "$code"
}
trap finish EXIT

# launch NAME COMMAND…: in the background; output to $work/NAME.out and NAME.err
launch() {
  local name=$1
  shift
  "$@" </dev/null >"$work/$name.out" 2>"$work/$name.err" &
  started[$name]=$!
}

# wait_until SECONDS WHAT COMMAND…: until the command succeeds
wait_until() {
  local limit=$1 what=$2 end
  shift 2
  end=$(($(date +%s%N) + ${limit%.*} * 1000000000))
  until "$@" >/dev/null 2>&1; do
    [ "$(date +%s%N)" -lt "$end" ] || fail "not within $limit s: $what ($*)"
    sleep 0.05
  done
  checks=$((checks + 1))
}

# expect WHAT EXPECTED ACTUAL: equal text
expect() {
  [ "$2" = "$3" ] || fail "$1: expected '$2', got '$3'"
  checks=$((checks + 1))
}

# expect_at_most WHAT LIMIT ACTUAL: whole numbers; an actual 0 would mean that nothing was measured
expect_at_most() {
  [ "$3" -gt 0 ] && [ "$3" -le "$2" ] && checks=$((checks + 1)) && return
  fail "$1: expected 1 to $2, got '$3'"
}

# expect_match WHAT PATTERN ACTUAL: an extended regular expression
expect_match() {
  grep -Eq -- "$2" <<<"$3" || fail "$1: expected to match '$2', got '$3'"
  checks=$((checks + 1))
}

# launch_broker COMMAND…: with the configuration that is there, by COMMAND, which decides where it runs
launch_broker() {
  launch mosquitto "$@" mosquitto -c "$work/mosquitto.conf"
  wait_until 10 "the broker listens" bash -c "echo >/dev/tcp/$broker_host/$broker_port"
}

start_broker() {
  printf 'listener %s\nallow_anonymous true\n' "$broker_listener" >"$work/mosquitto.conf"
  launch_broker "$@"
}

# Every message the broker hands out, from now on: TIME TOPIC PAYLOAD
start_witness() {
  launch witness mosquitto_sub -h "$broker_host" -p "$broker_port" -F '%U %r %t %p' -t '#'
}

# The frames on the bus, with the kernel's time, in candump's log format. As `start_trace nice` it gives way to what it looks
# at: it takes four system calls a frame, on the one processor of the user-mode kernel. Until its turn comes frames wait in a
# buffer; where that runs over candump says so (DROPCOUNT).
start_trace() {
  launch candump ${1:+"$1" -n 19} candump ${1:+-d -r 33554432} -L "$traced"
  catch_up
}

# Waits until candump wrote down everything that was on the bus before: a frame that means nothing to anybody (CiA 301
# uses no COB-ID from 0x780 on but LSS's 0x7E4 and 0x7E5) is sent until it stands in the trace. One that was sent before
# candump listened is lost, so it is sent again.
catch_up() {
  local end=$((SECONDS + 10)) frame
  frame=7F0#$(printf '%08X' "$((catch_ups += 1))")
  until grep -q " $frame\$" "$work/candump.out"; do
    kill -0 "${started[candump]}" 2>/dev/null || fail "candump has ended"
    [ "$SECONDS" -lt "$end" ] || fail "candump does not write what is on the bus"
    cansend vcan0 "$frame"
    sleep 0.05
  done
}
catch_ups=0

# mark: from here on expect_frames and expect_no_frames look.
mark() {
  catch_up
  marked=$(wc -l <"$work/candump.out")
}
marked=0

# Frames since the mark that match an extended regular expression.
frames() { tail -n +"$((marked + 1))" "$work/candump.out" | grep -E -- "$1"; }

# expect_frames WHAT COUNT PATTERN: as many since the mark
expect_frames() {
  local found
  catch_up
  found=$(frames "$3")
  [ "$(grep -c . <<<"$found")" = "$2" ] || fail "$1: expected $2 frames, got: $found"
  checks=$((checks + 1))
}
expect_no_frames() { expect_frames "$1" 0 "$2"; }

# What commands the drives of these nodes, as patterns for candump's lines: RPDOs and SDO downloads (CiA 301, 7.2.4.3:
# commands 0x00 to 0x3F, of blocks 0xC0 to 0xDF), and NMT. The gateway's polls are uploads.
commands_to() { printf ' [2-5]0[%s]#| 60[%s]#[0-3CD]' "$1" "$1"; }
nmt=' 000#'

# The time and what of the frames whose lines match, from the trace's own stamps, which are the kernel's.
# longest_gap PATTERN: the longest time in ms between two of them, 0 without any
longest_gap() {
  grep -E -- "$1" "$work/candump.out" | awk '{t = substr($1, 2) + 0}
    NR > 1 && t - last > gap {gap = t - last} {last = t} END {printf "%.0f\n", gap * 1000}'
}

# power_up NODES: how many of the nodes 1 to NODES are operational, which each shows by its first TPDO1 (CiA 301, 7.3.2.2:
# no PDO before), and how many ms after the first boot-up of any of them the last one was.
power_up() {
  awk -v nodes="$1" 'BEGIN {for (n = 1; n <= nodes; n++) {boot_up[sprintf("%03X#00", 1792 + n)]; tpdo[sprintf("%03X", 384 + n)]}}
    {t = substr($1, 2) + 0}
    ($3 in boot_up) && !begun {begun = t}
    {id = substr($3, 1, 3)}
    begun && (id in tpdo) {delete tpdo[id]; operational++; last = t}
    END {printf "%d %.0f\n", operational, (last - begun) * 1000}' "$work/candump.out"
}

# The most frames of one second of the clock
busiest_second() {
  awk '{frames[substr($1, 2, 10)]++} END {for (s in frames) if (frames[s] > most) most = frames[s]; print most}' \
    "$work/candump.out"
}

# The site of NODES drives on vcan0, each with the lines of standard input: many_drives NODES BUS-LINE… <LINES
many_drives() {
  local nodes=$1 node lines
  shift
  lines=$(cat)
  printf '[gateway]\nname = "line3"\n[modbus]\nlisten = ["127.0.0.1:%s"]\n[[bus]]\nname = "can0"\ninterface = "vcan0"\n' \
    "$modbus_port"
  printf '%s\n' "$@"
  for node in $(seq "$nodes"); do
    printf '[[drive]]\nname = "fan%s"\nnode = %s\n%s\n' "$node" "$node" "$lines"
  done
}

# What the gateway's log says, from drives being online on, of losses and alarms. lost PATTERN: but of the drives whose
# names match.
lost() {
  grep -Ev -- " ($1): " "$work/gateway.err" |
    awk '/: online/ {online[$3]} ($3 in online) && (/: offline/ || / active/) || / alarm boot active/'
}

# Simulated drives with a console: order NODE VERB … makes one misbehave.
start_drives() {
  [ -p "$work/orders" ] || mkfifo "$work/orders"
  exec 7<>"$work/orders"
  "$gateway_bin" simulate --interface "$interface" "$@" <"$work/orders" >"$work/simulate.out" 2>"$work/simulate.err" &
  started[simulate]=$!
  wait_until 10 "the simulator answers" grep -q simulated "$work/simulate.out"
}

# One of each system, as in gateway.toml.
start_four_drives() {
  start_drives --drive veichi-ac300:3 --drive veichi-ac310:5 --drive invt-goodrive600:7 --drive vacon-opte6:9
}

order() {
  local before
  before=$(wc -l <"$work/simulate.out")
  printf '%s\n' "$*" >&7
  wait_until 5 "the simulator takes '$*'" bash -c "[ \$(wc -l <'$work/simulate.out') -gt $before ]"
  tail -n +"$((before + 1))" "$work/simulate.out" | grep -q '^error' && fail "simulator: $*: $(tail -n 1 "$work/simulate.out")"
  return 0
}

# What a drive says of itself: show NODE NAME
drive_says() {
  local before
  before=$(wc -l <"$work/simulate.out")
  printf '%s show\n' "$1" >&7
  wait_until 5 "node $1 shows itself" bash -c "[ \$(wc -l <'$work/simulate.out') -gt $before ]"
  tail -n 1 "$work/simulate.out" | tr ' ' '\n' | sed -n "s/^$2=//p"
}

start_gateway() {
  launch gateway "$gateway_bin" run --config "$work/gateway.toml" --profile-dir "$root/config/profiles"
}

# read_register UNIT ADDRESS: the number, or mbpoll's words for the exception
read_register() {
  mbpoll -m tcp -p "$modbus_port" -a "$1" -0 -t 4 -r "$2" -1 -o 3 127.0.0.1 2>&1 |
    sed -n -e 's/^\[[0-9]*\]:[[:space:]]*\(-\{0,1\}[0-9]*\).*/\1/p' -e 's/.*failed: \(.*\)/\1/p'
}

# write_registers UNIT ADDRESS VALUE…: "written", or mbpoll's words for the exception
write_registers() {
  local unit=$1 address=$2
  shift 2
  mbpoll -m tcp -p "$modbus_port" -a "$unit" -0 -t 4 -r "$address" -1 -o 3 127.0.0.1 -- "$@" 2>&1 |
    sed -n -e 's/^Written.*/written/p' -e 's/.*failed: \(.*\)/\1/p'
}

# What the broker wants to know of those that look.
credentials=()

# retained TOPIC: what the broker keeps there
retained() { mosquitto_sub "${credentials[@]}" -h "$broker_host" -p "$broker_port" -C 1 -W 2 -t "$topics/$1" 2>/dev/null; }

# field TOPIC JQ-EXPRESSION: of a retained JSON
field() { retained "$1" | jq -r "$2"; }

# look HOST SECONDS: at all that the broker there keeps of the gateway; kept tells of it
look() {
  mosquitto_sub "${credentials[@]}" -h "$1" -p "$broker_port" -t "$topics/#" -W "$2" -F '%r %t %p' 2>/dev/null |
    sed -n "s|^1 $topics/||p" >"$work/$1.kept"
}
# kept HOST TOPIC [JQ-EXPRESSION]: a payload, or what the expression makes of its JSON
kept() {
  local payload
  payload=$(sed -n "s|^$2 ||p" "$work/$1.kept")
  if [ $# = 3 ]; then jq -r "$3" <<<"$payload"; else echo "$payload"; fi
}
# is_kept HOST TOPIC VALUE, or HOST TOPIC JQ-EXPRESSION VALUE
is_kept() { [ "$(kept "${@:1:$#-1}")" = "${!#}" ]; }

# The broker keeps nothing there. That it keeps the gateway's status shows that the question was answered.
is_emptied() {
  [ "$(mosquitto_sub -h "$broker_host" -p "$broker_port" -W 1 -F %t -t "$topics/status" -t "$1" 2>/dev/null)" = "$topics/status" ]
}

is_retained() { [ "$(retained "$1")" = "$2" ]; }
field_is() { [ "$(field "$1" "$2")" = "$3" ]; }
register_is() { [ "$(read_register "$1" "$2")" = "$3" ]; }

# ask TOPIC PAYLOAD: sends it with a response topic and prints the answer
ask() {
  mosquitto_rr -V 5 -h "$broker_host" -p "$broker_port" -W 5 -t "$topics/$1" -e "answers/$RANDOM$RANDOM" -m "$2"
}

# Modbus is asked all the while; what the test itself does meanwhile must cost little.
modbus_begin() {
  launch modbus "$(dirname "$gateway_bin")/../tests/system/modbus_latency" "$modbus_port" 5
}
modbus_end() { # modbus_end WHAT: $p99, $percent and $slowest, see modbus_latency.cpp
  local count bare
  kill "${started[modbus]}"
  wait "${started[modbus]}" || fail "Modbus did not answer"
  read -r count p99 bare percent slowest <"$work/modbus.out"
  say "Modbus, $1: $count reads, 99 % within $p99 µs, $percent % of a bare server's $bare µs; the slowest $slowest µs"
}
