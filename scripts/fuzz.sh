#!/usr/bin/env bash
# Fuzzes everything that reads what strangers wrote; ends with a table.
#
#   scripts/fuzz.sh SECONDS [TARGET...]   so long each target, two at a time; all targets by default
#
# What the corpora grow by is kept in build/fuzz/corpus, inputs that fail go to build/fuzz/findings.
# build/fuzz/runs has a line for each run of a target on that corpus: its CPU seconds and executions;
# the table's last columns sum them. Fails when there is a finding. FUZZ_HANG (10) is how many seconds
# one input may take by the clock: more where the machine is busy with other things. FUZZ_SEED makes
# runs from the same corpus alike, but not equal: what an input is seen to cover differs a little each
# time.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:?usage: scripts/fuzz.sh SECONDS [TARGET...]}
shift
build=build/fuzz
shared=../shared/scenes

cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzz_targets >&2
mkdir -p "$build"/{corpus,findings,logs}
touch "$build/runs"
"$build/bin/fuzz_write_seeds" "$build/seeds"
if [ $# -eq 0 ]; then
  mapfile -t targets < <(sed -n 's/^add_fuzz_target(\([a-z_]*\).*/\1/p' fuzz/CMakeLists.txt)
  set -- "${targets[@]}"
fi

longest() {  # bytes of an input
  case $1 in
    meshopt) echo 1024 ;;
    checkpoint) echo 65536 ;;
    glb | gltf | http) echo 8192 ;;
    *) echo 4096 ;;
  esac
}

fuzz() {  # TARGET
  local target=$1 dir places=() options=()
  local seeds="$build/logs/$target.seeds"
  mkdir -p "$build/corpus/$target" "$build/findings/$target"
  for dir in "fuzz/seeds/$target" "fuzz/regressions/$target" "$build/seeds/$target"; do
    [ ! -d "$dir" ] || places+=("$dir")
  done
  # Files of other people's, where they are: only those of the target's own kind are of use.
  case $target in
    obj | mtl | gltf | glb)
      local others="$build/shared-seeds/$target"
      mkdir -p "$others"
      [ ! -d "$shared" ] || find "$shared"/{obj-samples,gltf-samples,bad} -name "*.$target" \
        -size -9k -exec cp -n --no-preserve=mode {} "$others" \;
      places+=("$others")
      ;;
  esac
  [ ! -f "fuzz/dictionaries/$target.dict" ] || options+=("-dict=fuzz/dictionaries/$target.dict")
  # By name, as folders list their files differently from machine to machine.
  find "${places[@]}" -type f ! -name '*,*' | LC_ALL=C sort | paste -sd, | tr -d '\n' >"$seeds"
  local TIMEFORMAT='%U %S'
  { time "$build/bin/fuzz_$target" -seed="${FUZZ_SEED:-0}" -max_total_time="$seconds" \
    -timeout="${FUZZ_HANG:-10}" -rss_limit_mb=2048 \
    -max_len="$(longest "$target")" -print_final_stats=1 -report_slow_units=5 -close_fd_mask=1 \
    -artifact_prefix="$build/findings/$target/" "${options[@]}" -seed_inputs="@$seeds" \
    "$build/corpus/$target" >"$build/logs/$target" 2>&1 || true; } 2>"$build/logs/$target.cpu"
  echo "$target $(executions "$target") $(<"$build/logs/$target.cpu")" |
    awk 'NF == 4 {printf "%s %d %.0f\n", $1, $2, $3 + $4}' >>"$build/runs"
}

executions() {  # TARGET
  sed -n 's/^stat::number_of_executed_units: *//p' "$build/logs/$1"
}

so_far() {  # TARGET, or '' for all
  awk -v target="$1" 'target == "" || $1 == target {runs += $2; cpu += $3}
    END {printf "%d | %d", runs, cpu}' "$build/runs"
}

report() {
  echo "| target | executions | per second | edges | features | inputs kept | findings | executions so far | CPU seconds so far |"
  echo "|---|--:|--:|--:|--:|--:|--:|--:|--:|"
  local target sum=0 failed=0
  for target in "$@"; do
    local log="$build/logs/$target" last runs rate found
    last=$(grep -aE '^#[0-9]+.* cov: ' "$log" | tail -n 1 || true)
    runs=$(executions "$target")
    rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
    found=$(find "$build/findings/$target" -type f ! -name 'slow-unit-*' -newer "$started" | wc -l)
    # A target that ended without its statistics has not run.
    if [ -z "$runs" ] || [ "$found" -gt 0 ]; then
      failed=1
      { echo "$target:" && tail -n 40 "$log"; } >&2
    fi
    number() { sed -n "s/.* $1: *\([0-9]*\).*/\1/p" <<<"$last"; }
    echo "| $target | ${runs:--} | ${rate:--} | $(number cov) | $(number ft) | $(number corp) | $found | $(so_far "$target") |"
    sum=$((sum + ${runs:-0}))
  done
  echo "| all | $sum | | | | | | $(so_far '') |"
  return "$failed"
}

started=$(mktemp)
trap 'rm -f "$started"' EXIT
export build shared seconds
export -f fuzz longest executions
printf '%s\0' "$@" | xargs -0 -P 2 -n 1 bash -c 'fuzz "$1"' fuzz
report "$@"
