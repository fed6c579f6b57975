#include "tests/fault/kill_row.hpp"
#include "tests/fault/row.hpp"

#include <algorithm>

namespace scanloom::fault {
namespace {

constexpr Row kRows[] = {
    {"kill", "kills", 50, 1'000, "kill -9 of the server at random points while robots stream", run_kill_row},
};

} // namespace

std::span<const Row> rows() { return kRows; }

const Row* find_row(std::string_view name) {
    const auto found = std::ranges::find(kRows, name, &Row::name);
    return found == std::end(kRows) ? nullptr : found;
}

} // namespace scanloom::fault
