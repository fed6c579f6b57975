#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The protocol of Hokuyo's lidars, SCIP 2.0, 2.1 and 2.2.
/// Source: Hokuyo, URG series communication protocol specification SCIP-version 2.0 (C-42-03320B); UST (C-42-04076).
namespace scanloom::robot {

/// Returns the check character of some text.
[[nodiscard]] char scip_sum(std::string_view text) noexcept;

/// Returns whether a line ends with the check character of the text before it.
[[nodiscard]] bool has_scip_sum(std::string_view line) noexcept;

/// Decodes a number of 6 bits per character, the most significant first. Pre: at most 5 characters.
/// @return nullopt if a character has more than 6 bits
[[nodiscard]] std::optional<std::uint32_t> decode_scip(std::string_view characters) noexcept;

/// A reply: the command, a status of two characters, and lines. An empty line ends it.
struct ScipReply {
    std::string command;            ///< as it was sent
    std::string status;             ///< without its check character
    std::vector<std::string> lines; ///< with their check characters
    bool is_damaged = false;        ///< the check character of the status is wrong

    friend bool operator==(const ScipReply&, const ScipReply&) = default;
};

/// Cuts a stream of bytes into replies, however it is split. Whatever is between replies, and what is too long for one,
/// is a reply to no command.
class ScipReader {
public:
    /// Bytes of a reply to MD with 4096 steps, and some.
    static constexpr std::size_t kReplyBytesMax = 16'384;

    void feed(std::span<const std::uint8_t> bytes);

    /// Returns the next complete reply.
    [[nodiscard]] std::optional<ScipReply> next();

    /// Returns whether a part of a reply waits for the rest of it.
    [[nodiscard]] bool has_part() const noexcept { return bytes_.find_first_not_of('\n') != std::string::npos; }

    /// Starts a new stream: drops the reply that is not complete.
    void restart() noexcept { bytes_.clear(); }

private:
    std::string bytes_;
};

/// What a sensor measures, from its reply to PP.
struct HokuyoParameters {
    std::string model;
    std::int32_t range_min = 0;      ///< millimetres; smaller values are error codes
    std::int32_t range_max = 0;      ///< millimetres
    std::int32_t steps_per_turn = 0; ///< counter-clockwise
    std::int32_t first_step = 0;
    std::int32_t last_step = 0;
    std::int32_t front_step = 0; ///< the direction ahead
    std::int32_t rpm = 0;        ///< turns per minute

    /// Returns the number of beams of a scan.
    [[nodiscard]] std::size_t beams() const noexcept { return static_cast<std::size_t>(last_step - first_step) + 1; }

    friend bool operator==(const HokuyoParameters&, const HokuyoParameters&) = default;
};

/// Returns the value of a line "NAME:value;" of a reply to VV or PP, or an empty string without such a line.
[[nodiscard]] std::string scip_value(const ScipReply& reply, std::string_view name);

/// Reads the reply to PP.
/// Errors: kMalformed if a value is missing, damaged or not possible; the message names it.
[[nodiscard]] Result<HokuyoParameters> read_hokuyo_parameters(const ScipReply& reply);

/// The data of a reply to MD.
struct HokuyoScan {
    std::uint32_t milliseconds = 0;       ///< of the sensor's clock, 24 bits
    std::vector<std::uint32_t> distances; ///< millimetres, or error codes, by increasing step

    friend bool operator==(const HokuyoScan&, const HokuyoScan&) = default;
};

inline constexpr std::uint32_t kHokuyoClockWrap = 1U << 24; ///< milliseconds

/// Reads the data of a reply to MD with 3 characters per distance.
/// Errors: kMalformed if a check character is wrong, or the number of distances is not `beams`.
[[nodiscard]] Result<HokuyoScan> read_hokuyo_scan(const ScipReply& reply, std::size_t beams);

} // namespace scanloom::robot
