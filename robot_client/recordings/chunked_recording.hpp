#pragma once

#include "robot_client/recordings/record_walker.hpp"
#include "robot_client/recordings/recording_lists.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace scanloom::robot {

/// A recording that consists of records: a ROS 1 bag or an MCAP file. Some records are in compressed chunks. A message
/// has the number of its connection or channel; another record describes that number. The end of the file repeats these
/// descriptions.
///
/// Format is as for RecordWalker, and has: bool is_chunk; static constexpr std::string_view kNumbered, "channel" or
/// "connection" for people.
template <class Format>
class ChunkedRecording : public Recording {
public:
    [[nodiscard]] Result<std::optional<RecordedMessage>> next() final {
        while (!has_ended_) {
            RecordedBytes& bytes = chunk_ ? static_cast<RecordedBytes&>(chunk_->bytes) : *file_;
            auto step = chunk_ ? chunk_->records.next() : records_.next();
            if (!step) return step.error();
            if (step->gap) lose_gap(*step->gap, bytes);
            if (step->record) {
                auto message = take(*step->record, bytes);
                if (!message) return message.error();
                if (*message) return message;
            } else if (chunk_) {
                chunk_.reset();
            } else {
                has_ended_ = true;
                lose_end();
            }
        }
        return std::optional<RecordedMessage>();
    }

    [[nodiscard]] const std::vector<RecordedTopic>& topics() const final { return topics_.all(); }
    [[nodiscard]] const std::vector<RecordingLoss>& losses() const final { return losses_.listed(); }
    [[nodiscard]] std::uint64_t losses_count() const final { return losses_.count(); }
    [[nodiscard]] ReadProgress progress() const final {
        return {has_ended_ ? file_->size() : records_.position(), file_->size()};
    }

protected:
    using Record = typename Format::Record;
    using Taken = Result<std::optional<RecordedMessage>>;
    using Number = std::uint32_t; ///< of a connection or channel

    /// Where the description of an unknown number is searched.
    enum class Search { kEnd, kFile, kDone };

    /// @param begin  where the first record begins
    ChunkedRecording(std::unique_ptr<RecordedBytes> file, std::uint64_t begin)
        : file_(std::move(file)), begin_(begin), records_(Format{}, *file_, begin) {}

    /// Takes a record. @return its message, if it is one that can be read
    [[nodiscard]] virtual Taken take(const Record& record, RecordedBytes& bytes) = 0;
    /// Takes a record of the file again if it describes a number. A description at the end of the file is the right
    /// one.
    [[nodiscard]] virtual Result<> take_again(const Record& record) = 0;
    /// Returns where the descriptions at the end of the file begin; nullopt: there are none.
    [[nodiscard]] virtual Result<std::optional<std::uint64_t>> find_descriptions() = 0;
    /// Adds what is missing at the end of the file to the losses.
    virtual void lose_end() = 0;
    /// Adds the topic of a number whose description is incomplete, if there is one.
    [[nodiscard]] virtual Result<> describe_incomplete(Number, const Record&) { return {}; }

    /// Takes a message. @return nullopt if it cannot be read
    [[nodiscard]] Taken take_message(Number number, std::int64_t time, const Record& record, RecordedBytes& bytes) {
        const auto none = std::optional<RecordedMessage>();
        while (!numbered_.contains(number) && search_ != Search::kDone) {
            if (auto ok = search(); !ok) return ok.error();
        }
        if (!numbered_.contains(number)) {
            if (auto ok = describe_incomplete(number, record); !ok) return ok.error();
        }
        const auto known = numbered_.find(number);
        if (known == numbered_.end()) {
            lose(record, fmt::format("a message of {} {}, which is not described", Format::kNumbered, number));
            return none;
        }
        const std::uint64_t size = record.end - record.data;
        if (size > kRecordedBytesMax) {
            lose(record, fmt::format("a message of {} bytes; at most {} are supported", size, kRecordedBytesMax));
            return none;
        }
        auto data = bytes.read(record.data, size);
        if (!data) return data.error();
        if (data->size() < size) return none; // the file has become shorter: the records say so
        return std::optional(RecordedMessage{known->second, time, *data});
    }

