#pragma once

#include "robot_client/lidars/ld06_packet.hpp"
#include "robot_client/lidars/ld06_turns.hpp"
#include "robot_client/lidars/lidar_scan.hpp"

#include <filesystem>
#include <fstream>
#include <string>

namespace scanloom::robot {

/// A source of the recorded bytes of an LD06: one scan for each turn that has a pose. Stamps and the times of poses are
/// seconds since the first packet.
///
/// The file is read twice: open() counts its scans, next() creates them as they are needed.
class Ld06Capture final : public Source {
public:
    /// Errors: kNotFound if the file does not exist, cannot be read or contains no scan: no full turn, or none with a
    ///         pose.
    [[nodiscard]] static Result<Ld06Capture> open(const std::filesystem::path& path, const LidarScanOptions& options,
                                                  LidarPoses poses);

    /// Errors: kConflict if the file has changed since open().
    [[nodiscard]] Result<std::optional<Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return scan_count_; }

    /// Returns at most 64 printable bytes that are the same for the same scans, whatever the file's name.
    [[nodiscard]] const std::string& fingerprint() const noexcept { return fingerprint_; }
    /// Returns a message for people about the whole file.
    [[nodiscard]] std::string remarks() const override { return remarks_; }

private:
    struct Reading {
        std::ifstream file;
        Ld06Decoder decoder;
        Ld06RecordingClock clock;
        Ld06Turns turns;
    };

    Ld06Capture(const std::filesystem::path& path, const LidarScanOptions& options, LidarPoses poses);

    [[nodiscard]] Result<> reopen();
    template <class OnBytes>
    [[nodiscard]] std::optional<LidarTurn> next_turn(OnBytes&& on_bytes);
    [[nodiscard]] std::optional<Scan> scan_of(const LidarTurn& turn) const;
    [[nodiscard]] Result<> survey();

    std::string path_;
    LidarScanOptions options_;
    LidarPoses poses_;
    std::shared_ptr<const Sensor> sensor_;
    Reading reading_;
    std::uint64_t scan_count_ = 0;
    std::uint64_t given_ = 0;
    std::string fingerprint_;
    std::string remarks_;
};

} // namespace scanloom::robot
