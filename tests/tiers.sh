# The commands test, flakes and mutants of ./scanloom, which sources this file.

# run_test [FILTER | --all [FILTER] | --nightly | --sanitizers [--core]]
run_test() {
    local targets=(tests) excluded='^(all|nightly)$' filter=''
    case ${1:-} in
        --sanitizers)
            run_sanitizers "${@:2}"
            return
            ;;
        --nightly)
            (($# == 1)) || misused "test --nightly takes no '$2'"
            run_nightly
            return
            ;;
        --all)
            targets=(tests_all "${programs[@]}") excluded='^nightly$'
            shift
            ;;
    esac
    if (($# > 0)); then
        filter=$1
        (($# == 1)) && [[ $filter =~ ^[A-Za-z0-9_./]+$ ]] ||
            misused "test takes one word that is part of a test's name, not '$*'"
    fi
    need build test
    [[ ${targets[0]} == tests ]] || need fault package
    make_preset test "${targets[@]}"
    if [[ -n $filter ]]; then
        run_filtered "$filter" "$excluded"
    else
        ctest --preset test --parallel "$(nproc)" --label-exclude "$excluded"
    fi
}

# run_filtered WORD EXCLUDED_LABELS: the cases of test programs, and the other tests, whose names contain WORD.
run_filtered() {
    local word=$1 program cases status failed='' found='' of_tier=(core memory server http robot system)
    [[ $2 == *all* ]] || of_tier+=(tools faults)
    for program in "${of_tier[@]}"; do
        cases=$("build/tests/${program}_test" --gtest_list_tests --gtest_filter="*$word*" | grep -c '^  ' || true)
        ((cases > 0)) || continue
        found=yes
        echo "${program}_test: $cases tests"
        status=0
        timeout --foreground 600 "build/tests/${program}_test" --gtest_filter="*$word*" --gtest_brief=1 || status=$?
        ((status != 124)) || echo "${program}_test was stopped: it had not ended after 600 s"
        ((status == 0)) || failed=yes
    done
    if ctest --preset test --show-only --label-exclude "$2|^suite$" --tests-regex "$word" | grep --quiet ' Test *#'; then
        found=yes
        ctest --preset test --label-exclude "$2|^suite$" --tests-regex "$word" || failed=yes
    fi
    [[ -n $found ]] || misused "no test's name contains '$word' (--all has more tests)"
    [[ -z $failed ]] || fail "tests failed; the lines above say which"
}

# run_sanitizers [--core]: the suites of test under both sanitizers. --core: memory errors where the bytes of strangers
# arrive, races where the threads of sessions, store and links meet.
run_sanitizers() {
    (($# == 0)) || [[ $* == --core ]] || misused "test --sanitizers takes no '$*'"
    need build test
    if (($# == 0)); then
        sanitize asan-ubsan tests --label-regex '^suite$'
        sanitize tsan tests --label-regex '^suite$'
    else
        for_core sanitize
    fi
}

# for_core COMMAND: COMMAND PRESET TARGET CTEST_OPTION... for the server's core.
for_core() {
    "$1" asan-core http_test --label-regex '^http_test$'
    "$1" tsan server_test --label-regex '^server_test$' --exclude-regex Salvage # one thread reads a damaged store
}

# sanitize PRESET TARGET CTEST_OPTION...
sanitize() {
    make_preset "$1" "$2"
    ctest --preset "$1" --parallel "$(nproc)" "${@:3}"
}

# run_nightly: all tests, and whatever takes hours or looks at the sources in another way.
run_nightly() {
    need build test fault package
    make_preset test tests_nightly "${programs[@]}"
    ctest --preset test --parallel "$(nproc)" --label-exclude '^nightly$'
    ctest --preset test --label-regex '^nightly$' # they compare speeds: one at a time
    fmt --check
    tidy
    run_sanitizers
    fuzz
    make_preset dev   # every source by itself: each includes what it needs
    make_preset clang # and with another compiler
    run_mutants --all
    tests/system/bare_system.sh
    tests/system/docker_images.sh
}

# run_flakes [--all] [--count N]
run_flakes() {
    local count=10 all='' turn busy=() failures=build/log/flakes.failures
    while (($# > 0)); do
        case $1 in
            --all) all=yes ;;
            --count) count=${2:-} && shift && whole "$count" --count ;;
            *) misused "flakes takes no '$1'" ;;
        esac
        shift
    done
    need build test
    if [[ -n $all ]]; then
        need fault package
        make_preset test tests_all "${programs[@]}"
        for_core make_preset_only
    else
        make_preset test tests
    fi
    : >"$failures"
    # Two busy loops: each test competes for its processor.
    for turn in 1 2; do
        (while :; do :; done) &
        busy+=($!)
    done
    # shellcheck disable=SC2064 # the ids are known now
    trap "kill ${busy[*]} 2>/dev/null || true" EXIT
    for ((turn = 1; turn <= count; ++turn)); do
        echo "== $turn of $count"
        list_failures test - --label-exclude "^($([[ -n $all ]] || echo 'all|')nightly)\$"
        [[ -z $all ]] || for_core list_failures
    done
    if [[ -s $failures ]]; then
        echo "failed, of $count times:"
        sort "$failures" | uniq --count
        fail "there are flaky tests; build/log/flakes-PRESET.log is the output of the last run"
    fi
    echo "no test failed in $count runs with two busy loops beside them"
}

make_preset_only() { make_preset "$1" "$2"; }

# list_failures PRESET TARGET CTEST_OPTION...: runs tests; prints and keeps the names of those that fail.
list_failures() {
    ctest --preset "$1" --parallel "$(nproc)" "${@:3}" --quiet --output-log "build/log/flakes-$1.log" ||
        failed_tests "build/log/flakes-$1.log" | sed "s/^/$1: /" | tee -a "$failures"
}

# failed_tests LOG: the names of the tests that ctest lists as failed.
failed_tests() {
    sed -n 's/^[\t ]*[0-9]* - \(.*\) (.*)$/\1/p' "$1"
}

# run_mutants [NAME] [--all]: each patch of tests/mutants breaks one place. The tests must fail with it.
run_mutants() {
    local tier=() only='' patches patch missed=()
    while (($# > 0)); do
        case $1 in
            --all) tier=(--all) ;;
            -*) misused "mutants takes no '$1'" ;;
            *) only=$1 ;;
        esac
        shift
    done
    patches=(tests/mutants/${only:-*}.patch)
    [[ -f ${patches[0]} ]] || misused "there is no mutant '$only', only $(cd tests/mutants && echo *.patch)"
    local copy=$PWD/build/mutants file
    # Only files that differ, and with a new time: so what an interrupted run left broken is compiled again.
    git ls-files | while read -r file; do
        cmp --silent "$file" "$copy/$file" && continue
        mkdir -p "$(dirname "$copy/$file")"
        cp "$file" "$copy/$file"
    done
    for patch in "${patches[@]}"; do
        patch --directory "$copy" --strip 1 --quiet --forward <"$patch" || fail "$patch does not apply any more; make it again"
        find_mutant "$copy" "$patch" "${tier[@]}" || missed+=("$(basename "$patch" .patch)")
        patch --directory "$copy" --strip 1 --quiet --reverse <"$patch"
    done
    echo "$((${#patches[@]} - ${#missed[@]})) of ${#patches[@]} mutants were found"
    ((${#missed[@]} == 0)) || fail "not found: ${missed[*]}"
}

# find_mutant COPY PATCH [--all]: whether the tests that the patch names, or else all of the tier, fail. A mutant that does not
# compile is no mutant.
find_mutant() {
    local log name since=$SECONDS hint
    name=$(basename "$2" .patch) log=$PWD/$logs/mutant-$(basename "$2" .patch).log
    hint=$(sed -n 's/^Test: //p' "$2")
    mkdir -p "$logs"
    (cd "$1" && ./scanloom test NoTestHasThisName) >"$log" 2>&1 || grep --quiet "no test's name contains" "$log" ||
        fail "$name does not compile; the end of $log: $(tail -n 3 "$log")"
    if [[ -n $hint ]] && ! (cd "$1" && ./scanloom test "$hint") >>"$log" 2>&1; then
        echo "found   $name ($hint, $((SECONDS - since)) s)"
    elif ! (cd "$1" && ./scanloom test "${@:3}") >>"$log" 2>&1; then
        echo "found   $name ($(failed_tests "$log" | head -n 1), $((SECONDS - since)) s)"
    else
        echo "MISSED  $name ($((SECONDS - since)) s)"
        return 1
    fi
}
