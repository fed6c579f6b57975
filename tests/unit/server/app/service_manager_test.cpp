#include "server/app/service_manager.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gtest/gtest.h>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

namespace scanloom::app {
namespace {

/// Listens as systemd does, and names itself in the environment as long as it lives.
class ServiceManager {
public:
    explicit ServiceManager(const std::string& name) : descriptor_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, name.data(), name.size());
        if (name.front() == '@') address.sun_path[0] = '\0';
        const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
        EXPECT_EQ(::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), size), 0);
        ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
    }
    ~ServiceManager() {
        ::unsetenv("NOTIFY_SOCKET");
        ::close(descriptor_);
    }
    ServiceManager(const ServiceManager&) = delete;
    ServiceManager& operator=(const ServiceManager&) = delete;

    /// Returns the next datagram that was sent; empty if there is none.
    [[nodiscard]] std::string heard() const {
        std::array<char, 256> bytes{};
        const auto size = ::recv(descriptor_, bytes.data(), bytes.size(), 0);
        return size < 0 ? std::string() : std::string(bytes.data(), static_cast<std::size_t>(size));
    }

private:
    int descriptor_;
};

TEST(ServiceManagerTest, ReceivesEachStateAsOneDatagram) {
    const TemporaryDirectory place;
    for (const auto& name : {(place.path() / "notify").string(), "@scanloom-test-" + std::to_string(::getpid())}) {
        const ServiceManager manager(name);
        notify_service_manager("READY=1");
        notify_service_manager("STOPPING=1");
        EXPECT_EQ(manager.heard(), "READY=1") << name;
        EXPECT_EQ(manager.heard(), "STOPPING=1") << name;
        EXPECT_EQ(manager.heard(), "");
    }
}

TEST(ServiceManagerTest, DoesNothingWithoutListener) {
    notify_service_manager("READY=1");
    for (const std::string& name : {std::string(), std::string("/nowhere/notify"), std::string(200, 'x')}) {
        ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
        notify_service_manager("READY=1");
    }
    ::unsetenv("NOTIFY_SOCKET");
}

} // namespace
} // namespace scanloom::app
