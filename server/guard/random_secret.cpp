#include "server/guard/random_secret.hpp"

#include "server/access/secret.hpp"

#include <openssl/rand.h>

#include <array>
#include <cstddef>
#include <stdexcept>

namespace scanloom::guard {

std::string random_secret() {
    std::array<std::byte, 32> random{};
    if (RAND_bytes(reinterpret_cast<unsigned char*>(random.data()), static_cast<int>(random.size())) != 1)
        throw std::runtime_error("the system gives no random numbers, so no secret can be made");
    return access::secret_of(random);
}

} // namespace scanloom::guard
