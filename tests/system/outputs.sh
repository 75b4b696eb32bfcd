#!/bin/bash
# What the program writes, and what becomes of it: output that fails, descriptors that are closed, lines on the journal.
# Needs neither CAN nor a broker.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
gateway=("${GATEWAY_BIN:?the canopen-gateway executable}" --profile-dir "$root/config/profiles")
work=$(mktemp -d) || exit 1
background=
trap '[ -z "$background" ] || kill "$background" 2>/dev/null; rm -rf "$work"' EXIT
cd "$work" || exit 1
unset JOURNAL_STREAM
failed=0
count=0

fail() {
  echo "FAILED: $*"
  sed 's/^/    /' err out 2>/dev/null
  failed=1
}
expect() {  # expect WHAT EXPECTED ACTUAL
  count=$((count + 1))
  [ "$2" = "$3" ] || fail "$1: expected '$2', got '$3'"
}
expect_lines() {  # expect_lines WHAT EXPECTED PATTERN FILE: so many lines match
  expect "$1" "$2" "$(grep -cE -- "$3" "$4")"
}

# wait_until WHAT COMMAND...: until it succeeds, for at most 20 s
wait_until() {
  local end=$((SECONDS + 20)) what=$1
  shift
  until "$@"; do
    [ $SECONDS -lt $end ] || { fail "not within 20 s: $what"; return 1; }
    sleep 0.05
  done
}

cat >good.toml <<'END'
[[bus]]
name = "can0"
interface = "virtual"
[[drive]]
name = "pump1"
node = 5
profile = "cia402-velocity"
END
sed -i "1i [gateway]\nstate_dir = \"$work/state\"" good.toml
sed 's/^node = 5/node = 300/' good.toml >wrong.toml
sed '$a[drive.commands]\nwriters = ["mqtt"]' good.toml >doubtful.toml
errors=$("${gateway[@]}" check --config wrong.toml | grep -c ': error: ')
expect "wrong.toml has an error" 1 "$errors"
expect_lines "doubtful.toml has warnings and no error" 1 '^ok: ' <("${gateway[@]}" check --config doubtful.toml)
expect "doubtful.toml has a warning" yes \
  "$("${gateway[@]}" check --config doubtful.toml | grep -q ': warning: ' && echo yes)"

# --- Output that fails: exit code 1 and one line.
mkfifo pipe
exec 8<>pipe 9>pipe 8>&-  # 9 is a pipe that nobody reads.
fails() {  # fails COMMAND...: with a full disk, then with a closed pipe
  timeout 30 "${gateway[@]}" "$@" >/dev/full 2>err </dev/null
  expect "$*, full disk: exit code" 1 $?
  expect_lines "$*, full disk: the reason" 1 '^canopen-gateway: standard output: No space left on device$' err
  timeout 30 "${gateway[@]}" "$@" >&9 2>err </dev/null
  expect "$*, closed pipe: exit code" 1 $?
  expect_lines "$*, closed pipe: the reason" 1 '^canopen-gateway: standard output: Broken pipe$' err
}
only_line() { expect_lines "$1: lines on standard error" 1 '' err; }

for command in --help --version "map --help" "check --config good.toml" "check --config wrong.toml" \
  "map --config good.toml" "map --config good.toml --format json"; do
  # shellcheck disable=SC2086
  fails $command
  only_line "$command"
done
fails demo --config good.toml
fails simulate --interface nosuchcan0 --drive veichi-ac310:5

# A line of input is answered on standard output; where that has failed meanwhile, the same.
mkfifo answers orders
exec 6<>orders
timeout 30 "${gateway[@]}" demo --config good.toml <orders >answers 2>err 9>&- &
background=$!
exec 7<answers
read -r -t 20 line <&7
expect_lines "demo begins with the page" 1 '^The page: http://127\.0\.0\.1:[0-9]+/$' <(echo "$line")
exec 7<&-
echo '5 show' >&6
wait $background
expect "demo, reader gone: exit code" 1 $?
background=
expect_lines "demo, reader gone: the reason" 1 '^canopen-gateway: standard output: Broken pipe$' err
exec 6>&- 9>&-

# --- Closed descriptors are /dev/null, and stay it.
"${gateway[@]}" check --config good.toml >&- 2>&- <&-
expect "check without descriptors: exit code" 0 $?
"${gateway[@]}" check --config wrong.toml >&- 2>&- <&-
expect "check of a wrong file without descriptors: exit code" 78 $?
is_under_way() { ls -l "/proc/$background/fd" 2>/dev/null | grep -q 'eventpoll'; }
"${gateway[@]}" demo --config good.toml <&- >&- 2>&- &
background=$!
if wait_until "the demo has its event loop" is_under_way; then
  for descriptor in 0 1 2; do
    expect "demo without descriptors: $descriptor" /dev/null "$(readlink "/proc/$background/fd/$descriptor")"
  done
