#pragma once

#include "robot_client/sources/source.hpp"
#include "robot_client/spool/numbering.hpp"
#include "robot_client/spool/segment.hpp"
#include "robot_client/spool/segment_list.hpp"
#include "robot_client/spool/synced_file.hpp"

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

/// Which scans to drop if there is no room for a new one. Scans that may have been sent are never dropped.
enum class WhenFull { kDropOldest, kDropNewest };

struct SpoolOptions {
    std::filesystem::path directory; ///< of one robot in one session; created if missing
    std::uint64_t bytes_max = std::uint64_t{256} << 20;
    WhenFull when_full = WhenFull::kDropOldest; ///< drops whole files, each at most a sixteenth of bytes_max
    /// Whether the server set the poses from the session's map. In another session such poses can only begin a map.
    bool poses_from_server = false;
    std::optional<Poses> poses; ///< see state_poses(); nullopt: not known yet
};

/// The scans that a robot took and the server has not acknowledged, on disk. They remain after the program ends.
///
///     acknowledged | handed out by next(), perhaps sent | waiting | what append() adds
///
/// A scan is in its file before append() returns, and the file is synced to the disk within a second or two. The scans
/// are in files of some MiB (see segment.hpp), each with the sensors that it needs. A file is
/// removed once all of it is acknowledged. Its head contains the seqs of its scans on the server, so losing one file,
/// or its end, does not affect the others. The file `numbering` stores how far the server is.
/// Threads: one at a time. Only one program at a time uses the directory.
class Spool {
public:
    static constexpr std::uint64_t kBytesMin = std::uint64_t{1} << 20;

    /// Opens the spool with the scans of earlier runs.
    /// @param report  receives messages for people about damaged files and lost scans
    /// Errors: kStoreFailed; kConflict if another program uses the directory; those of state_poses().
    [[nodiscard]] static Result<std::unique_ptr<Spool>> open(SpoolOptions options,
                                                             std::function<void(const std::string&)> report);

    /// States what the poses of the robot's scans are. They are kept with the scans. Call it before append() and
    /// begin() unless SpoolOptions::poses state it.
    /// Errors: kConflict if scans with other poses wait: the server takes only one kind from a robot.
    [[nodiscard]] Result<> state_poses(Poses poses);

    /// Returns what the poses of the scans of this run, or of the last one, are; nullopt if neither stated it.
    [[nodiscard]] std::optional<Poses> poses() const noexcept { return numbering_.poses; }

    /// Starts handing out: the server has the robot's scans up to `durable_seq`, and next() skips these. Pre: called
    /// once.
    ///
    /// If the session is not the one before, the scans that were not acknowledged there are handed out. If
    /// SpoolOptions::poses_from_server, each of them is marked as one that begins a map (Scan::begins_map) until the
    /// new session has acknowledged one of them. If the server has more scans than were sent from here, a message
    /// reports it: files may have lost their ends in a power failure, scans may have bypassed a full disk, or another
    /// program sent some under the same name. The scans that may have been sent then count as stored.
    /// Errors: kConflict if the server lost scans that it had acknowledged; kStoreFailed.
    [[nodiscard]] Result<> begin(std::string_view session_id, std::uint64_t durable_seq);

    /// Adds a scan.
    /// @return whether it is kept; false if there is no room and the newest scans are dropped
    /// Errors: kStoreFailed if it could not be written.
    [[nodiscard]] Result<bool> append(const Observation& observation);

    /// Continues in another session under the same seqs. The previous session had acknowledged nothing.
    [[nodiscard]] Result<> follow(std::string_view session_id);

    /// Returns the next scan to send, or nullopt if none waits. Waits for the disk once per file. Pre: begin()
    /// succeeded.
    /// Errors: kStoreFailed; kConflict if an earlier run took the scan with other poses than stated: the server would refuse
    ///         it.
    [[nodiscard]] Result<std::optional<Observation>> next();

    /// Marks all scans up to `seq` as stored by the server.
    void acknowledge(std::uint64_t seq);

    /// Removes the files of acknowledged scans. Call it when no more scans will be appended.
    void remove_acknowledged();

    [[nodiscard]] std::uint64_t waiting() const noexcept { return waiting_; } ///< scans not handed out
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; } ///< scans, dropped by this program
    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }     ///< of all files
    [[nodiscard]] const std::filesystem::path& directory() const noexcept { return options_.directory; }

private:
    Spool(SpoolOptions options, std::function<void(const std::string&)> report);
    [[nodiscard]] Result<> load();
    [[nodiscard]] Error other_poses(std::string_view those, Poses poses) const;
    [[nodiscard]] Result<> lock();
    [[nodiscard]] std::filesystem::path file_of(const SpoolFile& segment) const;
    [[nodiscard]] std::uint64_t segment_bytes_max() const noexcept;

    [[nodiscard]] Result<> start_segment();
    [[nodiscard]] bool make_room(std::size_t bytes);
    [[nodiscard]] bool may_go(std::size_t index) const noexcept;
    void remove(std::size_t index);

    void repair_heads();
    [[nodiscard]] Result<> check(std::uint64_t durable_seq) const;
    [[nodiscard]] Result<> leave_session();
    [[nodiscard]] Result<> enter();
    void leave_damaged(const std::string& why);
    void forget_acknowledged(bool also_the_newest);

    SpoolOptions options_;
    std::function<void(const std::string&)> report_;
    FileDescriptor lock_;
    BackgroundSync sync_;
    std::deque<SpoolFile> segments_;
    std::uint64_t bytes_ = 0;
    std::uint64_t waiting_ = 0;
    std::uint64_t dropped_ = 0;
    bool dropping_reported_ = false;

    // appending, to the last segment
    std::optional<SegmentWriter> writer_;
    std::map<std::uint32_t, std::shared_ptr<const Sensor>> written_sensors_; ///< in that file
    std::uint64_t next_number_ = 1;

    // handing out
    Numbering numbering_;
    bool is_foreign_ = false; ///< the poses of the scans were set from another session's map
    std::size_t reading_ = 0; ///< index of the segment to read from
    std::optional<SegmentReader> reader_;
    std::map<std::uint32_t, std::shared_ptr<const Sensor>> read_sensors_; ///< of that file
    std::uint64_t read_ = 0;                                              ///< scans of that segment
    std::uint64_t next_seq_ = 0;
};

} // namespace scanloom::robot
