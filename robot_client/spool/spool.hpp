#pragma once

#include "robot_client/source/source.hpp"
#include "robot_client/spool/background_sync.hpp"
#include "robot_client/spool/file_handle.hpp"
#include "robot_client/spool/numbering.hpp"
#include "robot_client/spool/segment.hpp"
#include "robot_client/spool/segment_list.hpp"

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// What goes when there is no room for a new scan. Scans that may have been sent already never go.
enum class WhenFull { kDropOldest, kDropNewest };

struct SpoolOptions {
    std::filesystem::path directory; ///< for one robot in one session; made where it is missing
    std::uint64_t bytes_max = std::uint64_t{256} << 20;
    WhenFull when_full = WhenFull::kDropOldest; ///< the oldest go by whole files, each a sixteenth of bytes_max at most
    bool poses_are_told = false; ///< by the server, from the session's map: in another session they are of no use but
                                 ///< to begin a map with
};

/// The scans that a robot took and the server has not acknowledged, on disk. They survive the program that took them.
///
///     acknowledged | handed out by next(), perhaps sent | waiting | what append() adds
///
/// A scan is in its file before append() returns, and the disk is asked to keep it within a second or two. The scans
/// stand in files of some MiB (see segment_head.hpp and record.hpp), each with the sensors it needs; a file goes once
/// all of it is acknowledged. Which seqs its scans have on the server is in its head, so that the loss of one file, or
/// of its end, changes nothing for the others. How far the server is stands in the file `numbering`.
/// Thread  one at a time. One program at a time uses the directory.
class Spool {
public:
    static constexpr std::uint64_t kBytesMin = std::uint64_t{1} << 20;

    /// Opens what an earlier run has left. `tell` hears sentences for people: of files that are damaged, of scans that
    /// are lost.
    /// Errors  kStoreFailed; kConflict: another program uses the directory.
    [[nodiscard]] static Result<std::unique_ptr<Spool>> open(SpoolOptions options,
                                                             std::function<void(const std::string&)> tell);

    /// The server holds the robot's scans up to `durable_seq`: those of them that are here are passed over. Pre: once.
    /// In another session than before, those go that were not acknowledged in that one; where their poses were told
    /// from its map, each as one that begins a map (Scan::begins_map), until the new one has acknowledged one of them.
    /// Where the server holds more than was sent from here, that is told: files may have lost their ends in a power
    /// cut, scans may have gone past a full disk, or another program sent some under the same name. What was sent then
    /// counts as stored.
    /// Errors  kConflict: it lost some that it had acknowledged; kStoreFailed.
    [[nodiscard]] Result<> begin(std::string_view session_id, std::uint64_t durable_seq);

    /// Errors  kStoreFailed: it could not be written.
    /// @return whether it is kept; not if there is no room and the newest go.
    [[nodiscard]] Result<bool> append(const Observation& observation);

    /// The link goes on in a session of this id, under the same seqs: in the one before nothing had been acknowledged.
    [[nodiscard]] Result<> follow(std::string_view session_id);

    /// The next scan to send; nothing while none waits. Waits for the disk once a file. Pre: begin() went well.
    /// Errors  kStoreFailed.
    [[nodiscard]] Result<std::optional<Observation>> next();

    /// The server holds all scans up to `seq`.
    void acknowledge(std::uint64_t seq);

    /// Removes the files of acknowledged scans now that nothing is going to be appended.
    void tidy_up();

    [[nodiscard]] std::uint64_t waiting() const noexcept { return waiting_; } ///< scans not handed out
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; } ///< scans, by this program
    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }     ///< of all files
    [[nodiscard]] const std::filesystem::path& directory() const noexcept { return options_.directory; }

private:
    Spool(SpoolOptions options, std::function<void(const std::string&)> tell);
    [[nodiscard]] Result<> load();
    [[nodiscard]] Result<> lock();
    [[nodiscard]] std::filesystem::path file_of(const SpoolFile& segment) const;
    [[nodiscard]] std::uint64_t segment_bytes_max() const noexcept;

    [[nodiscard]] Result<> start_segment();
    [[nodiscard]] bool make_room(std::size_t bytes);
    [[nodiscard]] bool may_go(std::size_t index) const noexcept;
    void remove(std::size_t index);

    void mend_heads();
    [[nodiscard]] Result<> check(std::uint64_t durable_seq) const;
    [[nodiscard]] Result<> leave_session();
    [[nodiscard]] Result<> enter();
    void leave_damaged(const std::string& why);
    void forget_acknowledged(bool also_the_newest);

    SpoolOptions options_;
    std::function<void(const std::string&)> tell_;
    FileHandle lock_;
    BackgroundSync sync_;
    std::deque<SpoolFile> segments_;
    std::uint64_t bytes_ = 0;
    std::uint64_t waiting_ = 0;
    std::uint64_t dropped_ = 0;
    bool told_of_dropping_ = false;

    // appending, to the last segment
    std::optional<SegmentWriter> writer_;
    std::map<std::uint32_t, std::shared_ptr<const Sensor>> written_sensors_; ///< in that file
    std::uint64_t next_number_ = 1;

    // handing out
    Numbering numbering_;
    bool is_strange_ = false; ///< the scans' poses were told from the map of another session than this
    std::size_t reading_ = 0; ///< index of the segment to read from
    std::optional<SegmentReader> reader_;
    std::map<std::uint32_t, std::shared_ptr<const Sensor>> read_sensors_; ///< of that file
    std::uint64_t read_ = 0;                                              ///< scans of that segment
    std::uint64_t next_seq_ = 0;
};

} // namespace scanloom::robot
