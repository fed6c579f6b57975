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
constexpr const char* kNoSession = "none";                   ///< not a valid session id: those have 16 digits
constexpr std::uint64_t kTidyBytes = std::uint64_t{1} << 20; ///< from this size on the newest file may be removed, too

} // namespace

Spool::Spool(SpoolOptions options, std::function<void(const std::string&)> report)
    : options_(std::move(options)), report_(std::move(report)) {}

Result<std::unique_ptr<Spool>> Spool::open(SpoolOptions options, std::function<void(const std::string&)> report) {
    std::unique_ptr<Spool> spool(new Spool(std::move(options), std::move(report)));
    if (auto ok = spool->lock(); !ok) return ok.error();
    if (auto ok = spool->load(); !ok) return ok.error();
    if (const auto poses = spool->options_.poses) {
        if (auto ok = spool->state_poses(*poses); !ok) return ok.error();
    }
    return spool;
}

Result<> Spool::state_poses(Poses poses) {
    const bool are_others = numbering_.poses != poses;
    if (are_others && numbering_.poses && waiting_ > 0)
        return other_poses(fmt::format("'{}'", name_of(*numbering_.poses)), poses);
    options_.poses = poses;
    if (!are_others || waiting_ > 0) return {};
    numbering_.poses = poses;
    // If this write fails, scans with other poses are still found when they are handed out.
    (void)write_numbering(options_.directory / kNumberingFile, numbering_, Sync::kYes);
    return {};
}

/// @param those  what is known of the poses of the scans that wait
Error Spool::other_poses(std::string_view those, Poses poses) const {
    return {Errc::kConflict,
            fmt::format("{}: an earlier run took the {} scans there with {} poses, not '{}': send them with the "
                        "--poses of that run, or move the directory away",
                        options_.directory.string(), waiting_, those, name_of(poses))};
}

Result<> Spool::lock() {
    std::error_code failed;
    fs::create_directories(options_.directory, failed);
    if (failed) {
        return Error{Errc::kStoreFailed,
                     fmt::format("cannot create {}: {}", options_.directory.string(), failed.message())};
    }
    const fs::path file = options_.directory / "lock";
    lock_ = FileDescriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
    if (!lock_) return file_error("cannot open", file);
    if (::flock(lock_.get(), LOCK_EX | LOCK_NB) == 0) return {};
    if (errno != EWOULDBLOCK) return file_error("cannot lock", file);
    return Error{Errc::kConflict, fmt::format("another program uses the spool {}; end it, or give another --spool",
                                              options_.directory.string())};
}

Result<> Spool::load() {
    const fs::path file = options_.directory / kNumberingFile;
    const auto numbering = read_numbering(file);
    if (!numbering && numbering.error().code == Errc::kStoreFailed) return numbering.error();
    if (!numbering) report_(numbering.error().message + "; its scans are assumed to belong to this session");
    numbering_ = numbering && *numbering ? **numbering : Numbering{};
    if (!numbering || !*numbering) {
        // Later writes need no more room on the disk. If there is none even now, append() reports it.
        (void)write_numbering(file, numbering_, Sync::kYes);
    }

    auto left = segments_left(options_.directory, report_);
    if (!left) return left.error();
    segments_.assign(left->begin(), left->end());
    repair_heads();
    for (SpoolFile& segment : segments_) {
        segment.stored(numbering_.acknowledged);
        next_number_ = segment.end();
        bytes_ += segment.bytes;
        waiting_ += segment.left();
    }
    for (std::size_t i = segments_.size(); i-- > 0;) {
        if (segments_[i].left() == 0) remove(i);
    }
    return {};
}

/// Derives the seqs of a file with a damaged head from the file before or after it. If its scans were not sent at all,
/// the server has fewer scans than that.
void Spool::repair_heads() {
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        SpoolFile& segment = segments_[i];
        if (!segment.is_headless) continue;
        const SpoolFile* before = i > 0 ? &segments_[i - 1] : nullptr;
        const SpoolFile* behind = i + 1 < segments_.size() ? &segments_[i + 1] : nullptr;
        if (before != nullptr && before->seq > 0 && before->end() == segment.first) {
            segment.seq = before->seq + before->left();
        } else if (behind != nullptr && !behind->is_headless && behind->seq > segment.scans &&
                   behind->from == segment.end()) {
            segment.seq = behind->seq - segment.scans;
        }
        report_(fmt::format("the first bytes of {} are damaged; its scans are {}", file_of(segment).string(),
                            segment.seq > 0 ? "numbered by the adjacent files" : "sent, possibly a second time"));
    }
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
        writer_.reset(); // another file may work
        return ok.error();
    }
    written = observation.sensor;
    ++segments_.back().scans;
    segments_.back().bytes += bytes.size();
    bytes_ += bytes.size();
    ++waiting_;
    ++next_number_;
    sync_.wrote(writer_->handle());
    return true;
}

