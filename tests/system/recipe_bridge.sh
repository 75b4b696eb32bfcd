#!/bin/bash
# docs/recipes/mosquitto-bridge.md as it stands: everything is at the far broker, with its expiry; nothing comes back, but
# what the page lets in; a link that was down leaves no old value and no late command; one that hangs delays a command as
# long as the page says and no longer. With an expiry of 6 s in place of 90 s. By recipe_run, in ctest -C long.
. "$(dirname "$0")/recipe_lib.sh"
broker_host=broker.plant.example
credentials=(-u dashboard -P change-me-2)
hosts broker.plant.example cloud.example
recipe mosquitto
recipe_do mosquitto Broker
recipe mosquitto-bridge
recipe_do mosquitto-bridge Elsewhere
recipe_do mosquitto-bridge "In the plant"
expect "who may read the bridge's password" "600 mosquitto" "$(stat -c '%a %U' "$site/etc/mosquitto/conf.d/bridge.conf")"
short_expiry 6
# Two viewers at a time, each by a user of its own.
sed -n 's/^user viewer/user second/p; /^topic read/p' "$site/etc/mosquitto/cloud-acl" >"$work/second.acl"
cat "$work/second.acl" >>"$site/etc/mosquitto/cloud-acl"
mosquitto_passwd -b "$site/etc/mosquitto/cloud-passwd" second change-me-second
# And one who publishes here beside the gateway.
printf '\nuser beside\ntopic write %s/#\n' "$topics" >>"$site/etc/mosquitto/acl"
mosquitto_passwd -b "$site/etc/mosquitto/passwd" beside change-me-beside
mkdir -p "$site/etc/mosquitto/certs"
"$root/scripts/test-ca" "$work/cloud" server cloud.example
install -m 644 "$work/cloud/ca.crt" "$site/etc/mosquitto/certs/cloud-ca.crt"
install -m 644 "$work/cloud/cloud.example.crt" "$site/etc/mosquitto/certs/cloud.crt"
install -m 600 -o mosquitto "$work/cloud/cloud.example.key" "$site/etc/mosquitto/certs/cloud.key"
# For less waiting, and over a line that can be cut.
sed -i 's/^restart_timeout .*/restart_timeout 1/; s/^address cloud.example:8883/address cloud.example:8884/' \
  "$site/etc/mosquitto/conf.d/bridge.conf"
line() {
  launch line /usr/bin/python3 -c '
import asyncio
async def copy(reader, writer):
    try:
        while data := await reader.read(65536):
            writer.write(data)
    except OSError:
        pass
    writer.close()
async def serve(reader, writer):
    far_reader, far_writer = await asyncio.open_connection("127.0.0.1", 8883)
    await asyncio.gather(copy(reader, far_writer), copy(far_reader, writer))
async def main():
    await (await asyncio.start_server(serve, "127.0.0.1", 8884)).serve_forever()
asyncio.run(main())'
}
line

# far USER PASSWORD COMMAND…: a client at the far broker
far() {
  local user=$1 password=$2 command=$3
  shift 3
  "$command" -V 5 -h cloud.example -p 8883 --cafile "$work/cloud/ca.crt" -u "$user" -P "$password" "$@"
}
# SECONDS-LEFT TOPIC PAYLOAD of what is kept there; 0 where it stays
kept_far() {
  far viewer change-me-6 mosquitto_sub -t 'canopen/#' -t 'links/#' --retained-only -W 2 -F '%E %t %p' 2>/dev/null |
    sed 's/^ /0 /'
}
far_has() { kept_far | grep -Eq "$1"; }
far_is_whole() {
  kept_far >"$work/far.kept"
  grep -Eq "^[1-9][0-9]* $topics/status online$" "$work/far.kept" &&
    grep -Eq "^[1-9][0-9]* $topics/pump1/status online$" "$work/far.kept" &&
    grep -Eq "^[1-9][0-9]* $topics/pump1/state .*\"online\":true" "$work/far.kept" &&
    grep -Eq "^0 $topics/pump1/alarm/emcy .*\"active\":true" "$work/far.kept" &&
    grep -Eq "^0 links/line3 1$" "$work/far.kept"
}

recipe_broker far cloud.conf
wait_until 10 "the far broker listens" bash -c "echo >/dev/tcp/cloud.example/8883"
recipe_broker mosquitto plant.conf bridge.conf
wait_until 10 "the broker listens" bash -c "echo >/dev/tcp/$broker_host/$broker_port"
recipe_gateway
recipe_drive
wait_until 15 "the drive is online" is_retained pump1/status online
order 5 fault 0x0005
wait_until 20 "the far broker has it all, live topics with their expiry" far_is_whole

say "nothing comes back"
refused "a viewer's command" far viewer change-me-6 mosquitto_pub -q 1 -t "$topics/pump1/set" -m '{}'
launch heard mosquitto_sub -u service -P change-me-4 -h "$broker_host" -t "$topics/+/set" -t "$topics/probe" -F '%t %p' -W 60
far line3-bridge change-me-5 mosquitto_pub -q 1 -t "$topics/pump1/set" -m '{"frequency_command":5.0}'
sleep 1
as beside change-me-beside mosquitto_pub -q 1 -t "$topics/probe" -m 1
wait_until 5 "the plant is heard" grep -q probe "$work/heard.out"
expect "commands that came over the bridge" "" "$(grep /set "$work/heard.out")"
ended heard