    /// Sets the topic of a number.
    /// @param record  that describes it
    [[nodiscard]] Result<> describe(Number number, RecordedTopic described, const Record& record) {
        const auto topic = topics_.add(std::move(described));
        if (!topic) {
            lose(record, "a topic, because there are too many or its name is too long");
            return {};
        }
        const auto [known, is_new] = numbered_.try_emplace(number, *topic);
        if (is_new || known->second == *topic) return {};
        // One of the two has a damaged number. The description at the end of the file decides, else the newest one.
        lose(record, fmt::format("{} {}, which is described in two ways", Format::kNumbered, number));
        if (search_ == Search::kEnd) {
            if (auto ok = search(); !ok) return ok;
        }
        if (!described_again_.contains(number)) numbered_[number] = *topic;
        return {};
    }

    [[nodiscard]] bool is_described(Number number) const { return numbered_.contains(number); }

    /// Forgets the topic of a number, because a better description follows.
    void forget(Number number, bool is_described_again) {
        numbered_.erase(number);
        if (is_described_again) described_again_.insert(number);
    }

    /// Reads the records of a chunk next, from decompressed_.
    void begin_chunk(const Record& record) { chunk_.emplace(decompressed_, record.begin); }

    /// Adds a loss in a record: at its place in the file, or at the place of its chunk.
    void lose(const Record& record, std::string reason) {
        losses_.add(chunk_ ? chunk_->offset : record.begin, std::move(reason));
    }
    void lose_at_end(std::string reason) { losses_.add(file_->size(), std::move(reason)); }

    /// Returns the bytes of a chunk; nullopt if they are too many.
    [[nodiscard]] Result<std::optional<std::string_view>> read_packed(const Record& record) {
        const std::uint64_t size = record.end - record.data;
        if (size > kRecordedBytesMax) {
            lose(record, fmt::format("a chunk of {} bytes; at most {} are supported", size, kRecordedBytesMax));
            return std::optional<std::string_view>();
        }
        auto packed = file_->read(record.data, size);
        if (!packed) return packed.error();
        return std::optional(*packed);
    }
    void lose_rest_of_chunk(const Record& record, std::string_view reason) {
        lose(record,
             fmt::format("a part of a chunk: {}; {} bytes could be decompressed", reason, decompressed_.size()));
    }

    std::unique_ptr<RecordedBytes> file_;
    std::uint64_t begin_;
    RecordWalker<Format> records_;
    std::string decompressed_; // the records of a chunk
    TopicList topics_;
    bool has_ended_ = false;

private:
    struct Chunk {
        Chunk(std::string_view decompressed, std::uint64_t begin)
            : bytes(decompressed), records(Format{.is_chunk = true}, bytes, 0), offset(begin) {}

        BytesInMemory bytes;
        RecordWalker<Format> records;
        std::uint64_t offset; ///< of the chunk in the file
    };

    void lose_gap(const RecordGap& gap, const RecordedBytes& bytes) {
        const auto what = fmt::format("{} bytes are damaged or incomplete", gap.end - gap.begin);
        if (!chunk_) return losses_.add(gap.begin, what);
        losses_.add(chunk_->offset, fmt::format("{} of the {} decompressed bytes of a chunk", what, bytes.size()));
    }

    /// Reads descriptions at the end of the file, and the next time anywhere outside of compressed chunks.
    [[nodiscard]] Result<> search() {
        const bool is_first = search_ == Search::kEnd;
        search_ = is_first ? Search::kFile : Search::kDone;
        auto from = is_first ? find_descriptions() : Result<std::optional<std::uint64_t>>(begin_);
        if (!from) return from.error();
        if (!*from) return {};
        RecordWalker<Format> records(Format{}, *file_, **from);
        for (;;) {
            auto step = records.next();
            if (!step) return step.error();
            if (!step->record) return {};
            if (auto ok = take_again(*step->record); !ok) return ok;
        }
    }

    std::optional<Chunk> chunk_;                       // while its records are read
    std::unordered_map<Number, std::size_t> numbered_; // to topics
    std::unordered_set<Number> described_again_;       // at the end of the file, once that is read
    LossList losses_;
    Search search_ = Search::kEnd;
};

} // namespace scanloom::robot
