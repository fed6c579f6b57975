#pragma once

#include <filesystem>
#include <string>

namespace scanloom::testing_support {

struct CertificateFiles {
    std::filesystem::path certificate;
    std::filesystem::path key;
};

/// Writes a certificate in PEM that signs itself, for a host ("localhost") or an address ("127.0.0.1"), and its key,
/// which the owner alone may read.
/// @param valid_for_s  seconds from now on, negative for one that has expired; it is valid since a day before its end
CertificateFiles write_certificate(const std::filesystem::path& directory, const std::string& host,
                                   long valid_for_s = 23L * 3600);

} // namespace scanloom::testing_support
