#pragma once
#include <string>

namespace palpate::test {

/// Where this clone lies, and where its programs are: absolute, without a slash at the end. Functions, so
/// that what a test compiles to does not depend on either: other builds find it in ccache, and no warning
/// comes with a longer path.
const std::string& source_dir();
const std::string& bin_dir();

}  // namespace palpate::test
