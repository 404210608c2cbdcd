#pragma once
#include <filesystem>
#include <vector>

#include "protocol/auth.h"

namespace palpate::protocol {

/// The keys of a file, the newest last. Lines "palpate-key NUMBER HEX" (1 to 255, 64 digits); '#' begins a
/// comment. Throws `Error` that names file and line; also where others than its owner may read it.
std::vector<Key> read_keys(const std::filesystem::path& file);

/// Makes a key, and a file of mode 0600 for it; `add`: behind those that the file has, with the next number.
/// Throws `Error` where the file is there already (or, with `add`, is not).
Key add_new_key(const std::filesystem::path& file, bool add);

/// True if datagrams to or from this address stay on this machine.
bool is_loopback(const Endpoint& endpoint) noexcept;

/// Refuses to talk over a network without a key, unless somebody asked for that: throws `Error`, which begins
/// with `where` the address was given. With `insecure` it is a warning.
void require_key(const Endpoint& endpoint, bool has_key, bool insecure, const std::string& where);

}  // namespace palpate::protocol
