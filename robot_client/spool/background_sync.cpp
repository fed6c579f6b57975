#include "robot_client/spool/background_sync.hpp"

#include <boost/asio/post.hpp>
#include <fcntl.h>
#include <unistd.h>

#include <memory>

namespace scanloom::robot {

void BackgroundSync::wrote(const FileHandle& file, Time now) {
    if (now < next_ || busy_.exchange(true)) return;
    next_ = now + kPeriod;
    // The file may be closed before the thread comes to it. (A job must be copyable here, a handle is not.)
    const auto own = std::make_shared<FileHandle>(::fcntl(file.get(), F_DUPFD_CLOEXEC, 0));
    boost::asio::post(thread_, [this, own] {
        if (*own) ::fdatasync(own->get()); // a disk that fails tells so at the next write
        busy_ = false;
    });
}

} // namespace scanloom::robot
