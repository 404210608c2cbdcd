#pragma once
#include <string>
#include <vector>

namespace palpate::sim {

/// The processes that `mpirun` started, of which this is one; one of one without it. MPI begins and ends with
/// the object: make one, once, in the main thread.
class MpiRanks {
 public:
  MpiRanks();
  ~MpiRanks();
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }
  /// Ends the processes of all ranks, this one too, at once; `mpirun` returns `exit_code`.
  [[noreturn]] void end_all(int exit_code) const;

 private:
  int rank_ = 0, count_ = 1;
};

/// Tells the other ranks `word`; they get it from `wait_for_word`. Rank 0 only.
void send_word(int word);
/// The next word of rank 0. Waits without keeping a core busy, as rank 0 works on its own for long.
int wait_for_word();

/// Memory of one rank, and of the machine that it runs on.
struct RankMemory {
  double bytes = 0;  ///< of the rank
  double free = 0;   ///< of its machine
  int machine = 0;   ///< the lowest rank on the same one
};
/// Gathers the memory of all ranks on rank 0; empty on the others. All ranks have to call it, each with its
/// own bytes.
std::vector<RankMemory> gather_memory(double bytes);

/// "rank 2 and 3 others on its machine would take 8.1 GB, and 6.0 GB are free", or empty where all fits.
std::string shortage_of(const std::vector<RankMemory>& ranks);

}  // namespace palpate::sim
