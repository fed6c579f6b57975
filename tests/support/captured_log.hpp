#pragma once

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <sstream>
#include <string>

namespace scanloom::testing_support {

/// The server's log lines during the lifetime of this object.
class CapturedLog {
public:
    CapturedLog() {
        spdlog::set_default_logger(
            std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
    }
    CapturedLog(const CapturedLog&) = delete;
    CapturedLog& operator=(const CapturedLog&) = delete;
    ~CapturedLog() { spdlog::set_default_logger(earlier_); }

    /// Pre: all logging has ended.
    [[nodiscard]] std::string text() const { return text_.str(); }

private:
    std::shared_ptr<spdlog::logger> earlier_ = spdlog::default_logger();
    std::ostringstream text_;
};

} // namespace scanloom::testing_support
