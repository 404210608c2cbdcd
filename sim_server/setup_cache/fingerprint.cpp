#include "sim_server/setup_cache/fingerprint.h"

#define XXH_INLINE_ALL
#include <fmt/core.h>
#include <fstream>
#include <iterator>
#include <xxhash.h>

namespace palpate::sim {
namespace {

/// The lines of /proc/cpuinfo that say what the first processor is and can do.
std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, said;
  while (std::getline(info, line) && !line.empty()) {
    if (line.starts_with("model name") || line.starts_with("flags") || line.starts_with("Features"))
      said += line;
  }
  return said;
}

/// Digest of the running program's file; of no bytes where it cannot be read.
Digest program() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  Fingerprint fingerprint(Fingerprint::For::kAnyBuild);
  fingerprint.add(std::span<const char>(bytes));
  return fingerprint.digest();
}

}  // namespace

struct Fingerprint::State {
  XXH3_state_t hash;
};

std::string to_text(const Digest& digest) {
  return fmt::format("{:016x}{:016x}", digest[0], digest[1]);
}

Fingerprint::Fingerprint(For whom) : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(&state_->hash);
  if (whom == For::kAnyBuild) return;
  static const Digest self = program();
  static const std::string cpu = processor();
  add(std::span<const std::uint64_t>(self));
  add(std::span<const char>(cpu));
}

Fingerprint::~Fingerprint() = default;

void Fingerprint::add_bytes(std::span<const std::byte> bytes) {
  const std::uint64_t size = bytes.size();  // so that two spans are not one
  XXH3_128bits_update(&state_->hash, &size, sizeof(size));
  XXH3_128bits_update(&state_->hash, bytes.data(), bytes.size());
}

Digest Fingerprint::digest() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_->hash);
  return {hash.high64, hash.low64};
}

}  // namespace palpate::sim