fi
kill -TERM $background
wait $background
expect "demo without descriptors: exit code" 0 $?
background=

# --- On the journal, lines carry their priority. Here a file is the journal.
journal() {  # journal COMMAND...: standard error is the journal
  : >err
  JOURNAL_STREAM=$(stat -c %d:%i err) "${gateway[@]}" "$@" >out 2>err </dev/null
}
journal map --config wrong.toml
expect "map of a wrong file: exit code" 78 $?
expect_lines "errors begin with <3>" 1 '^<3>wrong\.toml:[0-9]+:[0-9]+: error: ' err
journal map --config doubtful.toml
expect_lines "warnings begin with <4>" "$(grep -c ': warning: ' err)" '^<4>doubtful\.toml:.*: warning: ' err
expect_lines "what is no journal has no priorities" 0 '^<' out
journal nonsense
expect_lines "wrong usage begins with <3>" "$(grep -c . err)" '^<3>' err
: >err
JOURNAL_STREAM=$(stat -c %d:%i err) "${gateway[@]}" check --config good.toml >/dev/full 2>err
expect_lines "a failure begins with <3>" 1 '^<3>canopen-gateway: standard output: ' err
: >out
JOURNAL_STREAM=$(stat -c %d:%i out) "${gateway[@]}" check --config doubtful.toml >out 2>err
expect_lines "check: warnings begin with <4>" "$(grep -c ': warning: ' out)" '^<4>' out
expect_lines "check: its last line has no priority" 1 '^ok: ' <(tail -n 1 out)
: >err
JOURNAL_STREAM=$(stat -c %d:%i good.toml) "${gateway[@]}" map --config wrong.toml >out 2>err
expect_lines "another file is the journal: no priority" 1 '^wrong\.toml:' err

# --- A demo of its own configuration says nothing of it, though `check` has something to say; of a site's it does.
# It ends by its output, or because its port is taken: after it has read the configuration in any case.
timeout 30 "${gateway[@]}" demo >/dev/full 2>err </dev/null
expect "demo: exit code" 1 $?
expect_lines "demo: no finding about itself" 0 ': (warning|error): ' err
timeout 30 "${gateway[@]}" demo --config doubtful.toml >/dev/full 2>err </dev/null
expect "demo of a site: its warnings" yes "$(grep -q 'doubtful\.toml:.*: warning: ' err && echo yes)"

# --- The daemon tells that nobody can be on a virtual bus, and outlives whoever reads its log.
"${gateway[@]}" run --config good.toml >out 2>err </dev/null &
background=$!
wait_until "the daemon serves" grep -q ' serves 1 bus' err
expect_lines "run: a virtual bus" 1 'warning +bus can0: .*virtual.*demo' err
kill -TERM $background
wait $background
expect "run: exit code" 0 $?
mkfifo log
"${gateway[@]}" run --config good.toml >out 2>log </dev/null &
background=$!
exec 7<log
read -r -t 20 _ <&7
exec 7<&-
kill -TERM $background  # It answers with lines on the log, which nobody reads any more.
wait $background
expect "run without a reader of its log: exit code" 0 $?
background=

# --- Whoever sees the first line may end it: findings that fill their pipe hold it between this line and its event loop.
{
  printf '[gateway]\nstate_dir = "%s/state"\n[mqtt]\n[[bus]]\nname = "can0"\ninterface = "virtual"\n' "$work"
  for node in {1..120}; do
    printf '[[drive]]\nname = "a-drive-with-a-long-name%s"\nnode = %s\nprofile = "cia402-velocity"\n' \
      "$node" "$node"
    printf '[drive.commands]\nwriters = ["mqtt", "modbus"]\n'
  done
} >many.toml
"${gateway[@]}" check --config many.toml >out 2>err
expect "many.toml has warnings and no error" "1 yes" \
  "$(grep -c '^ok: ' out) $([ "$(cat out err | wc -c)" -gt 70000 ] && echo yes)"  # a pipe holds 65536 bytes
ended_early() {  # ended_early COMMAND SIGNAL...: told by these signals when its first line is there
  local command=$1 signal
  shift
  "${gateway[@]}" "$command" --config many.toml >out 2>log </dev/null &
  background=$!
  exec 7<log
  read -r -t 20 _ <&7
  for signal; do kill "-$signal" $background; done
  cat <&7 >err
  wait $background
  expect "$command ended at its first line: exit code" 0 $?
  exec 7<&-
  background=
}
ended_early run HUP TERM
ended_early demo TERM

[ $failed = 0 ] && echo "passed, $count expectations"
exit $failed
