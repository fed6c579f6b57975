#include "server/log/context.hpp"

namespace scanloom::log {
namespace {

constexpr Context kNone;
thread_local const Context* of_this_thread = &kNone;

} // namespace

const Context& current() noexcept { return *of_this_thread; }

namespace detail {

Scope::Scope(const Context& context) noexcept : before_(std::exchange(of_this_thread, &context)) {}
Scope::~Scope() { of_this_thread = before_; }

} // namespace detail
} // namespace scanloom::log
