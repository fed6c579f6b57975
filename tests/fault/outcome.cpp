#include "tests/fault/outcome.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>

#include <algorithm>
#include <iterator>

namespace scanloom::fault {

void Outcome::add(Outcome part) {
    acknowledged += part.acknowledged;
    lost += part.lost;
    twice += part.twice;
    digest_equal = digest_equal && part.digest_equal;
    std::ranges::move(part.failures, std::back_inserter(failures));
    for (const auto& [name, count] : part.figures) figures[name] += count;
    if (!repeat) repeat = std::move(part.repeat);
    if (!skipped) skipped = std::move(part.skipped);
}

std::string json_line(std::string_view row, std::uint64_t seed, std::uint64_t count, double seconds,
                      const Outcome& outcome) {
    boost::json::object line{{"row", row},
                             {"seed", seed},
                             {"count", count},
                             {"acknowledged", outcome.acknowledged},
                             {"lost", outcome.lost},
                             {"twice", outcome.twice},
                             {"digest_equal", outcome.digest_equal},
                             {"seconds", seconds}};
    for (const auto& [name, figure] : outcome.figures) line[name] = figure;
    if (outcome.skipped) line["skipped"] = *outcome.skipped;
    if (!outcome.failures.empty()) {
        line["failures"] = boost::json::array(outcome.failures.begin(), outcome.failures.end());
        if (outcome.repeat) line["repeat"] = *outcome.repeat;
    }
    return boost::json::serialize(line);
}

} // namespace scanloom::fault
