#include "tests/support/failing_allocation.hpp"

#include <cstdlib>
#include <new>

namespace scanloom::testing_support {

constinit thread_local std::optional<int> allocations_left;

} // namespace scanloom::testing_support

void* operator new(std::size_t size) {
    auto& left = scanloom::testing_support::allocations_left;
    if (left && (*left)-- == 0) {
        left.reset();
        throw std::bad_alloc();
    }
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
