#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Lidars as a program sees them on its line: they take requests and send measurements. What they see is simple: 1 m in
/// the direction of step 0, and more for each further step.
namespace scanloom::testing_support {

class LidarEmulator {
public:
    using Bytes = std::vector<std::uint8_t>;

    virtual ~LidarEmulator() = default;

    /// Takes bytes that the program has sent. @return the answers
    virtual Bytes receive(std::span<const std::uint8_t> bytes) = 0;

    /// Returns the bytes of the next turn. Pre: is_measuring().
    virtual Bytes next_turn() = 0;

    [[nodiscard]] virtual bool is_measuring() const = 0;

    /// Returns the commands that were received, as text.
    [[nodiscard]] const std::vector<std::string>& commands() const { return commands_; }

protected:
    std::vector<std::string> commands_;
};

/// A UST-10LX. Step n is at 1000 + n mm, except: step 100 is an error code, step 200 is beyond the range.
class HokuyoEmulator final : public LidarEmulator {
public:
    static constexpr int kSteps = 1081;

    Bytes receive(std::span<const std::uint8_t> bytes) override;
    Bytes next_turn() override;
    [[nodiscard]] bool is_measuring() const override { return !measurement_.empty(); }

private:
    [[nodiscard]] std::string answer(const std::string& command);

    std::string received_;
    std::string measurement_;                ///< its command
    std::uint32_t milliseconds_ = 0xFF'FFF0; // the clock wraps soon
};

/// The commands and the condition of a sensor with A5 requests.
struct A5Emulation {
    std::uint8_t model = 0x18;
    std::uint8_t firmware_major = 1;
    std::uint8_t firmware_minor = 15; ///< below 17: no express capsules
    std::uint8_t condition = 0;       ///< 0 good, 1 warning, 2 error
    bool is_mute = false;             ///< answers nothing
};

/// An RPLIDAR. 360 points of a turn, one per degree clockwise; degree n is at 1000 + 10 n mm, but degree 90 sees
/// nothing. With capsules: 384 points.
class RplidarEmulator final : public LidarEmulator {
public:
    explicit RplidarEmulator(A5Emulation emulation = {}) : emulation_(emulation) {}

    Bytes receive(std::span<const std::uint8_t> bytes) override;
    Bytes next_turn() override;
    [[nodiscard]] bool is_measuring() const override { return measurement_ != Measurement::kNone; }

private:
    enum class Measurement { kNone, kNodes, kCapsules };

    A5Emulation emulation_;
    Measurement measurement_ = Measurement::kNone;
    bool is_first_capsule_ = false;
    Bytes received_;
};

/// A YDLIDAR X4, or an X2, which always measures. 360 samples of a turn; the n-th is at 1000 + 10 n mm and has the
/// angle n degrees clockwise before the correction. The 90th sees nothing.
class YdlidarEmulator final : public LidarEmulator {
public:
    explicit YdlidarEmulator(bool is_x2, A5Emulation emulation = {.model = 6}) : emulation_(emulation), is_x2_(is_x2) {}

    Bytes receive(std::span<const std::uint8_t> bytes) override;
    Bytes next_turn() override;
    [[nodiscard]] bool is_measuring() const override { return is_x2_ || is_started_; }

private:
    A5Emulation emulation_;
    bool is_x2_;
    bool is_started_ = false;
    Bytes received_;
};

/// An LD06, or an STL-27L with its 180 packets per turn instead of 37.5; both always measure.
class Ld06Emulator final : public LidarEmulator {
public:
    explicit Ld06Emulator(bool is_stl27l = false) : is_stl27l_(is_stl27l) {}

    Bytes receive(std::span<const std::uint8_t>) override { return {}; }
    Bytes next_turn() override;
    [[nodiscard]] bool is_measuring() const override { return true; }

private:
    bool is_stl27l_;
    int angle_ = 0; ///< 0.01 degree
    std::int64_t microseconds_ = 0;
};

/// Returns the emulator of a model of lidar_models(), or null.
[[nodiscard]] std::unique_ptr<LidarEmulator> make_lidar_emulator(std::string_view model);

} // namespace scanloom::testing_support
