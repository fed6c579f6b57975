# The command test of ./scanloom, which sources this file.

readonly no_tests=2 failing_tests=3 # exit codes: no test has the name; tests ran and failed
readonly tests_at_once=$(($(nproc) + 1)) # many wait for a browser or a process

# run_test [[--all | --nightly] [WORD] | --changed COMMIT | --sanitizers [--core]]
run_test() {
    local tier=first filter=''
    case ${1:-} in
        --sanitizers)
            run_sanitizers "${@:2}"
            return
            ;;
        --changed)
            run_changed "${@:2}"
            return
            ;;
    esac
    local words=()
    while (($# > 0)); do
        case $1 in
            --all) tier=all ;;
            --nightly) tier=nightly ;;
            -*) misused "test takes no '$1'" ;;
            *) words+=("$1") ;;
        esac
        shift
    done
    if ((${#words[@]} > 0)); then
        filter=${words[0]}
        ((${#words[@]} == 1)) && [[ $filter =~ ^[A-Za-z0-9_./+]*[A-Za-z0-9_][A-Za-z0-9_./+]*$ ]] ||
            misused "test takes one word that is part of a test's name, not '${words[*]}'"
        occurs "$filter" || no_test "$filter" "$tier"
    fi
    if [[ -n $filter ]]; then
        build_tier "$tier"
        run_filtered "$filter" "$tier"
    elif [[ $tier == nightly ]]; then
        run_nightly
    else
        build_tier "$tier"
        run_ctest test --label-exclude "$(labels_left_out "$tier")"
        [[ $tier == first ]] || run_images
    fi
}

# occurs WORD: whether the sources, or the names of their files, contain each part of WORD. If they do not, no test has this name, and
# nothing needs to be built to know that. So that this holds, the names of parameters join their parts by '_', '/' or digits.
occurs() {
    local part parts
    IFS='._/+0123456789' read -ra parts <<<"$1"
    for part in "${parts[@]}"; do
        grep --quiet --no-messages --recursive --fixed-strings --exclude-dir={node_modules,data,script} \
            --include='*.'{cmake,cpp,def,hpp,mjs,py,sh,ts} --include=CMakeLists.txt -e "$part" \
            -- cmake common core lab load proto robot_client server sim tests web ||
            [[ -n $(find tests -name "*$part*" -print -quit) ]] || return 1
    done
}

# no_test WORD first|all|nightly
no_test() {
    echo "scanloom: no test's name contains '$1'$([[ $2 != first ]] || echo ' (--all and --nightly have more tests)')" >&2
    exit "$no_tests"
}

# build_tier first|ci|all|nightly
build_tier() {
    need build test
    case $1 in
        first) make_preset test tests ;;
        *)
            need fault package tidy readers ros
            unpack ros-unpacked build/ros
            make_preset test "tests_$1"
            ;;
    esac
}

# labels_left_out first|ci|all|nightly: the labels of the tests that are not run.
labels_left_out() {
    case $1 in
        first) echo '^(all|nightly)$' ;;
        ci) echo '^(http_test|recovery_test|server_test|nightly)$' ;;
        all) echo '^nightly$' ;;
        nightly) echo '^$' ;;
    esac
}

# run_ctest PRESET OPTION...: runs tests, then lists the skipped ones with the reason.
run_ctest() {
    local status=0 skipped
    ctest --preset "$1" --parallel "$tests_at_once" --no-tests=error "${@:2}" || status=$?
    skipped=$(grep --no-filename --after-context 1 ': Skipped$' "$(folder_of "$1")"/Testing/Temporary/LastTest.log 2>/dev/null |
        grep --invert-match -e ': Skipped$' -e '^--$' | sort | uniq --count || true)
    [[ -z $skipped ]] || printf 'Tests that were skipped, by reason:\n%s\n' "$skipped"
    ((status != 8)) || tests_failed # ctest's code for failing tests
    ((status == 0)) || fail "ctest ended with code $status$(explain /dev/null)"
}

tests_failed() {
    echo "scanloom: tests failed; the lines above name them$(explain /dev/null)" >&2
    exit "$failing_tests"
}

