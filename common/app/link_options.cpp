#include "common/app/link_options.hpp"

#include "common/app/command_line.hpp"
#include "common/net/server_list.hpp"

#include <CLI/CLI.hpp>

namespace scanloom {

void add_link_options(CLI::App& app, LinkOptions& options, const std::string& token_help) {
    const auto enable_tls = [&options](const std::string&) { options.tls = true; };
    add_parsed(app, "--server", options.servers,
               "Robot port of the server, HOST:PORT; of several servers that share a store, "
               "HOST:PORT,HOST:PORT,... in any order",
               net::parse_addresses)
        ->default_str(net::text_of(options.servers));
    app.add_option("--token-file", options.token_file, token_help)->check(CLI::ExistingFile);
    app.add_flag("--tls", options.tls, "Encrypt the link, and verify that the server is the one that --server names");
    app.add_option("--tls-ca", options.tls_ca_file,
                   "File with the certificates to trust, in PEM, instead of the system's; means --tls")
        ->check(CLI::ExistingFile)
        ->each(enable_tls);
    auto* certificate =
        app.add_option("--tls-cert", options.tls_cert_file,
                       "File with the client certificate for a server that requires one, in PEM; means --tls")
            ->check(CLI::ExistingFile)
            ->each(enable_tls);
    auto* key = app.add_option("--tls-key", options.tls_key_file, "File with its private key, without a password")
                    ->check(CLI::ExistingFile);
    certificate->needs(key);
    key->needs(certificate);
}

Result<net::TlsContext> tls_of(const LinkOptions& options, bool encrypted) {
    if (!encrypted) return net::TlsContext();
    return net::client_tls(options.tls_ca_file, {options.tls_cert_file, options.tls_key_file});
}

} // namespace scanloom
