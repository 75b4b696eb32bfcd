#!/bin/bash
# Every function of Modbus with every boundary, byte for byte, at a gateway with one drive of each system, one by the
# book and one that is not there; then pymodbus, modbus-serial and mbpoll as independent clients. docs/MODBUS.md shows
# what was answered. Nothing of it may move a motor. Run inside tests/vcan/run. Python is Debian's: pymodbus is there.
#   --write-table   puts the table into docs/MODBUS.md (with -w docs)
. "$(dirname "$0")/lib.sh"
here=$root/tests/system
manual=$root/docs/MODBUS.md
client_modules=$root/build/npm/node_modules  # by install-npm

sed -e 's/^listen = .*/&\nflat_unit = 100/' -e 's/^node = 9/&\nflat = 0/' -e 's/^node = 3/&\nflat = 3000/' \
  -e 's/^node = 5/&\nflat = 4000/' -e 's/^node = 7/&\nflat = 64536/' "$here/gateway.toml" >"$work/gateway.toml"
cat >>"$work/gateway.toml" <<'END'

[[drive]]
name = "mill1"
node = 11
profile = "cia402-velocity"
flat = 7000

[drive.commands]
writers = ["modbus"]
raw = true

[drive.signals.ramp_speed]
object = "0x6048:01"
type = "u32"
access = "read-write"
address = 300

[drive.signals.ramp_as_float]
object = "0x6049:01"
type = "u32"
scale = 0.1
as = "float"
access = "read-write"
address = 302

[drive.signals.guard_factor]
object = "0x100D:00"
type = "bool"
access = "read-write"
address = 400

[[drive]]
name = "gone1"
node = 12
profile = "cia402-velocity"
flat = 8000

[drive.commands]
writers = ["modbus"]
END

start_broker
start_trace
start_gateway
wait_until 10 "the gateway serves" grep -q ' serves ' "$work/gateway.err"
start_drives --drive veichi-ac300:3 --drive veichi-ac310:5 --drive invt-goodrive600:7 --drive vacon-opte6:9 \
  --drive cia402-velocity:11
wait_until 10 "all five drives online" register_is 0 2 5
"$gateway_bin" map --config "$work/gateway.toml" --profile-dir "$root/config/profiles" --format json >"$work/map.json"

say "every function, every boundary"
mark
/usr/bin/python3 "$here/modbus_conformance.py" 127.0.0.1 "$modbus_port" "$work/map.json" "$here/modbus/site.json" \
  --table "$work/table" >"$work/conformance.err" || fail "the conformance run disagrees"
say "$(tail -n 1 "$work/conformance.err")"
expect_match "as many requests as there have to be" '^1[45][0-9]{3} requests, 0 disagreements' \
  "$(tail -n 1 "$work/conformance.err")"

say "what was refused told no drive anything"
# Of all those writes no frame may be on the bus but what modbus/site.json allows: a control command that stops,
# set-points, and of the drive by the book its objects and an NMT start where it is started.
allowed=' 205#0500| 605#2B3020020500| 20B#0600| 60B#2B4060000600|'
allowed+=' 000#010B| 60[35]#2B302001| 607#2B002103| 609#2B426000|'
allowed+=' 60B#(2F0D1000|23486001|23496001|21002F00|[01]|2BFF5F00|2F001000)'
catch_up
expect "no other command" "" "$(frames "$nmt|$(commands_to 3579BC)" | grep -Ev -- "$allowed")"

say "the manual's table is what was answered"
if [ "${1-}" = --write-table ]; then
  sed -i -e "/^<!-- what the conformance run was answered -->/,/^<!-- end of it -->/{//!d}" \
    -e "/^<!-- what the conformance run was answered -->/r $work/table" "$manual"
fi
told=$(sed -n '/^<!-- what the conformance run was answered -->/,/^<!-- end of it -->/p' "$manual" | sed '1d;$d')
diff <(echo "$told") "$work/table" >"$work/table.err" || fail "docs/MODBUS.md shows another table; see --write-table"
checks=$((checks + 1))

say "a client of functions 43/13 and 43/14 alone"
mei() { /usr/bin/python3 "$here/mei_client.py" 127.0.0.1 "$modbus_port" "$@" 2>&1; }
expect "an object is written" "2f00:00 written" "$(mei 11 write-object 2f00:0 7465787420776974682036342063686172)"
expect "and read back" "2f00:00 17 bytes: 74 65 78 74 20 77 69 74 68 20 36 34 20 63 68 61 72" \
  "$(mei 11 read-object 2f00:0)"
expect "a part of it, by the gateway's unit" "2f00:00 4 bytes: 77 69 74 68" "$(mei 0 read-object 2f00:0 5 4 --node 11)"
expect "by the flat unit" "6048:01 4 bytes: 04 00 03 00" "$(mei 100 read-object 6048:1 --node 11)"
expect_match "identification" '^object 0x06: line3/hoist1$' "$(mei 7 identification)"

say "pymodbus, modbus-serial, mbpoll"
expected="coil on 1
input off 0
single 500
wide 0 700
masked 263
read and written 0
as many as go 125
not writable 2
no such address 2
half 2
refused 4
nobody 10
identified; canopen-gateway; cia402-velocity; CANopen node 11 of bus can0; line3/mill1; mill1; cia402-velocity"
expect "pymodbus" "$expected" "$("$here/modbus/with_pymodbus.py" "$modbus_port" 11 77 2>&1)"
poll() { # UNIT TYPE ADDRESS COUNT
  mbpoll -m tcp -p "$modbus_port" -a "$1" -0 -t "$2" -r "$3" -c "$4" -1 -o 3 127.0.0.1 2>&1 |
    sed -n -e 's/^\[[0-9]*\]:[[:space:]]*\(.*[^[:space:]]\)[[:space:]]*$/\1/p' -e 's/.*failed: \(.*\)/\1/p' |
    paste -sd ' '
}
expect "mbpoll writes" "written written" "$(write_registers 11 300 0 900) $(write_registers 11 103 0)"
expect "holding registers" "0 900" "$(poll 11 4 300 2)"
expect "input registers" "0 900" "$(poll 11 3 300 2)"
expect "coils and inputs" "0 0" "$(poll 11 0 400 1) $(poll 11 1 400 1)"
expect "the same on the flat unit" "0 900" "$(poll 100 4 7300 2)"
expect "refused" "Illegal data address" "$(write_registers 11 0 1)"
expect "a drive that is not there" "Target device failed to respond" "$(poll 12 4 0 1)"
expect "who is not there" "Gateway path unavailable" "$(poll 77 4 0 1)"

[ -d "$client_modules/modbus-serial" ] || fail "modbus-serial is not installed: tests/system/install-npm modbus npm"
expect "modbus-serial" "$expected" \
  "$(NODE_PATH=$client_modules node "$here/modbus/with_modbus_serial.js" "$modbus_port" 11 77 2>&1)"
