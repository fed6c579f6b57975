#include "tests/fault/loop_disk.hpp"

#include "tests/support/child_process.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <linux/fs.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>
#include <vector>

namespace scanloom::fault {
namespace {

namespace fs = std::filesystem;

// From the kernel's fs/ext4/ext4.h: FS_IOC_SHUTDOWN, and its mode that does not even write out the journal.
constexpr unsigned long kShutdown = 0x8004587d;
constexpr std::uint32_t kWithoutLogFlush = 2;

Error cannot(std::string_view what) { return {Errc::kUnreachable, fmt::format("no loop device: {}", what)}; }

/// Returns the first line that a system program prints.
Result<std::string> output_of(const std::string& program, const std::vector<std::string>& words, const fs::path& log) {
    test::ChildProcess process(program, words, log);
    const auto line = process.read_line();
    if (const int code = process.wait(); code != 0) {
        std::string said;
        std::getline(std::ifstream(log), said);
        return cannot(fmt::format("{} exited with {}: {}", program, code, said));
    }
    return line.value_or("");
}

} // namespace

Result<std::unique_ptr<LoopDisk>> LoopDisk::make(const fs::path& image, const fs::path& mount_point,
                                                 std::uint64_t bytes) {
    if (::geteuid() != 0) return cannot("root is required");
    const fs::path log = image.string() + ".log";
    std::ofstream(image).close();
    fs::resize_file(image, bytes);
    auto made = output_of("/sbin/mkfs.ext4", {"-q", "-F", image.string()}, log);
    if (!made) return made.error();
    auto device = output_of("/sbin/losetup", {"--find", "--show", image.string()}, log);
    if (!device) return device.error();
    std::unique_ptr<LoopDisk> disk(new LoopDisk(*device, mount_point));
    fs::create_directories(mount_point);
    if (auto mounted = disk->mount(); !mounted) return mounted.error();
    fs::remove(mount_point / "lost+found"); // a store needs an empty directory
    return disk;
}

LoopDisk::~LoopDisk() {
    if (is_mounted_) ::umount2(mount_point_.c_str(), MNT_DETACH);
    (void)output_of("/sbin/losetup", {"--detach", device_}, "/dev/null");
}

Result<> LoopDisk::mount() {
    if (::mount(device_.c_str(), mount_point_.c_str(), "ext4", 0, nullptr) != 0) {
        return cannot(fmt::format("{} cannot be mounted: {}", device_, std::generic_category().message(errno)));
    }
    is_mounted_ = true;
    return {};
}

void LoopDisk::cut_power() const {
    std::uint32_t how = kWithoutLogFlush;
    control(kShutdown, &how, "FS_IOC_SHUTDOWN");
}

std::shared_ptr<const void> LoopDisk::freeze() const {
    control(FIFREEZE, nullptr, "FIFREEZE");
    return {this, [](const LoopDisk* disk) { disk->control(FITHAW, nullptr, "FITHAW"); }};
}

void LoopDisk::control(unsigned long what, void* how, const char* name) const {
    const int directory = ::open(mount_point_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const int done = directory < 0 ? -1 : ::ioctl(directory, what, how);
    const int reason = errno;
    if (directory >= 0) ::close(directory);
    if (done != 0) throw std::system_error(reason, std::generic_category(), name);
}

void LoopDisk::mount_again() {
    if (::umount2(mount_point_.c_str(), 0) != 0) throw std::system_error(errno, std::generic_category(), "umount");
    is_mounted_ = false;
    mount().value();
}

} // namespace scanloom::fault
