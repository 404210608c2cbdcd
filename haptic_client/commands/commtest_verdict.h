#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::client {

/// How stiff a wall each law keeps stable, by the age of its samples: the least over linear and Hertzian
/// walls and three hands, at 30 samples a second with passivity, of `studies stability --by-delay` (5 seeds,
/// within 5 %). Between two ages the smaller one; beyond the last: not known. N/m.
std::optional<double> stable_to(std::string_view law, double age_ms);

/// What a test of a link measured, of which a verdict is made.
struct TestedLink {
  std::string law;
  double age_p99_ms = 0;               ///< of the samples, as they came
  double stiffest_n_m = 0;             ///< that the session rendered; 0: nothing was touched
  double samples_hz = 0, rate_hz = 0;  ///< that came; that the server aims for, 0: as fast as it can
  double loss_percent = 0;             ///< of samples
  bool connected = false;
};

enum class Grade { kPass, kWarn, kFail };

struct Verdict {
  Grade grade = Grade::kPass;
  std::vector<std::string>
      reasons;  ///< sentences; the first says what law, age and stiffness the grade is of
};

/// FAIL: no session, ages at which the force fades (300 ms), or a stiffness above what the law keeps stable.
/// WARN: within a factor of two of it, more than 5 % of samples lost, or fewer than 90 % of those aimed for.
Verdict judge(const TestedLink& link);

const char* name_of(Grade grade);

}  // namespace palpate::client
