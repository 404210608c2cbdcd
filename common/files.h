#pragma once
#include <filesystem>

namespace palpate {

/// Throws `Error` unless there is a file at `path`, which can be read as often as one likes: of a folder, a
/// pipe and a device it says what they are; the latter two would let the program wait, perhaps for ever.
/// `content`: what the file should hold, for the message: "a mesh".
void require_file(const std::filesystem::path& path, const char* content);

}  // namespace palpate