/// Starts a new file, named after the number of its first scan.
Result<> Spool::start_segment() {
    writer_.reset();
    written_sensors_.clear();
    if (!segments_.empty() && segments_.back().scans == 0) { // its first scan was never written
        if (reading_ + 1 == segments_.size()) reader_.reset();
        remove(segments_.size() - 1);
    }
    auto writer = SegmentWriter::create(options_.directory / segment_file(next_number_), next_number_);
    if (!writer) return writer.error();
    writer_ = std::move(*writer);
    segments_.push_back({next_number_, 0, writer_->bytes(), next_number_, 0, false});
    bytes_ += writer_->bytes();
    return {};
}

/// @return whether `bytes` may be written now
bool Spool::make_room(std::size_t bytes) {
    while (bytes_ + bytes > options_.bytes_max) {
        if (!dropping_reported_) {
            dropping_reported_ = true;
            report_(fmt::format("the spool {} is full ({} MiB): the {} scans are dropped", options_.directory.string(),
                                options_.bytes_max >> 20,
                                options_.when_full == WhenFull::kDropOldest ? "oldest unsent" : "newest"));
        }
        if (options_.when_full == WhenFull::kDropNewest) return false;
        std::size_t index = reading_;
        while (index < segments_.size() && !may_go(index)) ++index;
        if (index >= segments_.size()) return false;
        dropped_ += segments_[index].left();
        waiting_ -= segments_[index].left();
        remove(index);
    }
    dropping_reported_ = dropping_reported_ && bytes_ + bytes > options_.bytes_max / 2;
    return true;
}

/// Returns whether a segment has no scans that were sent and is not being written or read.
bool Spool::may_go(std::size_t index) const noexcept {
    const bool is_written = writer_ && index + 1 == segments_.size();
    const bool is_read = index < reading_ || (index == reading_ && reader_);
    return !is_written && !is_read && segments_[index].seq == 0;
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
    const bool is_same = numbering_.session_id.empty() || numbering_.session_id == session_id;
    if (auto ok = is_same ? check(durable_seq) : leave_session(); !ok) return ok;
    is_foreign_ = !is_same && waiting_ > 0 && options_.poses_from_server;
    // If the server refuses these scans, the next run must mark them in any session.
    const Numbering kept =
        is_foreign_ ? Numbering{kNoSession, 0, poses()} : Numbering{std::string(session_id), durable_seq, poses()};
    if (auto ok = write_numbering(options_.directory / kNumberingFile, kept, Sync::kYes); !ok) return ok;
    numbering_ = {std::string(session_id), durable_seq, poses()};
    for (SpoolFile& segment : segments_) {
        waiting_ -= segment.left();
        segment.stored(durable_seq);
        waiting_ += segment.left();
    }
    next_seq_ = durable_seq + 1;
    acknowledge(durable_seq);
    return {};
}

/// Checks whether the scans that the server has match those sent from here.
Result<> Spool::check(std::uint64_t durable_seq) const {
    if (durable_seq < numbering_.acknowledged) {
        return Error{Errc::kConflict,
                     fmt::format("the server has {} scans of this robot but had acknowledged {}: restore the server's "
                                 "store, or rename {} to OTHER.ROBOT and continue with --session OTHER",
                                 durable_seq, numbering_.acknowledged, options_.directory.string())};
    }
    const auto sent = std::ranges::find_if(segments_.rbegin(), segments_.rend(),
                                           [](const SpoolFile& segment) { return segment.seq > 0; });
    if (sent == segments_.rend() || durable_seq <= sent->last_seq()) return {}; // of another program, or of this one
    report_(fmt::format("the server has {} scans of this robot, {} more than were sent from {}: files there are "
                        "truncated, the disk was full, or another program sent scans with the same --robot and "
                        "--session; scans that may have been sent count as stored",
                        durable_seq, durable_seq - sent->last_seq(), options_.directory.string()));
    return {};
}

