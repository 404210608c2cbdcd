#pragma once
#include "sim_server/sparse/elimination_tree.h"

namespace palpate::sim {

/// Order of elimination that keeps the Cholesky factor sparse. Of two orders, the one that takes fewer
/// multiplications: nested dissection by METIS (Karypis and Kumar 1998, SIAM J. Sci. Comput. 20:359), which
/// is better for organs, and minimum degree by AMD (Amestoy, Davis and Duff 1996, SIAM J. Matrix Anal. Appl.
/// 17:886), which is better for slender bodies and fewer than some 300 vertices. The same order in each run
/// and on each thread; one thread at a time. Throws `std::bad_alloc`. Set-up only.
Elimination fill_reducing_order(const MatrixGraph& graph);

}  // namespace palpate::sim
