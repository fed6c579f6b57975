#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace scanloom::testing_support {

/// The sensor's end of a pseudo-terminal.
class PseudoTerminal {
public:
    PseudoTerminal() : descriptor_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
        if (descriptor_ < 0 || ::grantpt(descriptor_) != 0 || ::unlockpt(descriptor_) != 0) {
            throw std::runtime_error("no pseudo-terminal");
        }
        device_ = ::ptsname(descriptor_);
    }
    PseudoTerminal(const PseudoTerminal&) = delete;
    PseudoTerminal& operator=(const PseudoTerminal&) = delete;
    ~PseudoTerminal() {
        hang_up();
        if (other_end_ >= 0) ::close(other_end_);
    }

    /// Opens the other end in raw mode, so that bytes sent before the program opens the device stay unchanged.
    void keep_open() {
        other_end_ = ::open(device_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
        termios raw{};
        if (::tcgetattr(other_end_, &raw) != 0) throw std::runtime_error("no settings of a pseudo-terminal");
        ::cfmakeraw(&raw);
        if (::tcsetattr(other_end_, TCSANOW, &raw) != 0) throw std::runtime_error("a pseudo-terminal cannot be set");
    }

    [[nodiscard]] const std::string& device() const { return device_; }
    /// Returns another descriptor of the sensor's end, which the caller owns.
    [[nodiscard]] int duplicate() const { return ::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0); }
    void hang_up() {
        if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
    }

protected:
    int descriptor_;

private:
    int other_end_ = -1;
    std::string device_;
};

} // namespace scanloom::testing_support
