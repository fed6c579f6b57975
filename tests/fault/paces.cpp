#include "tests/fault/paces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::fault {
namespace {

/// Returns nullopt if a value is missing, as the median of the others would be that of a different run.
std::optional<double> median(Paces::Figures figures) {
    if (figures.empty() || !std::ranges::all_of(figures, [](const auto& figure) { return figure.has_value(); })) {
        return std::nullopt;
    }
    std::ranges::sort(figures);
    return figures[figures.size() / 2];
}

void tell(const char* name, std::optional<double> milliseconds, Outcome& outcome) {
    if (milliseconds) outcome.figures[name] = static_cast<std::uint64_t>(std::llround(*milliseconds * 1e3));
}

} // namespace

void check_paces(const Paces& paces, bool must_keep_up, Outcome& outcome) {
    const auto alone = median(paces.alone);
    const auto in_peace = median(paces.in_peace);
    const auto beside = median(paces.beside);
    tell("p99_alone_us", alone, outcome);
    tell("p99_in_peace_us", in_peace, outcome);
    tell("p99_beside_us", beside, outcome);
    if (!in_peace || !beside || (!alone && !paces.alone.empty())) {
        outcome.amiss.emplace_back("not every round tells how soon its robots were acknowledged");
        return;
    }
    if (!must_keep_up || *beside <= 2.0 * *in_peace) return;
    outcome.amiss.push_back(
        fmt::format("acknowledgements took {:.1f} ms (p99) beside the crowd, {:.1f} ms in peace", *beside, *in_peace));
}

} // namespace scanloom::fault
