# The commands bench and pictures of ./scanloom, which sources this file.

quick='' # --quick, for the scripts of the benchmarks

# run_bench [PART | FILTER [LOG]] [--quick]
run_bench() {
    local what='' arguments=() most=1 log=''
    while (($# > 0)); do
        case $1 in
            --quick) quick=--quick ;;
            -*) misused "bench takes no '$1'" ;;
            *) arguments+=("$1") ;;
        esac
        shift
    done
    set -- "${arguments[@]}"
    what=${1:-all}
    case $what in
        robot | tiles | localization) most=2 ;;
        all | projection | service | scaling | viewer | planning | tile_changes | kernel | link | sim | store | wire) ;;
        *[!A-Za-z_]*) ;; # an expression, which only the programs can check
        *) grep --quiet "$what" tests/bench/{,projection/}*.cpp || no_such_benchmark "$what" ;;
    esac
    (($# <= most)) || misused "bench $what takes no '${*:most+1:1}'"
    [[ $what != robot && $# -lt 2 ]] || log=$(file_of "${2:-}")
    case $what in
        viewer | robot) in_browser "tests/bench/${what}_bench.mjs" ${log:+"$log"} $quick && return ;;
    esac
    need build bench
    make_preset bench scanloom-server scanloom-robot scanloom-load benches
    case $what in
        all)
            bench_programs
            for what in projection service scaling tiles localization store; do bench_report "$what"; done
            in_browser tests/bench/viewer_bench.mjs $quick
            ;;
        projection | service | scaling | tiles | localization) bench_report "$what" ${log:+"$log"} ;;
        store) bench_program store && bench_report store ;;
        planning | tile_changes | kernel | link | sim | wire) bench_program "$what" ;;
        *) bench_programs "$what" ;;
    esac
}

# bench_programs [FILTER]: runs the programs with matching benchmarks; without a filter, those that no script runs.
bench_programs() {
    local program found=''
    for program in build/bench/*_bench; do
        [[ -z ${1:-} && $program == */@(projection|scaling|localization)_bench ]] && continue
        [[ -z ${1:-} || -n $("$program" --benchmark_list_tests --benchmark_filter="$1" 2>/dev/null) ]] || continue
        found=yes
        bench_program "$(basename "$program" _bench)" ${1:+--benchmark_filter="$1"}
    done
    [[ -n $found ]] || no_such_benchmark "${1:-}"
}

no_such_benchmark() { misused "no part of the benchmarks and no benchmark matches '$1'"; }

# bench_program NAME [OPTION...]
bench_program() {
    echo "$1: $([[ -n $quick ]] && echo "takes seconds as a quick run: its figures are not reliable" || echo "takes up to two minutes")"
    "build/bench/$1_bench" ${quick:+--benchmark_min_time=0.01} "${@:2}"
}

# bench_report NAME [LOG]
bench_report() {
    local arguments=("tests/bench/$1_bench.mjs" "build/bench/$1_bench" "build/bench/$1.json")
    case $1 in
        projection) arguments[0]=tests/bench/projection_report.mjs ;;
        service) arguments[1]=build/bench/link_bench ;;
        scaling) arguments+=(build/bench/scaling.svg) ;;
        tiles | store) unset 'arguments[1]' ;;
    esac
    SCANLOOM_BIN_DIR=build/bin node "${arguments[@]}" "${@:2}" $quick
}

# run_pictures LOG [DIRECTORY [SONAR]]
run_pictures() {
    local log
    (($# > 0 && $# <= 3)) || misused "pictures needs a log: ./scanloom pictures LOG [DIRECTORY [SONAR]]"
    log=$(file_of "$1")
    in_browser docs/pictures/make.mjs "$log" "$(path_of "${2:-$PWD/docs/pictures}")" ${3:+"$(path_of "$3")"}
}

# in_browser SCRIPT ARGUMENTS...: runs a script with node and Debian's Chromium.
in_browser() {
    need build test
    make_preset test "${programs[@]}" e2e_packages
    SCANLOOM_WEB_DIR=build/web SCANLOOM_BIN_DIR=build/bin SCANLOOM_PICTURE_DIR=build/e2e \
        node "$@" 2>"$logs/browser.log" || fail "$1 failed; see $logs/browser.log"
}