# run_filtered WORD first|all|nightly: the cases of test programs, and the other tests, whose names contain WORD. PROGRAM.SUITE+SUITE,
# the name of a CTest test, stands for the cases of that program whose names contain one of these words.
run_filtered() {
    local word=$1 program cases status others filter failed='' found='' of_tier=(core maps memory server recovery http robot system)
    if [[ $2 != first ]]; then
        of_tier+=(tools faults)
        [[ $2 == all ]] || of_tier+=(nightly)
    fi
    program=${word%%.*}
    if [[ $word == *.* && " ${of_tier[*]} " == *" $program "* ]]; then
        of_tier=("$program")
        word=${word#*.}
    fi
    filter="*${word//+/*:*}*"
    if [[ $2 == first && $word != *Trials* ]]; then
        filter+='-*Trials/*:*Trials.*' # many random cases
    fi
    for program in "${of_tier[@]}"; do
        cases=$("build/tests/${program}_test" --gtest_list_tests --gtest_filter="$filter") ||
            fail "build/tests/${program}_test does not list its tests"
        cases=$(grep --count '^  ' <<<"$cases" || true)
        ((cases > 0)) || continue
        found=yes
        echo "${program}_test: $cases tests"
        status=0
        timeout --foreground 1800 "build/tests/${program}_test" --gtest_filter="$filter" --gtest_brief=1 || status=$?
        ((status != 124)) || echo "${program}_test was stopped: it had not ended after 1800 s"
        ((status == 0)) || failed=yes
    done
    others=(--label-exclude "$(labels_left_out "$2")|^suite\$" --tests-regex "${1//+/[+]}")
    cases=$(ctest --preset test --show-only "${others[@]}")
    if [[ $cases == *' Test '*'#'* ]]; then
        found=yes
        ctest --preset test "${others[@]}" || failed=yes
    fi
    [[ -n $found ]] || no_test "$1" "$2"
    [[ -z $failed ]] || tests_failed
}

# Rows of 'PATTERN;FILES': the tests of --all whose names match PATTERN run if one of FILES, or of the files that all parts depend
# on, changed. '^e2e_([^l]|l[^i])' matches all browser tests but e2e_live, which is in tier 1.
readonly files_of_all_parts=(CMakeLists.txt CMakePresets.json cmake)
readonly parts_of_all=(
    '^tools[.];common/link common/net core/landmarks core/scan_matching core/slam lab load robot_client/uplink sim tests/CMakeLists.txt tests/integration/lab tests/integration/load tests/support tests/unit/lab tests/unit/load'
    '^faults[.];common/link common/net common/wire load robot_client server/app server/ingest server/sessions server/sockets server/store tests/CMakeLists.txt tests/fault tests/integration/robot_client tests/support'
    '^robot[.].*Trials(/|$);robot_client/recordings robot_client/spool sim tests/CMakeLists.txt tests/readers tests/support tests/unit/robot_client/recordings tests/unit/robot_client/spool tests/unit/sim'
    '^system[.].*Trials(/|$);common/link common/net robot_client server/app server/http server/sessions server/store tests/CMakeLists.txt tests/fault tests/integration tests/support'
    '^e2e_([^l]|l[^i]);common/wire/live.cpp proto/scanloom/v1/live.proto server/auth server/http server/live server/tiles tests/e2e web'
    '^ros_bridge_;robot_client/python robot_client/ros_bridge server/http/handlers/maps.cpp tests/integration/robot_client'
    '^python_client_;common/link common/wire proto robot_client/python server/ingest tests/integration/robot_client/python'
    '^observability_;tests/integration/robot_client/python docs/observability server/http/handlers/system.cpp server/metrics tests/integration/observability'
    '^openapi_;tests/e2e/environment.mjs tests/e2e/programs.mjs server/http/openapi.cpp server/http/openapi.py server/http/openapi.yaml server/http/routes.cpp tests/openapi'
    '^lidar_judges$;tests/e2e/environment.mjs tests/e2e/programs.mjs robot_client/lidars robot_client/sources tests/readers tests/support/lidar_emulator.cpp tests/support/lidar_emulators.cpp'
    '^bridges$;tests/e2e/environment.mjs tests/e2e/programs.mjs robot_client/foxglove robot_client/ros tests/bridges'
    '^readers$;tests/e2e/environment.mjs tests/e2e/programs.mjs server/exchange server/http server/tiles tests/readers'
    '^package$;docker packages.txt packaging robot_client/client robot_client/package robot_client/ros_bridge scanloom server/app tests/package web/package.json web/package-lock.json'
    '^api_pages$;common core docs/api packaging/api_pages.sh robot_client/client tests/package'
    '^bench_chart$;tests/bench/report'
)

# run_changed COMMIT: tier 1 without http_test, recovery_test and server_test, which .ci/run runs with sanitizers, and the parts of
# --all whose files differ from those of that commit. All other programs of --all are compiled. The Trials of core_test, maps_test and the
# programs that run with sanitizers are left out; most of them have a short form, which runs.
run_changed() {
    (($# == 1)) && git rev-parse --quiet --verify "$1^{commit}" >/dev/null 2>&1 ||
        misused "test --changed takes a commit of the git clone it runs in, not '$*'"
    local part tests files left_out=('^(core|maps)[.].*Trials(/|$)')
    for part in "${parts_of_all[@]}"; do
        IFS=';' read -r tests files <<<"$part"
        read -ra files <<<"$files"
        ! git diff --quiet "$1" -- "${files_of_all_parts[@]}" "${files[@]}" || left_out+=("$tests")
    done
    build_tier ci
    run_ctest test --label-exclude "$(labels_left_out ci)" --exclude-regex "$(IFS='|' && echo "${left_out[*]}")"
    echo "http_test, recovery_test and server_test were not run; ./scanloom test --sanitizers --core runs them"
}

# run_images: builds the images of docker/ and starts them, where that is possible without an engine.
run_images() {
    if [[ -e .git ]] && ((EUID == 0)) && command -v buildah >/dev/null && command -v debootstrap >/dev/null; then
        tests/system/docker_images.sh
    else
        echo "The images of docker/ were not built: that needs a clone, root, buildah and debootstrap (./scanloom install system)."
    fi
}

# run_sanitizers [--core]: the suites of tier 1 and those named Trials under AddressSanitizer and UBSan, then those of programs with
# threads under ThreadSanitizer. --core: only the server's core (maps, sessions, store, robot connections, HTTP); under
# ThreadSanitizer only server_test.
run_sanitizers() {
    local part=sanitize_all presets=(asan-ubsan tsan) preset status=0
    if (($# > 0)); then
        [[ $* == --core ]] || misused "test --sanitizers takes no '$*'"
        part=sanitize_core presets=("${core_presets[@]}")
    fi
    need build test
    for preset in "${presets[@]}"; do
        ("$part" "$preset") || status=$? # the other sanitizer may find more
        ((status == 0 || status == failing_tests)) || exit "$status"
    done
    return "$status"
}

# sanitize_all PRESET
sanitize_all() {
    local options=(--label-regex '^suite$' --exclude-regex '^(tools|faults|nightly)[.]') targets=(tests)
    [[ $1 != tsan ]] || { options+=(--label-exclude '^one_thread$') && targets=({http,robot,server,system}_test); }
    make_preset "$1" "${targets[@]}"
    run_ctest "$1" "${options[@]}"
}

readonly core_presets=(asan-core tsan)

# core_programs PRESET: the test programs of the server's core that this preset builds, one a line.
core_programs() { [[ $1 == tsan ]] || printf '%s\n' http_test maps_test recovery_test && echo server_test; }

# build_core PRESET
build_core() {
    local programs_of_core
    mapfile -t programs_of_core < <(core_programs "$1")
    make_preset "$1" "${programs_of_core[@]}"
}

# sanitize_core PRESET
sanitize_core() {
    local options
    mapfile -t options < <(core_tests "$1")
    build_core "$1"
    run_ctest "$1" "${options[@]}"
}

# core_tests PRESET: the options of ctest for the suites of these programs, one a line.
core_tests() {
    # Suites in which one thread uses a store; --nightly also runs them with ThreadSanitizer.
    [[ $1 != tsan ]] || printf '%s\n' --exclude-regex 'CopyLog|DamagedStore|TableStore|KilledStore'
    printf '%s\n' --label-regex "^($(core_programs "$1" | paste --serial --delimiters '|'))\$" --label-exclude '^(all|nightly)$'
}

# run_nightly: all tests, sanitizers, fuzzers, mutants, other builds and systems. It goes on after a part that fails, and names
# all of these at its end.
run_nightly() {
    local failed=()
    ((EUID == 0)) || fail "test --nightly makes bare systems and images, which needs root; run it as root"
    need fmt fuzz bench system large_readers
    build_tier nightly
    nightly_part run_ctest test --label-exclude '^nightly$'
    nightly_part run_ctest test --parallel 1 --label-regex '^nightly$' # they compare speeds: one at a time
    nightly_part ./scanloom fmt --check
    nightly_part ./scanloom tidy
    nightly_part ./scanloom test --sanitizers
    nightly_part ./scanloom fuzz
    nightly_part make_preset dev   # every source by itself: each includes what it needs
    nightly_part make_preset clang # and with another compiler
    nightly_part make_preset bench benches
    nightly_part make_preset robot
    nightly_part ./scanloom mutants --all
    nightly_part tests/system/bare_system.sh
    nightly_part tests/system/docker_images.sh
    nightly_part tests/system/robot_build.sh
    nightly_part tests/system/other_processors.sh
    ((${#failed[@]} == 0)) || fail "failed: $(printf '%s; ' "${failed[@]}")"
}

# nightly_part COMMAND...
nightly_part() {
    echo "== $*"
    ("$@") || failed+=("$*")
}
