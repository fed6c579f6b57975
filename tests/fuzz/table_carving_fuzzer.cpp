#include "server/store/record.hpp"
#include "server/store/table_carving.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>

namespace {

/// The positions of the found values in the table.
std::set<const char*> places_of_values(std::string_view table) {
    namespace store = scanloom::store;
    using scanloom::fuzz::check;
    std::set<const char*> places;
    store::carve_table(table, [&](std::string_view key, std::string_view value) {
        check(store::unsealed(key, value).has_value(), "each found value is intact");
        check(store::session_of(key) || store::revision_of(key), "each found value is a record or an entry");
        check(value.data() >= table.data() && value.data() + value.size() <= table.data() + table.size(),
              "each found value is in the table");
        check(!places.contains(value.data()), "each value is found once");
        places.insert(value.data());
    });
    return places;
}

} // namespace

/// Input: a damaged table file.
SCANLOOM_FUZZER(table_carving)(const std::uint8_t* data, std::size_t size) {
    const std::string_view table(reinterpret_cast<const char*>(data), size);
    for (const auto session : scanloom::store::sessions_removed_in(table)) {
        scanloom::fuzz::check(table.find(scanloom::store::session_key(session).back()) != std::string_view::npos,
                              "removed parts are reported");
    }
    const auto places = places_of_values(table);
    if (places.empty()) return 0;
    const auto up_to_last = static_cast<std::size_t>(*places.rbegin() - table.data());
    for (const auto* place : places_of_values(table.substr(0, up_to_last))) {
        scanloom::fuzz::check(places.contains(place), "appended bytes do not change the values before them");
    }
    return 0;
}
