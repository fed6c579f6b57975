#pragma once

#include "server/store/record.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

namespace scanloom::store {

/// Entries in the form of a block of RocksDB's table files, without the trailer of the block.
class TableBlock {
public:
    TableBlock& entry(SessionId session, Revision revision, std::string value) {
        const auto key = entry_key(session, revision);
        return put(key, sealed(key, std::move(value)));
    }

    TableBlock& record(SessionId session, std::string value) {
        const auto key = session_key(session);
        return put(key, sealed(key, std::move(value)));
    }

    TableBlock& remove(std::string_view key) { return add(key, '\0', ""); }

    TableBlock& put(std::string_view key, std::string_view value) { return add(key, '\1', value); }

    /// Stores the next entry with its whole key, as in every sixteenth entry.
    TableBlock& restart() {
        last_.clear();
        return *this;
    }

    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    TableBlock& add(std::string_view user_key, char type, std::string_view value) {
        auto key = std::string(user_key) + type;
        ++sequence_;
        for (unsigned i = 0; i < 7; ++i) key += static_cast<char>(sequence_ >> (8 * i));
        const auto differs = std::ranges::mismatch(key, last_).in1;
        const auto shared = static_cast<std::size_t>(differs - key.begin());
        add_varint(shared);
        add_varint(key.size() - shared);
        add_varint(value.size());
        bytes_.append(key, shared);
        bytes_.append(value);
        last_ = key;
        return *this;
    }

    void add_varint(std::size_t number) {
        for (; number >= 0x80; number >>= 7) bytes_ += static_cast<char>(number | 0x80);
        bytes_ += static_cast<char>(number);
    }

    std::string bytes_;
    std::string last_;
    std::uint64_t sequence_ = 100;
};

} // namespace scanloom::store
