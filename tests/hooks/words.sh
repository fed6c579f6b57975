#!/usr/bin/env bash
# Finds words of words.txt in the lines that a change adds to comments, texts and documents.
# usage: words.sh [--cached | COMMIT]        (--cached: the changes of the next commit, the default)
set -euo pipefail
cd "$(git rev-parse --show-toplevel)"

found=$(git -c core.quotePath=false -c diff.noprefix=false -c diff.mnemonicPrefix=false diff --no-ext-diff --no-color --unified=0 "${1:---cached}" -- '*.cpp' '*.hpp' '*.ts' '*.mjs' '*.py' '*.yaml' '*.md' '*.proto' scanloom '*.sh' ':!tests/hooks' |
    awk '
        FNR == NR { if ($0 !~ /^#/ && NF > 0) { split($0, part, /  +/); instead[part[1]] = part[2] } next }
        /^\+\+\+ b\// { file = substr($0, 7); next }
        /^\+#include/ { next } # the name of a file
        # Comments and strings of sources, every line of documents and of YAML.
        /^\+/ && (file ~ /\.(md|yaml)$/ || /\/\/|["\047]|^\+ *#|^\+ *\*/) {
            line = tolower(substr($0, 2))
            gsub(/ground truth/, "", line)
            for (word in instead)
                if (match(line, "(^|[^a-z_])" word "([^a-z_]|$)"))
                    print file ": \"" word "\" (better: " instead[word] "): " substr($0, 2, 100)
        }' tests/hooks/words.txt -)
[[ -z $found ]] && exit 0
echo "$found" >&2
echo "words.sh: these words are not plain technical English; git commit --no-verify skips this check" >&2
exit 1
