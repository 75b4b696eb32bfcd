# Shared by the tests of recipes: they run the text of the pages in docs/recipes. Its files are laid below $site in place of
# /; names of hosts are those of the page.
. "$(dirname "${BASH_SOURCE[0]}")/lib.sh"
site=$work/site
interface=can0
chmod 711 "$work" # mosquitto becomes a user of its own

# hosts NAME…: names of this machine, in here only
hosts() {
  {
    cat /etc/hosts
    printf '127.0.0.1 %s\n' "$@"
  } >"$work/hosts"
  mount --bind "$work/hosts" /etc/hosts || fail "no names for the brokers"
}

# mqtt_of SNIPPET FILE: FILE with the table [mqtt] of SNIPPET in place of its own
mqtt_of() {
  awk -v snippet="$1" '
    /^\[/ {inside = $0 == "[mqtt]"; if (inside) {while ((getline line < snippet) > 0) print line; print ""}}
    !inside' "$2"
}

# recipe PAGE: lays its files, and adds parts to files of earlier pages. Further lines of a file of the same page are for
# later: further FILE.
recipe() {
  local names name whole
  names=$("$root/tests/system/recipe_files.py" "$root/docs/recipes/$1.md" "$site") || fail "$1: no files"
  for name in $names; do
    sed -i "s,/etc/,$site/etc/,g; s,/var/,$site/var/,g" "$site$name"
    whole=$site${name%.*}
    case $name in
      *.further) grep -qx "${name%.*}" <<<"$names" || further "${name%.*}" ;;
      *.mqtt) mqtt_of "$site$name" "$whole" >"$whole.new" && mv "$whole.new" "$whole" ;;
    esac
  done
}

further() { cat "$site$1.further" >>"$site$1"; }

# recipe_commands PAGE HEADING: the commands below it, for here. What mosquitto_passwd asks for stands behind it on the page.
recipe_commands() {
  "$root/tests/system/recipe_files.py" "$root/docs/recipes/$1.md" --sh "$2" |
    sed -e "s,/etc/,$site/etc/,g; s,scripts/test-ca,$root/scripts/test-ca,g; s/-o canopen-gateway/-o root/" \
      -e 's/^mosquitto_passwd \([^ -][^ ]*\) \([^ ]*\)  *# asks: /mosquitto_passwd -b \1 \2 /'
}
recipe_do() {
  (cd "$work" && bash -euc "$(recipe_commands "$@")") >"$work/commands.out" 2>"$work/commands.err" ||
    fail "commands of $1, '$2'"
}

# recipe_broker NAME FILE…: a mosquitto with these files of $site/etc/mosquitto/conf.d
recipe_broker() {
  local name=$1 file
  shift
  for file; do cat "$site/etc/mosquitto/conf.d/$file"; done >"$work/$name.conf"
  launch "$name" mosquitto -c "$work/$name.conf"
}

# short_expiry SECONDS: in place of the pages' 90
short_expiry() {
  sed -i "s/^expiry = \"90s\" .*/expiry = \"$1s\"/" "$site/etc/canopen-gateway/gateway.toml"
  grep -q "^expiry = \"$1s\"" "$site/etc/canopen-gateway/gateway.toml" || fail "the page has no expiry of 90 s"
}

# listens: the plant's broker does
listens() { wait_until 10 "the broker listens" bash -c "echo >/dev/tcp/$broker_host/$broker_port"; }

# ended NAME: ends it in order and waits
ended() {
  kill "${started[$1]}"
  wait "${started[$1]}" 2>/dev/null
  unset "started[$1]"
}

# The gateway, started in the background, and its drive: on the bus of the pages where there is CAN; else the two in one
# process, see one_process.cpp.
gateway_command() { exec "$gateway_bin" "$1" --config "$site/etc/canopen-gateway/gateway.toml" --profile-dir "$root/config/profiles"; }
if [ -e /sys/class/net/vcan0 ]; then
  recipe_gateway() { launch gateway gateway_command run; }
  recipe_drive() {
    ip link add can0 type vcan && ip link set can0 up || fail "no can0"
    start_drives --drive veichi-ac310:5
  }
else
  leave_nothing=1 # no machine of our own goes with it
  recipe_gateway() {
    [ -p "$work/orders" ] || mkfifo "$work/orders"
    exec 7<>"$work/orders"
    "$(dirname "$gateway_bin")/../tests/system/one_process" "$site/etc/canopen-gateway/gateway.toml" "$root/config/profiles" \
      "$work/plant" <"$work/orders" >"$work/simulate.out" 2>"$work/gateway.err" &
    started[gateway]=$!
  }
  recipe_drive() { :; }
  order() { printf '%s\n' "$*" >&7; }
  drive_says() {
    printf '%s show\n' "$1" >&7
    sleep 0.5
    grep "node=$1 " "$work/simulate.out" | tail -n 1 | tr ' ' '\n' | sed -n "s/^$2=//p"
  }
fi
runs_at() { [ "$(drive_says 5 frequency)" = "$1" ]; }

# as USER PASSWORD COMMAND…: a mosquitto client as this user of the broker
as() {
  local user=$1 password=$2 command=$3
  shift 3
  "$command" -h "$broker_host" -p "$broker_port" -u "$user" -P "$password" "$@"
}
# refused WHAT COMMAND…: the broker says that it may not; granted: it says nothing
refused() {
  local what=$1
  shift
  expect_match "$what" '[Nn]ot authori[sz]ed' "$("$@" 2>&1)"
}
granted() {
  local what=$1
  shift
  expect "$what" "" "$("$@" 2>&1)"
}
