#include "robot_client/spool/spool.hpp"

#include "common/scan/limits.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>

namespace scanloom::robot {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kNumberingFile = "numbering";
constexpr std::uint64_t kSegmentsWanted = 16;
constexpr std::uint64_t kSegmentBytesMax = std::uint64_t{4} << 20;
constexpr std::uint64_t kTidyBytes = std::uint64_t{1} << 20; ///< from then on the newest file may go, too

} // namespace

Spool::Spool(SpoolOptions options, std::function<void(const std::string&)> tell)
    : options_(std::move(options)), tell_(std::move(tell)) {}

Result<std::unique_ptr<Spool>> Spool::open(SpoolOptions options, std::function<void(const std::string&)> tell) {
    std::unique_ptr<Spool> spool(new Spool(std::move(options), std::move(tell)));
    if (auto ok = spool->lock(); !ok) return ok.error();
    if (auto ok = spool->load(); !ok) return ok.error();
    return spool;
}

Result<> Spool::lock() {
    std::error_code failed;
    fs::create_directories(options_.directory, failed);
    if (failed) {
        return Error{Errc::kStoreFailed,
                     fmt::format("cannot create {}: {}", options_.directory.string(), failed.message())};
    }
    const fs::path file = options_.directory / "lock";
    lock_ = FileHandle(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
    if (!lock_) return file_error("cannot open", file);
    if (::flock(lock_.get(), LOCK_EX | LOCK_NB) == 0) return {};
    if (errno != EWOULDBLOCK) return file_error("cannot lock", file);
    return Error{Errc::kConflict, fmt::format("another program uses the spool {}; end it, or give another --spool",
                                              options_.directory.string())};
}

Result<> Spool::load() {
    auto numbering = read_numbering(options_.directory / kNumberingFile);
    if (!numbering) return numbering.error();
    numbering_ = *numbering;
    if (numbering_) next_number_ = std::max(next_number_, numbering_->first);
    auto left = segments_left(options_.directory, numbering_ ? numbering_->first : 0, tell_);
    if (!left) return left.error();
    segments_.assign(left->begin(), left->end());
    for (const SpoolFile& segment : segments_) {
        bytes_ += segment.bytes;
        waiting_ += segment.scans;
        next_number_ = segment.first + segment.scans;
    }
    return {};
}

fs::path Spool::file_of(const SpoolFile& segment) const { return options_.directory / segment_file(segment.first); }

std::uint64_t Spool::segment_bytes_max() const noexcept {
    return std::min(kSegmentBytesMax, options_.bytes_max / kSegmentsWanted);
}

// Appending -----------------------------------------------------------------------------------------------------------

Result<bool> Spool::append(const Observation& observation) {
    if (!writer_ || writer_->bytes() >= segment_bytes_max()) {
        if (auto ok = start_segment(); !ok) return ok.error();
    }
    std::string bytes;
    auto& written = written_sensors_[observation.sensor->id];
    const bool is_new = !written || (written != observation.sensor && *written != *observation.sensor);
    if (is_new) append_record(*observation.sensor, bytes);
    wire::ScanBatch batch{{observation.scan}};
    batch.scans.front().seq = next_number_;
    append_record(batch, bytes);
    if (!make_room(bytes.size())) {
        ++dropped_;
        return false;
    }
    if (auto ok = writer_->append(bytes); !ok) {
        writer_.reset(); // another file may do better
        return ok.error();
    }
    written = observation.sensor;
    ++segments_.back().scans;
    segments_.back().bytes += bytes.size();
    bytes_ += bytes.size();
    ++waiting_;
    ++next_number_;
    sync_.wrote(writer_->handle(), std::chrono::steady_clock::now());
    return true;
}

/// A new file, named after the scan that is going to be its first.
Result<> Spool::start_segment() {
    writer_.reset();
    written_sensors_.clear();
    if (!segments_.empty() && segments_.back().scans == 0) { // it never got its first scan
        if (reading_ + 1 == segments_.size()) reader_.reset();
        remove(segments_.size() - 1);
    }
    auto writer = SegmentWriter::create(file_of({next_number_, 0, 0, 0}));
    if (!writer) return writer.error();
    writer_ = std::move(*writer);
    segments_.push_back({next_number_, 0, writer_->bytes(), 0});
    bytes_ += writer_->bytes();
    return {};
}

/// @return whether `bytes` may be written now.
bool Spool::make_room(std::size_t bytes) {
    while (bytes_ + bytes > options_.bytes_max) {
        if (!told_of_dropping_) {
            told_of_dropping_ = true;
            tell_(fmt::format("the spool {} is full ({} MiB): the {} scans are dropped", options_.directory.string(),
                              options_.bytes_max >> 20,
                              options_.when_full == WhenFull::kDropOldest ? "oldest unsent" : "newest"));
        }
        if (options_.when_full == WhenFull::kDropNewest) return false;
        std::size_t index = reading_;
        while (index < segments_.size() && !may_go(index)) ++index;
        if (index >= segments_.size()) return false;
        dropped_ += segments_[index].scans;
        waiting_ -= segments_[index].scans;
        remove(index);
    }
    told_of_dropping_ = told_of_dropping_ && bytes_ + bytes > options_.bytes_max / 2;
    return true;
}

/// Whether a segment holds only scans that were never sent, and is not the one being written.
bool Spool::may_go(std::size_t index) const noexcept {
    const bool is_written = writer_ && index + 1 == segments_.size();
    const bool is_read = index < reading_ || (index == reading_ && reader_);
    return !is_written && !is_read && segments_[index].first > (numbering_ ? numbering_->entered : 0);
}

void Spool::remove(std::size_t index) {
    std::error_code ignored;
    fs::remove(file_of(segments_[index]), ignored);
    bytes_ -= segments_[index].bytes;
    segments_.erase(segments_.begin() + static_cast<std::ptrdiff_t>(index));
}

// Handing out ---------------------------------------------------------------------------------------------------------

Result<> Spool::begin(std::string_view session_id, std::uint64_t durable_seq) {
    if (!is_valid_name(session_id)) {
        return Error{Errc::kMalformed, "the server's session id is not one that can be stored in a spool"};
    }
    const bool is_same = numbering_ && numbering_->session_id == session_id;
    std::uint64_t seq = durable_seq + 1; // of the first scan here
    if (is_same) {
        const auto checked = first_seq_where(durable_seq);
        if (!checked) return checked.error();
        seq = *checked;
    } else if (numbering_ && waiting_ > 0) {
        tell_(fmt::format("the session is another than before; the {} scans of the spool go to the new one", waiting_));
    }
    numbering_ = Numbering{std::string(session_id), segments_.empty() ? next_number_ : segments_.front().first, seq,
                           numbering_ ? numbering_->entered : 0};
    next_seq_ = seq;
    if (auto ok = write_numbering(options_.directory / kNumberingFile, *numbering_); !ok) return ok;
    if (auto ok = skip(durable_seq + 1 - next_seq_); !ok) return ok;
    acknowledge(durable_seq);
    return {};
}

/// The seq of the first scan here, in the session that knows them.
Result<std::uint64_t> Spool::first_seq_where(std::uint64_t durable_seq) const {
    const std::uint64_t seq = numbering_->seq;
    if (durable_seq + 1 < seq) {
        return Error{
            Errc::kConflict,
            fmt::format("the server holds {} scans of this robot but had acknowledged {}: restore the server's "
                        "store or use a new --session",
                        durable_seq, seq - 1)};
    }
    std::uint64_t perhaps_sent = 0;
    for (const SpoolFile& segment : segments_) {
        if (segment.first <= numbering_->entered) perhaps_sent += segment.scans;
    }
    if (durable_seq < seq + perhaps_sent) return seq;
    if (perhaps_sent == 0) return durable_seq + 1; // sent by others meanwhile; all of these follow
    return Error{Errc::kConflict,
                 fmt::format("the server holds {} scans of this robot, of which the spool {} sent {} at most: another "
                             "program sent scans under the same --robot and --session; use another, or remove the "
                             "directory",
                             durable_seq, options_.directory.string(), seq + perhaps_sent - 1)};
}

Result<> Spool::skip(std::uint64_t scans) {
    while (scans > 0) {
        SpoolFile& segment = segments_[reading_];
        if (!reader_ && segment.scans <= scans && reading_ + 1 < segments_.size()) { // without reading it
            segment.first_seq = next_seq_;
            next_seq_ += segment.scans;
            waiting_ -= segment.scans;
            scans -= segment.scans;
            ++reading_;
            continue;
        }
        const auto passed = next();
        if (!passed) return passed.error();
        if (!*passed) return {};
        --scans;
    }
    return {};
}

Result<std::optional<Observation>> Spool::next() {
    while (reading_ < segments_.size()) {
        if (!reader_) {
            if (auto ok = enter(); !ok) return ok.error();
        }
        if (handed_out_ == segments_[reading_].scans) {
            if (reading_ + 1 == segments_.size()) break; // it may still grow
            ++reading_;
            reader_.reset();
            continue;
        }
        auto record = reader_->next();
        if (!record || !*record) {
            leave_damaged(record ? "the end of " + file_of(segments_[reading_]).string() + " is missing"
                                 : record.error().message);
            continue;
        }
        wire::Message& message = (*record)->message;
        if (auto* described = std::get_if<Sensor>(&message)) {
            read_sensors_[described->id] = std::make_shared<const Sensor>(std::move(*described));
        } else if (auto* batch = std::get_if<wire::ScanBatch>(&message)) {
            const auto sensor = read_sensors_[batch->scans.front().sensor];
            if (!sensor) {
                leave_damaged(file_of(segments_[reading_]).string() + " lacks the sensor of a scan");
                continue;
            }
            ++handed_out_;
            ++next_seq_;
            --waiting_;
            return std::optional(Observation{sensor, std::move(batch->scans.front())});
        }
    }
    return std::optional<Observation>{};
}

/// Begins to read segments_[reading_]. From then on its scans may have been sent.
Result<> Spool::enter() {
    SpoolFile& segment = segments_[reading_];
    if (segment.first > numbering_->entered) {
        numbering_->entered = segment.first;
        if (auto ok = write_numbering(options_.directory / kNumberingFile, *numbering_); !ok) return ok;
    }
    auto reader = SegmentReader::open(file_of(segment));
    if (!reader) return reader.error();
    reader_ = std::move(*reader);
    read_sensors_.clear();
    handed_out_ = 0;
    segment.first_seq = next_seq_;
    return {};
}

/// What cannot be read of the present segment is lost.
void Spool::leave_damaged(const std::string& why) {
    SpoolFile& segment = segments_[reading_];
    const std::uint64_t lost = segment.scans - handed_out_;
    tell_(fmt::format("{}; {} scans are lost", why, lost));
    dropped_ += lost;
    waiting_ -= lost;
    segment.scans = handed_out_;
    if (reading_ + 1 == segments_.size()) writer_.reset(); // what comes goes to another file
}

// Acknowledged --------------------------------------------------------------------------------------------------------

void Spool::acknowledge(std::uint64_t seq) {
    acknowledged_ = std::max(acknowledged_, seq);
    forget_acknowledged(false);
}

void Spool::tidy_up() {
    writer_.reset();
    forget_acknowledged(true);
}

void Spool::forget_acknowledged(bool also_the_newest) {
    while (!segments_.empty()) {
        const SpoolFile& front = segments_.front();
        const bool is_handed_out = reading_ > 0 || (reader_ && handed_out_ == front.scans);
        if (!is_handed_out || front.first_seq + front.scans > acknowledged_ + 1) return;
        const bool is_newest = segments_.size() == 1;
        if (is_newest && !also_the_newest && front.bytes < std::min(kTidyBytes, segment_bytes_max())) return;
        numbering_->first = is_newest ? next_number_ : segments_[1].first;
        numbering_->seq = front.first_seq + front.scans;
        // Were the file still there with the next one known as the first, it would go at the next start.
        if (!write_numbering(options_.directory / kNumberingFile, *numbering_)) return;
        if (is_newest) writer_.reset();
        if (reading_ > 0) {
            --reading_;
        } else {
            reader_.reset();
        }
        remove(0);
    }
}

} // namespace scanloom::robot
