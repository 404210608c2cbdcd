#include "common/fast_blas.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <string_view>
#include <unistd.h>

namespace palpate {
namespace {

constexpr const char* kVariable = "OPENBLAS_CORETYPE";

/// The kernels for what this processor can do; null: nothing newer than what is taken without a word.
const char* kernels_of_processor() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return "SkylakeX";
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
  return nullptr;
}

/// True if OpenBLAS is there, and took kernels that know neither AVX2 nor AVX-512.
bool has_old_kernels() {
  constexpr std::array<std::string_view, 6> kOld{"Prescott",   "Core2",   "Penryn",
                                                 "Dunnington", "Nehalem", "Sandybridge"};
  using CoreName = char* (*)();
  const auto core_name = reinterpret_cast<CoreName>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  return core_name != nullptr && std::ranges::find(kOld, std::string_view(core_name())) != kOld.end();
}

bool is_under_valgrind() {
  const char* const preloaded = std::getenv("LD_PRELOAD");
  return preloaded != nullptr && std::strstr(preloaded, "vgpreload") != nullptr;
}

}  // namespace

void start_with_fast_blas(char** argv) noexcept {
  const char* const kernels = kernels_of_processor();
  if (kernels == nullptr || std::getenv(kVariable) != nullptr || is_under_valgrind() || !has_old_kernels())
    return;
  std::array<char, PATH_MAX> program{};
  if (readlink("/proc/self/exe", program.data(), program.size() - 1) <= 0) return;
  if (setenv(kVariable, kernels, 1) != 0) return;
  execv(program.data(), argv);  // returns only where that cannot be: it goes on as it is
}

}  // namespace palpate
