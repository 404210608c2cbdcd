#pragma once

// BLAS and LAPACK, by their Fortran names.
extern "C" {
// NOLINTBEGIN(bugprone-macro-parentheses): a type is named
#define PALPATE_BLAS(S, p)                                                                                   \
  void p##gemm_(const char*, const char*, const int*, const int*, const int*, const S*, const S*,            \
                const int*, const S*, const int*, const S*, S*, const int*);                                 \
  void p##gemv_(const char*, const int*, const int*, const S*, const S*, const int*, const S*, const int*,   \
                const S*, S*, const int*);                                                                   \
  void p##symv_(const char*, const int*, const S*, const S*, const int*, const S*, const int*, const S*, S*, \
                const int*);                                                                                 \
  void p##trsm_(const char*, const char*, const char*, const char*, const int*, const int*, const S*,        \
                const S*, const int*, S*, const int*);                                                       \
  void p##trsv_(const char*, const char*, const char*, const int*, const S*, const int*, S*, const int*);    \
  void p##potrf_(const char*, const int*, S*, const int*, int*);                                             \
  void p##potri_(const char*, const int*, S*, const int*, int*);                                             \
  void p##potrs_(const char*, const int*, const int*, const S*, const int*, S*, const int*, int*);           \
  void p##syev_(const char*, const char*, const int*, S*, const int*, S*, S*, const int*, int*);             \
  void p##sygv_(const int*, const char*, const char*, const int*, S*, const int*, S*, const int*, S*, S*,    \
                const int*, int*);
PALPATE_BLAS(double, d)
PALPATE_BLAS(float, s)
#undef PALPATE_BLAS
// NOLINTEND(bugprone-macro-parentheses)
// Present in every OpenBLAS, absent from other BLAS libraries: hence weak.
void openblas_set_num_threads(int threads) __attribute__((weak));
}

namespace palpate::sim {

/// The routines of BLAS and LAPACK by the type of their numbers.
template <class Scalar>
struct Blas;
template <>
struct Blas<double> {
  static constexpr auto gemm = dgemm_;
  static constexpr auto gemv = dgemv_;
  static constexpr auto symv = dsymv_;
  static constexpr auto trsm = dtrsm_;
  static constexpr auto trsv = dtrsv_;
  static constexpr auto potrf = dpotrf_;
  static constexpr auto potri = dpotri_;
  static constexpr auto potrs = dpotrs_;
  static constexpr auto syev = dsyev_;
  static constexpr auto sygv = dsygv_;
};
template <>
struct Blas<float> {
  static constexpr auto gemm = sgemm_;
  static constexpr auto gemv = sgemv_;
  static constexpr auto symv = ssymv_;
  static constexpr auto trsm = strsm_;
  static constexpr auto trsv = strsv_;
  static constexpr auto potrf = spotrf_;
  static constexpr auto potri = spotri_;
  static constexpr auto potrs = spotrs_;
  static constexpr auto syev = ssyev_;
  static constexpr auto sygv = ssygv_;
};

}  // namespace palpate::sim
