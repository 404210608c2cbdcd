#include "sim_server/distributed/mpi_ranks.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fmt/core.h>
#include <mpi.h>
#include <thread>

#include "common/memory_budget.h"

namespace palpate::sim {
namespace {

constexpr std::chrono::milliseconds kPause{1};  // between two looks for a word

/// A point as MPI passes it about.
using Row = std::array<double, 3>;

}  // namespace

MpiRanks::MpiRanks() {
  MPI_Init(nullptr, nullptr);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
}

MpiRanks::~MpiRanks() {
  MPI_Finalize();
}

void MpiRanks::end_all(int exit_code) const {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

void send_word(int word) {
  MPI_Request request{};
  MPI_Ibcast(&word, 1, MPI_INT, 0, MPI_COMM_WORLD, &request);
  MPI_Wait(&request, MPI_STATUS_IGNORE);
}

int wait_for_word() {
  int word = 0, arrived = 0;
  MPI_Request request{};
  MPI_Ibcast(&word, 1, MPI_INT, 0, MPI_COMM_WORLD, &request);
  while (true) {
    MPI_Test(&request, &arrived, MPI_STATUS_IGNORE);
    if (arrived != 0) return word;
    std::this_thread::sleep_for(kPause);
  }
}

std::vector<RankMemory> gather_memory(double bytes) {
  int rank = 0, count = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &count);
  MPI_Comm machine{};
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &machine);
  int lowest = rank;
  MPI_Bcast(&lowest, 1, MPI_INT, 0, machine);
  MPI_Comm_free(&machine);
  const Row own{bytes, free_memory(), static_cast<double>(lowest)};
  std::vector<Row> rows(static_cast<std::size_t>(count));
  MPI_Gather(own.data(), 3, MPI_DOUBLE, rows.data(), 3, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  std::vector<RankMemory> all;
  if (rank != 0) return all;
  for (const Row& row : rows) all.push_back({row[0], row[1], static_cast<int>(row[2])});
  return all;
}

std::string shortage_of(const std::vector<RankMemory>& ranks) {
  for (int first = 0; first < static_cast<int>(ranks.size()); ++first) {
    double bytes = 0;
    int others = -1;
    for (const RankMemory& rank : ranks) {
      if (rank.machine != first) continue;
      bytes += rank.bytes;
      ++others;
    }
    if (bytes > ranks[static_cast<std::size_t>(first)].free)
      return fmt::format("rank {} and {} others on its machine would take {}, and {} are free there", first,
                         others, bytes_text(bytes), bytes_text(ranks[static_cast<std::size_t>(first)].free));
  }
  return {};
}

}  // namespace palpate::sim
