# The commands fmt and tidy of ./scanloom, which sources this file: format and common mistakes.

# run_fmt [--check] [FILE...]
run_fmt() {
    local cpp_mode=(-i) web_mode=(--write) files=()
    [[ ${1:-} != --check ]] || { cpp_mode=(--dry-run -Werror) && web_mode=() && shift; }
    choose_files fmt "$@"
    need fmt
    ends_with 'cpp|hpp' | xargs --no-run-if-empty --delimiter '\n' clang-format-14 "${cpp_mode[@]}"
    web_tool format "${web_mode[@]}"
}

readonly tidied=(common core server sim robot_client lab load) # folders that clang-tidy reads

# run_tidy [FILE...]
run_tidy() {
    local files=() file sources=()
    choose_files tidy "$@"
    web_tool lint
    while read -r file; do
        if is_tidied "$file"; then sources+=("$file"); else echo "not checked: $file (clang-tidy reads only the folders ${tidied[*]})"; fi
    done < <((($# == 0)) || ends_with 'cpp|hpp')
    (($# > 0 && ${#sources[@]} == 0)) || tidy_cpp "${sources[@]}"
}

# is_tidied FILE: whether clang-tidy reads it.
is_tidied() { [[ " ${tidied[*]} " == *" ${1%%/*} "* ]]; }

# choose_files COMMAND [FILE...]: sets `files` to their paths from here, or to all files of the repository.
choose_files() {
    local file
    if (($# == 1)); then
        need fmt # git
        git rev-parse --git-dir >/dev/null 2>&1 || fail "$1 lists the files of a git clone, and $PWD is none; name the files to check"
        mapfile -t files < <(git -c core.quotePath=false ls-files --cached --others --exclude-standard --deduplicate |
            while read -r file; do [[ ! -f $file ]] || echo "$file"; done)
    fi
    for file in "${@:2}"; do
        [[ $file != -* ]] || misused "$1 takes no '$file'"
        file=$(file_of "$file")
        files+=("$(realpath --relative-to=. "$file")")
    done
}

# ends_with ENDING|ENDING...: the names in `files` with one of these endings.
ends_with() { printf '%s\n' "${files[@]}" | grep --extended-regexp "\.($1)\$" || true; }

# web_tool COMMAND [OPTION...]: Biome over the TypeScript, JavaScript and style sheets among `files`.
web_tool() {
    local packages=tests/e2e
    need fmt
    [[ $packages/node_modules/.package-lock.json -nt $packages/package-lock.json ]] ||
        step "npm packages of $packages" npm ci --prefix "$packages" --no-audit --no-fund
    ends_with 'ts|js|mjs|css' | xargs --no-run-if-empty --delimiter '\n' \
        "$packages/node_modules/.bin/biome" "$@" --no-errors-on-unmatched
}

# tidy_cpp [FILE...]: runs clang-tidy over these files, or all. The sources of a folder are joined, so the others are read, too.
tidy_cpp() {
    need build fmt tidy
    make_preset tidy scanloom_proto_sources scanloom_scene_proto_sources
    sources_of_tidy "$@" | xargs --no-run-if-empty --max-args 1 --max-procs "$(nproc)" \
        clang-tidy-14 -p build/tidy --quiet 2> >(grep -v 'warnings\? generated' >&2)
}

# compiled_folder FILE: its folder; for a header in a folder without sources, the folder of a source that includes it, or '.'.
compiled_folder() {
    local sources
    mapfile -t sources < <(compgen -G "${1%/*}/*.cpp" ||
        git grep --files-with-matches --fixed-strings "#include \"$1\"" -- "${tidied[@]/%//*.cpp}" || echo ./all)
    echo "${sources[0]%/*}"
}

# sources_of_tidy [FILE...]: the translation units of build/tidy with sources of these files' folders, or all of ours.
sources_of_tidy() {
    local unit folder folders
    mapfile -t folders < <(for unit in "$@"; do compiled_folder "$unit"; done | sort -u)
    sed -n 's/^  "file": "\(.*\)".*/\1/p' build/tidy/compile_commands.json | sort -u | while read -r unit; do
        unit=${unit#"$PWD/"}
        is_tidied "${unit#build/tidy/}" || continue
        if (($# == 0)); then
            echo "$unit"
            continue
        fi
        for folder in "${folders[@]}"; do
            # A unity file includes sources by their paths; others are sources.
            [[ $folder != . && ${unit%/*} != "$folder" ]] && ! grep --quiet "/$folder/[^/]*\"\$" "$unit" || { echo "$unit" && break; }
        done
    done
}
