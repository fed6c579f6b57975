#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <string_view>

namespace scanloom::wire {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline void expect_refused(std::string_view body, Errc code, const std::string& beginning) {
    const auto decoded = decode(body);
    ASSERT_FALSE(decoded) << "instead of: " << beginning;
    EXPECT_EQ(decoded.error().code, code) << decoded.error().message;
    EXPECT_THAT(decoded.error().message, testing::StartsWith(beginning));
}

/// A modification that makes a message invalid, and the beginning of the expected error message.
template <class Value>
struct InvalidCase {
    void (*make_invalid)(Value&);
    const char* beginning;
    Errc code = Errc::kInvalidField;
};

} // namespace scanloom::wire
