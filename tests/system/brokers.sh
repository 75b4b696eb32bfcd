#!/bin/bash
# Two brokers, the first over TLS with certificates for both sides. It freezes, and the second is in use within 10 s and
# holds the truth; the first says offline by the will. The second is killed, and the first is in use within 10 s. Run
# inside tests/vcan/run.
. "$(dirname "$0")/lib.sh"

# Of an authority of this run alone.
authority() {
  local name=$1
  openssl req -new -newkey rsa:2048 -nodes -keyout "$work/$name.key" -out "$work/$name.csr" -subj "/CN=$name" 2>/dev/null &&
    openssl x509 -req -in "$work/$name.csr" -CA "$work/ca.crt" -CAkey "$work/ca.key" -CAcreateserial -days 1 \
      -extfile <(printf 'subjectAltName=DNS:%s' "$name") -out "$work/$name.crt" 2>/dev/null || fail "no certificate of $name"
}
openssl req -x509 -newkey rsa:2048 -nodes -keyout "$work/ca.key" -out "$work/ca.crt" -days 1 -subj /CN=ca 2>/dev/null
authority localhost
authority line3

# broker NAME LINES…: a mosquitto with this configuration
broker() {
  local name=$1
  shift
  printf '%s\n' "$@" "user root" "allow_anonymous true" >"$work/$name.conf"
  launch "$name" mosquitto -c "$work/$name.conf"
}
start_first() {
  broker first "per_listener_settings true" "listener 1884 127.0.0.1" "allow_anonymous true" \
    "listener 8883 127.0.0.1" "cafile $work/ca.crt" "certfile $work/localhost.crt" \
    "keyfile $work/localhost.key" "require_certificate true"
  wait_until 10 "the first listens" bash -c 'echo >/dev/tcp/127.0.0.1/8883 && echo >/dev/tcp/127.0.0.1/1884'
}
start_second() {
  broker second "listener 1883 127.0.0.1"
  wait_until 10 "the second listens" bash -c 'echo >/dev/tcp/127.0.0.1/1883'
}
at() { # at first|second: which one is looked at
  broker_port=$([ "$1" = first ] && echo 1884 || echo 1883)
}
tree() { mosquitto_sub -h 127.0.0.1 -p "$broker_port" -t "$topics/#" --retained-only -W 1 -F %t 2>/dev/null | sort; }
# All that the plant is, by what the broker keeps.
is_true() {
  look 127.0.0.1 1
  is_kept 127.0.0.1 status online && is_kept 127.0.0.1 pump1/status online &&
    is_kept 127.0.0.1 pump1/state .online true && is_kept 127.0.0.1 health .drives_online 4 &&
    is_kept 127.0.0.1 fan1/alarm/emcy .active "$1"
}
# in_use_within_10_s BEGUN: at the broker that is looked at
in_use_within_10_s() {
  wait_until 12 "online there" is_retained status online
  local took=$(($(date +%s%3N) - $1))
  say "online there after $took ms, the look included"
  expect_at_most "ms until the other broker is in use" 10000 "$took"
}

sed -e "/^\[gateway\]/a state_dir = \"$work/state\"" \
  -e '/^brokers/c brokers = ["mqtts://localhost:8883", "mqtt://127.0.0.1:1883"]' \
  -e "/^\[mqtt\]/a ca_file = \"ca.crt\"\ncert_file = \"line3.crt\"\nkey_file = \"line3.key\"" \
  "$root/tests/system/gateway.toml" >"$work/gateway.toml"
start_first
start_second
start_gateway
start_four_drives
wait_until 10 "all four drives online" register_is 0 2 4
at first
wait_until 10 "everything is true at the first" is_true false
all=$(tree)
expect_match "the log" "connected to localhost:8883, MQTT 5, TLS" "$(grep 'connected to' "$work/gateway.err")"

say "the first freezes"
begun=$(date +%s%3N)
kill -STOP "${started[first]}"
order 3 fault 0x0006
at second
in_use_within_10_s "$begun"
wait_until 5 "everything is true at the second, and new" is_true true
expect "the topics at the second" "$all" "$(tree)"
expect_match "health tells why" "^localhost:8883: " "$(field health .last_break)"
kill -CONT "${started[first]}"
at first
wait_until 10 "the will says so at the first" is_retained status offline

say "the second is killed"
begun=$(date +%s%3N)
kill -9 "${started[second]}"
wait "${started[second]}" 2>/dev/null
in_use_within_10_s "$begun"
wait_until 5 "everything is true at the first" is_true true
expect "the topics at the first" "$all" "$(tree)"
