#include "server/store/record.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <cstdint>

/// Input: the length of a key, the key, and its value with a checksum, as in a damaged table.
SCANLOOM_FUZZER(store_key)(const std::uint8_t* data, std::size_t size) {
    namespace store = scanloom::store;
    using scanloom::fuzz::check;
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    const auto key = bytes.substr(0, std::min<std::size_t>(data[0], bytes.size()));
    const auto value = bytes.substr(key.size());

    if (const auto session = store::session_of(key)) {
        check(store::session_key(*session) == key, "a session's key contains only its id");
        check(store::owner_of(key) == session, "a session owns its record");
    }
    if (const auto revision = store::revision_of(key)) {
        check(store::entry_key(store::owner_of(key).value(), *revision) == key,
              "an entry's key contains only its session and revision");
    }
    if (const auto part = store::part_of(key)) {
        check(store::part_key(store::owner_of(key).value(), *part) == key,
              "a part's key contains only its session and number");
    }
    if (const auto number = store::number_of(value)) {
        check(store::number_bytes(*number) == value, "an encoded number is unchanged");
    }
    if (const auto inside = store::unsealed(key, value)) {
        check(store::sealed(key, std::string(*inside)) == value, "a value has exactly one checksum");
    }
    const auto sealed = store::sealed(key, std::string(value));
    check(store::unsealed(key, sealed) == value, "a sealed value can be unsealed");
    return 0;
}
