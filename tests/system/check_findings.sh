#!/bin/bash
# `check` names every mistake of a file with line and column, and exits 78.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
out=$("${GATEWAY_BIN:?}" check --config "$root/tests/system/five_mistakes.toml" --profile-dir "$root/config/profiles")
code=$?
echo "$out"
[ "$code" = 78 ] || { echo "exit code $code, not 78"; exit 1; }
errors=$(grep -c ': error: ' <<<"$out")
[ "$errors" = 5 ] || { echo "$errors errors, not 5"; exit 1; }
diff <(grep -oE '^[^ ]*five_mistakes.toml:[0-9]+:[0-9]+: error' <<<"$out" | sed 's|.*/||') - <<'EXPECTED'
five_mistakes.toml:5:11: error
five_mistakes.toml:8:1: error
five_mistakes.toml:14:8: error
five_mistakes.toml:16:13: error
five_mistakes.toml:19:7: error
EXPECTED
