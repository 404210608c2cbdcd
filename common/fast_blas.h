#pragma once

namespace palpate {

/// Begins this program again, once, where OpenBLAS is older than the processor: it then takes kernels of 2004
/// (SSE3) instead of those for AVX2 or AVX-512, as it knows no later ones of a processor that is not in its
/// list (github.com/OpenMathLib/OpenBLAS/issues/4267, mended in 0.3.25; Debian 12 has 0.3.21). Factors then
/// take three times as long. It reads which kernels to take, OPENBLAS_CORETYPE, only when a program is
/// loaded. Does nothing where the user has set that, without OpenBLAS, and under valgrind, which would lose
/// the program. Call it first in `main`, with its `argv`.
void start_with_fast_blas(char** argv) noexcept;

}  // namespace palpate
