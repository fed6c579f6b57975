#include "tests/fault/broken_sockets.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <sys/socket.h>
#include <unistd.h>

namespace scanloom::fault {
namespace {

constexpr std::size_t kHoarded = std::size_t{1} << 20;
constexpr std::size_t kDescriptorsMax = 65'536;

std::atomic<bool> hoards = false;
std::atomic<bool> clings = false;
std::array<std::atomic<bool>, kDescriptorsMax> was_accepted{}; // indexed by descriptor
std::mutex hoard_mutex;
std::vector<std::string> hoard; // guarded by hoard_mutex

/// Returns the system's function of that name.
template <class Function>
Function* own(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool is_clung_to(int file) {
    const auto index = static_cast<std::size_t>(file);
    return clings && file >= 0 && index < kDescriptorsMax && was_accepted[index];
}

void note_accepted(int file) {
    if (file >= 0 && static_cast<std::size_t>(file) < kDescriptorsMax) {
        was_accepted[static_cast<std::size_t>(file)] = true;
    }
    if (!hoards) return;
    const std::lock_guard lock(hoard_mutex);
    hoard.emplace_back(kHoarded, 'x'); // written, so that the memory is resident
}

} // namespace

void break_sockets(std::string_view kind) {
    hoards = kind == "hoarding";
    clings = kind == "clinging";
}

} // namespace scanloom::fault

extern "C" {

int accept(int listener, sockaddr* address, socklen_t* bytes) {
    static auto* const system = scanloom::fault::own<int(int, sockaddr*, socklen_t*)>("accept");
    const int file = system(listener, address, bytes);
    scanloom::fault::note_accepted(file);
    return file;
}

int shutdown(int file, int how) {
    static auto* const system = scanloom::fault::own<int(int, int)>("shutdown");
    return scanloom::fault::is_clung_to(file) ? 0 : system(file, how);
}

int close(int file) {
    static auto* const system = scanloom::fault::own<int(int)>("close");
    return scanloom::fault::is_clung_to(file) ? 0 : system(file);
}
}
