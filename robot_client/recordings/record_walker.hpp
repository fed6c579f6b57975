#pragma once

#include "robot_client/recordings/recorded_bytes.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace scanloom::robot {

/// Where a record is, in bytes of what it is read from.
struct RecordPlace {
    std::uint64_t begin = 0;
    std::uint64_t data = 0; ///< where its data begins
    std::uint64_t end = 0;  ///< behind its data, as its length says
    std::uint64_t next = 0; ///< where the next record begins: at `end`, or at `data` if records are its data
    std::optional<std::uint64_t> next_otherwise; ///< where it begins if it is not at `next`
    bool is_packed = false; ///< its data is compressed, and shows by itself where it ends
    bool is_end_unclear = false; ///< of packed data: `end` may be too large, as its length or what follows is damaged
    bool is_vague = false;  ///< little of it could be checked: it is believed if a record follows
};

/// Bytes from `begin` to `end` that belong to no record.
struct RecordGap {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
};

/// A record, and the bytes before it that had to be skipped. At the end there is no record.
template <class Record>
struct WalkedRecord {
    std::optional<Record> record;
    std::optional<RecordGap> gap;
};

/// Walks over the records of a file or chunk, and continues at the next credible record after damage.
///
/// A record is believed if another one follows it. If none does, either its length or what follows is damaged: a record
/// that is found inside shows that it is the length.
///
/// Format has:
///   using Record = ...; // derived from RecordPlace
///   Result<std::optional<Record>> read(RecordedBytes&, std::uint64_t at) const;  // nullopt: no record can begin there
///   static bool may_begin(std::string_view bytes);        // quick check of the kFirstBytes bytes of a record
///   static bool can_be_in_chunk(const Record&);
///   static constexpr std::size_t kFirstBytes, kFollowers; // so many records must follow one that is searched for
template <class Format>
class RecordWalker {
public:
    using Record = typename Format::Record;

    /// @param bytes  must outlive the walker
    RecordWalker(Format format, RecordedBytes& bytes, std::uint64_t begin)
        : format_(std::move(format)), bytes_(&bytes), at_(begin) {}

    /// Returns the next record.
    /// Errors: those of RecordedBytes.
    [[nodiscard]] Result<WalkedRecord<Record>> next() {
        WalkedRecord<Record> found;
        while (at_ < bytes_->size()) {
            const std::uint64_t begin = at_;
            auto record = read_at(begin);
            if (!record) return record.error();
            bool is_record = record->has_value();
            if (is_record) {
                auto fits = settle(**record);
                if (!fits) return fits.error();
                is_record = *fits;
            }
            if (is_record) {
                found.record = std::move(*record);
                return found;
            }
            auto place = at_ != begin ? Result<std::uint64_t>(at_) : find(begin + 1);
            if (!place) return place.error();
            at_ = *place;
            if (!found.gap) found.gap = RecordGap{begin, begin};
            found.gap->end = at_;
        }
        return found;
    }

    /// Returns where the next record is expected.
    [[nodiscard]] std::uint64_t position() const noexcept { return at_; }

    /// Continues at `position`.
    void move_to(std::uint64_t position) {
        at_ = position;
        ahead_.reset();
    }

private:
    [[nodiscard]] Result<std::optional<Record>> read_at(std::uint64_t at) {
        if (ahead_ && ahead_->begin == at) return std::optional<Record>(std::exchange(ahead_, std::nullopt));
        if (auto loaded = bytes_->read(at, Format::kFirstBytes); !loaded) return loaded.error();
        return format_.read(*bytes_, at);
    }

    /// Returns whether a record begins at `at`, or the end is there.
    [[nodiscard]] Result<bool> leads_on(std::uint64_t at) {
        if (at >= bytes_->size()) return at == bytes_->size();
        auto record = format_.read(*bytes_, at);
        if (!record) return record.error();
        ahead_ = std::move(*record);
        if (!ahead_ || !ends_inside(*ahead_)) return false;
        if (!ahead_->is_vague || ahead_->next == bytes_->size()) return true;
        auto follower = format_.read(*bytes_, ahead_->next);
        if (!follower) return follower.error();
        return follower->has_value();
    }

    [[nodiscard]] bool ends_inside(const Record& record) const {
        return record.next <= bytes_->size() || record.is_packed;
    }

    /// Sets where the record ends and at_ behind it.
    /// @return false if the record cannot be used; then at_ is where to continue, or has not changed if that is unknown
    [[nodiscard]] Result<bool> settle(Record& record) {
        auto follows = leads_on(record.next);
        if (!follows) return follows.error();
        if (!*follows && record.next_otherwise) {
            follows = leads_on(*record.next_otherwise);
            if (!follows) return follows.error();
            if (*follows) record.next = *record.next_otherwise;
        }
        if (*follows) {
            at_ = record.next;
            return true;
        }
        // A compressed chunk may have records of its own in plain sight.
        auto place = find(record.data, record.is_packed);
        if (!place) return place.error();
        if (record.is_packed) {
            record.end = record.next = *place;
            record.is_end_unclear = true;
        } else if (*place < record.next || record.next > bytes_->size()) {
            at_ = *place; // its length is wrong, or it is truncated
            return false;
        }
        at_ = record.next;
        return true;
    }

    /// Returns where the first credible record from `from` on begins, or the end.
    [[nodiscard]] Result<std::uint64_t> find(std::uint64_t from, bool is_outside_of_chunks = false) {
        constexpr std::size_t kSearchBytes = 65'536;
        ahead_.reset();
        while (from + Format::kFirstBytes <= bytes_->size()) {
            auto window = bytes_->read(from, kSearchBytes);
            if (!window) return window.error();
            if (window->size() < Format::kFirstBytes) break;
            const std::size_t places = window->size() - Format::kFirstBytes + 1;
            for (std::size_t i = 0; i < places; ++i) {
                if (!Format::may_begin(window->substr(i, Format::kFirstBytes))) continue;
                auto credible = is_credible(from + i, is_outside_of_chunks);
                if (!credible) return credible.error();
                if (*credible) return from + i;
            }
            from += places;
        }
        return bytes_->size();
    }

    [[nodiscard]] Result<bool> is_credible(std::uint64_t at, bool is_outside_of_chunks = false) {
        for (std::size_t followers = 0; at < bytes_->size(); ++followers) {
            auto record = format_.read(*bytes_, at);
            if (!record) return record.error();
            if (!*record) return false;
            if (followers == 0 && is_outside_of_chunks && Format::can_be_in_chunk(**record)) return false;
            if (!ends_inside(**record)) return followers > 0; // the file is truncated
            if (followers == Format::kFollowers) return true;
            if ((*record)->is_packed && (*record)->next > bytes_->size()) return true;
            at = (*record)->next;
        }
        return at == bytes_->size();
    }

    Format format_;
    RecordedBytes* bytes_;
    std::uint64_t at_;
    std::optional<Record> ahead_; // a record that was read in advance
};

} // namespace scanloom::robot