say "the plant is cut off: broker and gateway are gone"
kill -9 "${started[gateway]}" "${started[mosquitto]}"
wait "${started[gateway]}" "${started[mosquitto]}" 2>/dev/null
wait_until 10 "the far broker knows of the link" far_has '^0 links/line3 0$'
gone() { ! far_has 'status online$|"online":true|"fresh":true'; }
wait_until 20 "nothing there is said to live" gone
kept_far >"$work/far.kept"
expect_match "the alarm stays" "^0 $topics/pump1/alarm/emcy " "$(cat "$work/far.kept")"

say "commands from elsewhere, by the lines of the page"
further /etc/mosquitto/conf.d/bridge.conf
further /etc/mosquitto/cloud-acl
(cd "$work" && bash -euc "$(recipe_commands mosquitto-bridge "Commands from elsewhere")") || fail "the password"
kill -HUP "${started[far]}"
order 5 clear
recipe_broker mosquitto plant.conf bridge.conf
recipe_gateway
back() { far_has "^[1-9][0-9]* $topics/status online$" && far_has "^0 $topics/pump1/alarm/emcy .*\"active\":false"; }
wait_until 30 "the far broker has it all again" back
command='{"frequency_command":20.0,"torque_command":0.0,"control_command":"forward","id":"'
expect_match "a command from there is answered there" '"ok":true.*"id":"c1"' \
  "$(far remote change-me-9 mosquitto_rr -W 10 -q 1 -t "$topics/pump1/set" -e answers/cloud/1 -m "${command}c1\"}")"
refused "NMT from there" far remote change-me-9 mosquitto_pub -q 1 -t "$topics/pump1/nmt/set" -m stop

say "the line is cut while somebody there commands and values change here"
launch seen mosquitto_sub -V 5 -h cloud.example -p 8883 --cafile "$work/cloud/ca.crt" -u second -P change-me-second \
  -t "$topics/pump1/frequency_command/probe" -F %p -W 90
launch heard mosquitto_sub -V 5 -u service -P change-me-4 -h "$broker_host" -t "$topics/+/set" -F %p -W 180
ended line
wait_until 20 "the far broker knows it" far_has '^0 links/line3 0$'
far remote change-me-9 mosquitto_pub -q 1 -t "$topics/pump1/set" -m "${command}late\"}"
for value in 1 2 3 4 5; do
  as beside change-me-beside mosquitto_pub -q 1 -r -t "$topics/pump1/frequency_command/probe" -m $value
done
line
wait_until 30 "the line is back" far_has '^0 links/line3 1$'
wait_until 20 "so is the newest value" grep -qx 5 "$work/seen.out"
expect "what the far broker was told of it" 5 "$(cat "$work/seen.out")"
expect_match "the next one passes" '"ok":true.*"id":"c2"' \
  "$(far remote change-me-9 mosquitto_rr -W 10 -q 1 -t "$topics/pump1/set" -e answers/cloud/1 -m "${command}c2\"}")"
expect "what came over the bridge" "${command}c2\"}" "$(cat "$work/heard.out")"

say "the line hangs, and is not cut: shorter than the bridge needs to know it, a command comes late, whatever its expiry"
slow() { far remote change-me-9 mosquitto_pub -q 1 -t "$topics/pump1/set" -m "${command}$1\"}" -D publish message-expiry-interval 2; }
came() { grep -c "$1" "$work/heard.out"; }
kill -STOP "${started[line]}"
slow hung1
sleep 4
expect "commands meanwhile" 0 "$(came hung1)"
kill -CONT "${started[line]}"
wait_until 5 "it comes, 4 s after it was sent with an expiry of 2 s" grep -q hung1 "$work/heard.out"

say "longer than that: it is lost"
wait_until 15 "the link is up" far_has '^0 links/line3 1$'
link() { ss -Htnp state established 'dport = :8884' | awk '/"mosquitto"/ {print $3}'; }
before=$(link)
expect_match "the link" ':[0-9]+$' "$before"
kill -STOP "${started[line]}"
begun=$(date +%s%3N)
slow hung2
gave_up() { ! link | grep -qx "$before"; }
wait_until 30 "the plant's broker gives the link up" gave_up
expect_at_most "milliseconds until then, by the page 10 s" 11500 $(($(date +%s%3N) - begun))
sleep 2
kill -CONT "${started[line]}"
wait_until 30 "the link is up again" far_has '^0 links/line3 1$'
expect_match "the next one passes" '"ok":true.*"id":"c3"' \
  "$(far remote change-me-9 mosquitto_rr -W 10 -q 1 -t "$topics/pump1/set" -e answers/cloud/1 -m "${command}c3\"}")"
expect "what came of the one that hung" 0 "$(came hung2)"