Result<> Spool::follow(std::string_view session_id) {
    if (numbering_.session_id == session_id) return {};
    numbering_.session_id = session_id;
    if (is_foreign_) return {};
    return write_numbering(options_.directory / kNumberingFile, numbering_, Sync::kYes);
}

/// Marks the scans that the previous session did not acknowledge as never sent.
Result<> Spool::leave_session() {
    if (waiting_ > 0) {
        report_(fmt::format("the session has changed; {} unacknowledged scans go to the new one", waiting_));
    }
    for (SpoolFile& segment : segments_) {
        if (segment.seq == 0) continue;
        if (auto ok = write_segment_head(file_of(segment), {segment.from, 0}); !ok) return ok;
        segment.seq = 0;
    }
    return {};
}

Result<std::optional<Observation>> Spool::next() {
    while (reading_ < segments_.size()) {
        if (!reader_) {
            if (auto ok = enter(); !ok) return ok.error();
        }
        SpoolFile& segment = segments_[reading_];
        if (read_ == segment.scans) {
            if (reading_ + 1 == segments_.size()) break; // it may still grow
            ++reading_;
            reader_.reset();
            continue;
        }
        auto record = reader_->next();
        if (!record || !*record) {
            leave_damaged(record ? "the end of " + file_of(segment).string() + " is missing" : record.error().message);
            continue;
        }
        wire::Message& message = (*record)->message;
        if (auto* described = std::get_if<Sensor>(&message)) {
            read_sensors_[described->id] = std::make_shared<const Sensor>(std::move(*described));
        } else if (auto* batch = std::get_if<wire::ScanBatch>(&message)) {
            const auto sensor = read_sensors_[batch->scans.front().sensor];
            if (!sensor) {
                leave_damaged(file_of(segment).string() + " lacks the sensor of a scan");
                continue;
            }
            if (segment.first + read_++ < segment.from) continue;
            if (options_.poses && !agrees_with(batch->scans.front(), *options_.poses)) {
                return other_poses("other", *options_.poses);
            }
            ++next_seq_;
            --waiting_;
            Observation next{sensor, std::move(batch->scans.front())};
            next.scan.begins_map = next.scan.begins_map || is_foreign_;
            return std::optional(std::move(next));
        }
    }
    return std::optional<Observation>{};
}

/// Starts to read segments_[reading_]. From then on its scans may have been sent, under the seqs in its head.
Result<> Spool::enter() {
    SpoolFile& segment = segments_[reading_];
    auto reader = SegmentReader::open(file_of(segment));
    if (!reader) return reader.error();
    if (segment.seq != next_seq_) {
        if (auto ok = write_segment_head(file_of(segment), {segment.from, next_seq_}); !ok) return ok;
        segment.seq = next_seq_;
    }
    reader_ = std::move(*reader);
    read_sensors_.clear();
    read_ = 0;
    return {};
}

/// Gives up the part of the current segment that cannot be read; its scans are lost.
void Spool::leave_damaged(const std::string& why) {
    SpoolFile& segment = segments_[reading_];
    const std::uint64_t lost = segment.end() - std::max(segment.from, segment.first + read_);
    report_(fmt::format("{}; {} scans are lost", why, lost));
    dropped_ += lost;
    waiting_ -= lost;
    segment.scans = read_;
    segment.from = std::min(segment.from, segment.end());
    if (reading_ + 1 == segments_.size()) writer_.reset(); // new scans go to another file
}

// Acknowledged --------------------------------------------------------------------------------------------------------

void Spool::acknowledge(std::uint64_t seq) {
    if (seq > numbering_.acknowledged) {
        numbering_.acknowledged = seq;
        is_foreign_ = false;
        // If this write fails, at worst another session receives scans that this one has.
        (void)write_numbering(options_.directory / kNumberingFile, numbering_, Sync::kNo);
    }
    forget_acknowledged(false);
}

void Spool::remove_acknowledged() {
    writer_.reset();
    forget_acknowledged(true);
}

void Spool::forget_acknowledged(bool also_the_newest) {
    while (!segments_.empty()) {
        const SpoolFile& front = segments_.front();
        const bool is_handed_out = reading_ > 0 || (reader_ && read_ == front.scans);
        if (!is_handed_out || (front.left() > 0 && front.last_seq() > numbering_.acknowledged)) return;
        const bool is_newest = segments_.size() == 1;
        if (is_newest && !also_the_newest && front.bytes < std::min(kTidyBytes, segment_bytes_max())) return;
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
