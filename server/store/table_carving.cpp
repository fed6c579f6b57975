#include "server/store/table_carving.hpp"

#include "server/store/record.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::store {
namespace {

constexpr std::size_t kTailBytes = 8; // type and sequence at the end of a key
constexpr std::size_t kRecordKeyBytes = 9;
constexpr std::size_t kEntryKeyBytes = 17;
constexpr std::size_t kValueBytesMax = std::size_t{4} << 20; // a scan has at most 1 MiB, a part of an imported map less
constexpr std::uint64_t kRow = 256;                          // keys that differ in their last byte only
constexpr char kRemoval = 0;
constexpr char kValue = 1;

/// Removes a number from the front of `bytes`.
std::optional<std::uint32_t> varint32(std::string_view& bytes) {
    std::uint32_t number = 0;
    for (unsigned shift = 0; shift < 32 && !bytes.empty(); shift += 7) {
        const auto byte = static_cast<unsigned char>(bytes.front());
        bytes.remove_prefix(1);
        number |= std::uint32_t{byte & 0x7Fu} << shift;
        if ((byte & 0x80) == 0) return number;
    }
    return std::nullopt;
}

/// A possible entry of a table.
struct Found {
    std::size_t shared = 0;    // length of the prefix that its key shares with the previous key
    std::string_view key_rest; // with its tail
    std::string_view value;
};

std::optional<Found> read_one(std::string_view bytes) {
    const auto shared = varint32(bytes);
    const auto rest = shared ? varint32(bytes) : std::nullopt;
    const auto length = rest ? varint32(bytes) : std::nullopt;
    if (!length || *rest < kTailBytes || *rest > bytes.size() || *length > bytes.size() - *rest) return std::nullopt;
    return Found{*shared, bytes.substr(0, *rest), bytes.substr(*rest, *length)};
}

/// Length of the key without its tail.
std::size_t key_bytes_of(const Found& found) { return found.shared + found.key_rest.size() - kTailBytes; }

/// Returns the whole key without its tail if it is a record's or an entry's key.
std::optional<std::string> key_of(const Found& found, std::string_view before) {
    if (found.shared > before.size()) return std::nullopt;
    std::string key(before.substr(0, found.shared));
    key.append(found.key_rest.substr(0, found.key_rest.size() - kTailBytes));
    if (!session_of(key) && !revision_of(key)) return std::nullopt;
    return key;
}

/// Returns keys whose prefixes occur near this one: in its row of 256 keys, the adjacent rows, the next session's
/// entries, and the records.
std::array<std::string, 5> keys_near(const std::string& key) {
    const auto revision = revision_of(key);
    if (!revision) {
        const auto session = *session_of(key);
        return {key, session_key(session + kRow), session_key(session < kRow ? 0 : session - kRow)};
    }
    const auto session = *owner_of(key);
    return {key, entry_key(session, *revision + kRow), entry_key(session, *revision < kRow ? 0 : *revision - kRow),
            entry_key(session + 1, 0), session_key(0)};
}

class Carving {
public:
    explicit Carving(const VisitCarved& visit) : visit_(visit) {}

    /// @return whether the entry is intact; an entry whose key is not known yet may be accepted later
    bool take(const Found& found) {
        const auto key_bytes = key_bytes_of(found); // checked before copying: noise may claim any length
        if (key_bytes != kRecordKeyBytes && key_bytes != kEntryKeyBytes) return false;
        const char type = found.key_rest[found.key_rest.size() - kTailBytes];
        if (type == kRemoval && found.value.empty()) may_be_removal(found);
        if (type != kValue || found.value.size() > kValueBytesMax) return false;
        if (const auto key = intact_key(found)) {
            is_intact(*key, found);
            take_waiting();
            return true;
        }
        waiting_.push_back(found);
        return false;
    }

private:
    /// Returns nullopt if the checksum matches with no possible key.
    std::optional<std::string> intact_key(const Found& found) {
        std::optional<std::string> shaped; // the most likely key
        std::optional<std::string> tried;  // the last key tried
        for (const auto* near : {&near_intact_, &near_uncertain_}) {
            for (const auto& before : *near) {
                auto key = key_of(found, before);
                if (!key || key == tried) continue;
                if (unsealed(*key, found.value)) return key;
                if (!shaped) shaped = key;
                tried = std::move(key);
            }
        }
        if (shaped) near_uncertain_ = keys_near(*shaped); // key of a damaged value, if this is an entry at all
        return std::nullopt;
    }

    /// No checksum covers a removal.
    void may_be_removal(const Found& found) {
        for (const auto& before : near_intact_) {
            if (const auto key = key_of(found, before)) near_uncertain_ = keys_near(*key);
        }
    }

    void is_intact(const std::string& key, const Found& found) {
        visit_(key, found.value);
        near_intact_ = keys_near(key);
    }

    /// The entries before an intact one have keys near its own.
    void take_waiting() {
        const auto near_last = near_intact_;
        const auto waiting = std::exchange(waiting_, {});
        for (auto found = waiting.rbegin(); found != waiting.rend(); ++found) {
            if (const auto key = intact_key(*found)) is_intact(*key, *found);
        }
        near_intact_ = near_last;
    }

    const VisitCarved& visit_;
    std::array<std::string, 5> near_intact_ = keys_near(session_key(0)); // of the last intact entry
    std::array<std::string, 5> near_uncertain_;
    std::vector<Found> waiting_; // since the last intact entry
};

/// Whether a key may begin like this; see record.hpp.
bool is_kind(std::string_view key) { return std::string_view("cflns").find(key.front()) != std::string_view::npos; }

} // namespace

void carve_table(std::string_view table, const VisitCarved& visit) {
    Carving carving(visit);
    while (!table.empty()) {
        const auto found = read_one(table);
        const bool taken = found && carving.take(*found);
        table.remove_prefix(taken ? static_cast<std::size_t>(found->value.end() - table.begin()) : 1);
    }
}

std::set<SessionId> sessions_removed_in(std::string_view table) {
    std::set<SessionId> removed;
    std::string before; // key of the entry that ends where the next one begins; empty: no such entry
    while (!table.empty()) {
        const auto found = read_one(table);
        if (!found || found->shared > before.size() || !is_kind(found->shared > 0 ? before : found->key_rest)) {
            before.clear();
            table.remove_prefix(1);
            continue;
        }
        before.resize(found->shared);
        before.append(found->key_rest.substr(0, found->key_rest.size() - kTailBytes));
        const char type = found->key_rest[found->key_rest.size() - kTailBytes];
        const auto session = session_of(before);
        if (session && type == kRemoval && found->value.empty()) removed.insert(*session);
        table.remove_prefix(static_cast<std::size_t>(found->value.end() - table.begin()));
    }
    return removed;
}

} // namespace scanloom::store
