#pragma once
/// Memory is asked for only where there is some: what would not fit is refused before it is allocated.
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// Bytes that this process can still take: MemAvailable of /proc/meminfo, or what the memory limits of its
/// control groups (version 2) leave, caches counted as free, if that is less. Infinite where nothing tells.
/// `root`: the folder that holds proc/ and sys/. Set-up only: it reads files.
double free_memory(const std::filesystem::path& root = "/");

/// Resident memory of this process now but for pages of files (programs and libraries, which a child gets as
/// it uses them), bytes; 0 where the system does not tell.
double resident_memory();

/// "2.6 GB", "27 MB".
std::string bytes_text(double bytes);

/// Throws `Error` "WHERE: WHAT would take 2.6 GB, and 1.9 GB are free; REMEDY" where `bytes` are more than
/// `free`; names `ulimit -v` where that leaves no more.
void require_memory(double bytes, double free, std::string_view where, std::string_view what,
                    std::string_view remedy);

}  // namespace palpate
