# The commands flakes and mutants of ./scanloom, which sources this file after tiers.sh: how good the tests are.

# run_flakes [--all] [--count N]
run_flakes() {
    local count=10 tier=first preset turn busy=() failures=$logs/flakes.failures
    while (($# > 0)); do
        case $1 in
            --all) tier=all ;;
            --count) count=${2:-} && shift && whole "$count" --count ;;
            *) misused "flakes takes no '$1'" ;;
        esac
        shift
    done
    ((count > 0)) || misused "--count is 0; at least 1 is needed"
    build_tier "$tier"
    [[ $tier == first ]] || for preset in "${core_presets[@]}"; do build_core "$preset"; done
    mkdir -p "$logs"
    : >"$failures"
    rm -f "$logs"/flakes-*-failed.log
    # Two busy loops: each test competes for its processor.
    for turn in 1 2; do
        (while :; do :; done) &
        busy+=($!)
    done
    # shellcheck disable=SC2064 # the ids are known now
    trap "kill ${busy[*]} 2>/dev/null || true" EXIT
    for ((turn = 1; turn <= count; ++turn)); do
        echo "== $turn of $count"
        list_failures test --label-exclude "$(labels_left_out "$tier")"
        [[ $tier == first ]] || for preset in "${core_presets[@]}"; do list_core_failures "$preset"; done
    done
    if [[ -s $failures ]]; then
        echo "failed, of $count times:"
        sort "$failures" | uniq --count
        fail "there are flaky tests; $logs/flakes-PRESET-failed.log is the output of the runs with failures"
    fi
    echo "no test failed in $count runs while two busy loops used the processors"
}

# list_core_failures PRESET
list_core_failures() {
    local options
    mapfile -t options < <(core_tests "$1")
    list_failures "$1" "${options[@]}"
}

# list_failures PRESET CTEST_OPTION...: runs tests; prints and keeps the names of those that fail.
list_failures() {
    local log=$logs/flakes-$1.log status=0
    ctest --preset "$1" --parallel "$tests_at_once" --no-tests=error "${@:2}" --quiet --output-log "$log" || status=$?
    ((status == 0 || status == 8)) || fail "ctest ended with code $status; $log is its output$(explain "$log")"
    ((status == 0)) && return
    cat "$log" >>"$logs/flakes-$1-failed.log"
    failed_tests "$log" | sed "s/^/$1: /" | tee -a "$failures"
}

# failed_tests LOG: the names of the tests that ctest lists as failed. It lists those that were skipped in the same form.
failed_tests() {
    sed -n -e '/ (Skipped)$/d' -e 's/^[\t ]*[0-9]* - \(.*\) (.*)$/\1/p' "$1"
}

# run_mutants [NAME] [--all]: each patch of tests/mutants breaks one place. The tests must fail with it, and pass without.
run_mutants() {
    local tier=() names=() only patches patch missed=() copy=$PWD/build/mutants
    while (($# > 0)); do
        case $1 in
            --all) tier=(--all) ;;
            -*) misused "mutants takes no '$1'" ;;
            *) names+=("$1") ;;
        esac
        shift
    done
    ((${#names[@]} < 2)) || misused "mutants takes one name, not '${names[*]}'"
    only=${names[*]}
    ((${#names[@]} == 0)) || [[ $only =~ ^[a-z0-9_]+$ && -f tests/mutants/$only.patch ]] || misused "tests/mutants has no mutant '$only'"
    patches=(tests/mutants/${only:-*}.patch)
    need test # git
    git rev-parse --git-dir >/dev/null 2>&1 || fail "mutants copies the files of a git clone, and $PWD is none; run it in a clone"
    mkdir -p "$logs" "$copy"
    copy_sources "$copy"
    echo "the tests without a mutant"
    mutant_fails "$copy" sources "${only:+$(hint_of "${patches[0]}")}" "${tier[@]}" &&
        fail "tests fail without a mutant; $logs/mutant-sources.log is their output"
    for patch in "${patches[@]}"; do
        patch --directory "$copy" --strip 1 --quiet --forward <"$patch" || fail "$patch does not apply to these sources; write it again"
        find_mutant "$copy" "$patch" "${tier[@]}" || missed+=("$(basename "$patch" .patch)")
        patch --directory "$copy" --strip 1 --quiet --reverse <"$patch"
    done
    echo "$((${#patches[@]} - ${#missed[@]})) of ${#patches[@]} mutants were found"
    ((${#missed[@]} == 0)) || fail "not found: ${missed[*]}"
}

# copy_sources FOLDER: makes its sources those of this checkout, without the mutants, which do not apply to themselves. Only
# files that differ are written, with a new time, so that sources that an interrupted run left with a mutant are compiled again.
copy_sources() {
    local file sources=$PWD
    rm -rf "$1/tests/mutants"
    git -c core.quotePath=false ls-files --cached --others --exclude-standard -- . ':!tests/mutants' | while read -r file; do
        [[ -f $file ]] || continue
        cmp --silent "$file" "$1/$file" && continue
        mkdir -p "$(dirname "$1/$file")"
        cp "$file" "$1/$file"
    done
    (cd "$1" && find . \( -path ./build -o -name node_modules \) -prune -o -type f -print) | while read -r file; do
        [[ -f $sources/$file ]] || rm "$1/$file"
    done
}

# hint_of PATCH: the test that its author expects to fail.
hint_of() { sed -n 's/^Test: //p' "$1"; }

# find_mutant COPY PATCH [--all]: whether the test that the patch names, or else one of the tier, fails.
find_mutant() {
    local name since=$SECONDS hint
    name=$(basename "$2" .patch) hint=$(hint_of "$2")
    if mutant_fails "$1" "$name" "$hint" "${@:3}"; then
        echo "found   $name ($hint, $((SECONDS - since)) s)"
    elif mutant_fails "$1" "$name" '' "${@:3}"; then
        echo "found   $name ($(failed_tests "$logs/mutant-$name.log" | head -n 1), $((SECONDS - since)) s)"
    else
        echo "MISSED  $name ($((SECONDS - since)) s)"
        return 1
    fi
}

# mutant_fails COPY NAME WORD [--all]: whether tests fail. A mutant that does not compile is no mutant.
mutant_fails() {
    local log=$PWD/$logs/mutant-$2.log status=0
    (cd "$1" && ./scanloom test "${@:4}" ${3:+"$3"}) >"$log" 2>&1 || status=$?
    ((status == 0 || status == failing_tests)) ||
        fail "the tests of $2 could not be run; the end of $log: $(tail -n 3 "$log")$(explain "$log")"
    ((status == failing_tests))
}
