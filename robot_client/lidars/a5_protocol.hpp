#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The requests and answers of Slamtec's RPLIDARs, which YDLIDARs have, too, with other commands.
/// Source: Slamtec, RPLIDAR interface protocol and application notes; YDLIDAR, X4 development manual.
namespace scanloom::robot {

/// Returns the bytes of a request.
/// @param payload  its data; commands of 0x80 and above have some
[[nodiscard]] std::vector<std::uint8_t> a5_request(std::uint8_t command,
                                                   std::initializer_list<std::uint8_t> payload = {});

/// What comes before the data of an answer.
struct A5Descriptor {
    std::uint32_t size = 0;   ///< bytes of the data, or of each packet if is_repeated
    bool is_repeated = false; ///< packets follow until the sensor is stopped
    std::uint8_t type = 0;

    friend bool operator==(const A5Descriptor&, const A5Descriptor&) = default;
};

inline constexpr std::size_t kA5DescriptorBytes = 7;

inline constexpr A5Descriptor kA5Info{20, false, 0x04};
inline constexpr A5Descriptor kA5Health{3, false, 0x06};

/// Finds a descriptor among other bytes.
/// @return the offset of the byte after it, or nullopt
[[nodiscard]] std::optional<std::size_t> find_a5_descriptor(std::span<const std::uint8_t> bytes,
                                                            const A5Descriptor& wanted) noexcept;

/// What a sensor is.
struct A5Identity {
    std::uint8_t model = 0;
    std::uint8_t firmware_major = 0;
    std::uint8_t firmware_minor = 0;
    std::uint8_t hardware = 0;
    std::string serial; ///< hexadecimal

    friend bool operator==(const A5Identity&, const A5Identity&) = default;
};

/// Pre: kA5Info.size bytes.
[[nodiscard]] A5Identity read_a5_identity(std::span<const std::uint8_t> data);

/// Returns "model 24, firmware 1.29, serial ...".
[[nodiscard]] std::string text_of(const A5Identity& identity);

struct A5Condition {
    enum class State { kGood, kWarning, kError };
    State state = State::kGood;
    std::uint16_t code = 0; ///< the sensor's own
};

/// Pre: kA5Health.size bytes.
[[nodiscard]] A5Condition read_a5_condition(std::span<const std::uint8_t> data) noexcept;

} // namespace scanloom::robot
