#ifdef PALPATE_WITH_CAPTURE
#include "haptic_client/evaluation/captured_session.h"

#include <map>

#include "common/error.h"
#include "haptic_client/evaluation/resampler.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/session_capture.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::client;
using protocol::ForceSample;
using protocol::ToolState;
using test::CaptureOf;
using test::TemporaryFolder;
using namespace std::chrono_literals;

namespace {

const auto kQuiet = [](double) {};

ToolState state_at(std::uint64_t tick, std::uint64_t newest_sample) {
  const auto x = static_cast<double>(tick);
  return {.tick = tick,
          .newest_sample = newest_sample,
          .t_ns = static_cast<std::int64_t>(tick) * 2'000'000,
          .p_W = {x, 0, 0}};
}
ForceSample sample_of(std::uint64_t number) {
  return {.number = number,
          .tool_tick = 10 * number,
          .tool_t_ns = static_cast<std::int64_t>(number) * 20'000'000,
          .f_W = {0, static_cast<double>(number), 0}};
}

std::vector<CapturedTick> all_ticks(const std::filesystem::path& file, std::size_t run,
                                    CapturedSession::Missing* missing = nullptr) {
  CapturedSession session(file, run);
  std::vector<CapturedTick> ticks;
  for (CapturedTick tick; session.next(tick);) ticks.push_back(tick);
  if (missing != nullptr) *missing = session.missing();
  return ticks;
}

}  // namespace

TEST_CASE(
    "a capture that the network shuffled and doubled gives its ticks in order, each once, with its sample") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    // Ticks 1..200, sample n known from tick 10 n + 12 on; every group of five ticks stands in reverse.
    std::uint64_t sequence = 0;
    for (std::uint64_t group = 0; group < 40; ++group) {
      if (group % 2 == 0 && group > 0) capture.sample(sample_of(group / 2), group / 2);
      for (std::uint64_t i = 0; i < 5; ++i) {
        const std::uint64_t tick = 5 * group + 5 - i;
        ++sequence;
        for (int copies = 0; copies < 2; ++copies)
          capture.state(state_at(tick, tick < 22 ? 0 : (tick - 12) / 10), tick);
      }
    }
    capture.close();
  }
  const CaptureSurvey found = survey(file, kQuiet);
  REQUIRE(found.runs.size() == 1);
  CHECK(found.runs[0].ticks == 200);
  CHECK(found.runs[0].samples == 19);
  CHECK(found.runs[0].duplicated() == 200);
  CHECK(found.runs[0].ticks_hz() == Approx(500));
  CapturedSession::Missing missing;
  const auto ticks = all_ticks(file, 0, &missing);
  REQUIRE(ticks.size() == 200);
  for (std::uint64_t i = 0; i < 200; ++i) {
    const std::uint64_t tick = i + 1;
    CHECK(ticks[i].state.tick == tick);
    const bool first = tick >= 22 && tick % 10 == 2;
    REQUIRE(ticks[i].arrived.has_value() == first);
    if (first) CHECK(ticks[i].arrived->number == (tick - 12) / 10);
  }
  CHECK(missing.ticks + missing.samples + missing.backwards == 0);
}

TEST_CASE("a capture begun in mid-session and with holes says what is missing") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1000; tick < 1100; ++tick) {
      if (tick % 10 == 0 && tick != 1050) capture.sample(sample_of(tick / 10), tick / 10);
      if (tick < 1020 || tick >= 1027) capture.state(state_at(tick, tick / 10), tick);
    }
    capture.close();
  }
  const CaptureSurvey found = survey(file, kQuiet);
  CHECK(found.runs[0].first_tick == 1000);
  CHECK(found.runs[0].lost() == 7 + 1);  // those in the hole, not the 999 before the capture
  CapturedSession::Missing missing;
  const auto ticks = all_ticks(file, 0, &missing);
  CHECK(ticks.size() == 93);
  CHECK(missing.ticks == 7);
  CHECK(missing.samples == 1);
  CHECK(ticks.front().arrived->number == 100);
}

TEST_CASE(
    "pages of the surface come to the tick that was the first to have them, in their order, lost ones are "
    "missed") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 40; ++tick) {
      if (tick % 10 == 0) {
        for (std::uint32_t i = 0; i < 3; ++i)  // the second of tick 30 is lost
          if (tick != 30 || i != 1)
            capture.page({.version = 5, .page = static_cast<std::uint32_t>(tick) + i}, tick + i);
      }
      ToolState state = state_at(tick, 0);
      state.flags = ToolState::kRequestsSurface;
      state.pages_taken = tick < 12 ? 0 : tick < 14 ? 2 : 3 * (tick / 10);
      capture.state(state, tick);
    }
    capture.close();
  }
  CapturedSession::Missing missing;
  std::map<std::uint64_t, std::vector<std::uint32_t>> pages;
  for (const CapturedTick& tick : all_ticks(file, 0, &missing)) {
    for (const auto& page : tick.pages) pages[tick.state.tick].push_back(page.page);
  }
  using Numbers = std::vector<std::uint32_t>;
  CHECK(pages[12] == Numbers{10, 11});
  CHECK(pages[14] == Numbers{12});
  CHECK(pages[20] == Numbers{20, 21, 22});
  CHECK(pages[30] == Numbers{30, 32, 40});  // counted, not named: the third is the next that came
  CHECK(pages[40] == Numbers{41, 42});
  CHECK(missing.pages == 1);
}

TEST_CASE("ticks that a slow link left out, and pages of that time, are counted apart from lost ones") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    std::uint64_t sequence = 0;
    for (std::uint64_t tick = 1; tick <= 300; ++tick) {
      const bool sparse = tick > 100 && tick <= 200;
      if (sparse && tick % 10 != 0) continue;  // one in ten travels
      ++sequence;
      if (sequence == 105) continue;  // lost, with the nine before it, which never travelled
      if (tick == 50 || tick == 110)
        capture.page({.version = 5, .page = static_cast<std::uint32_t>(tick)}, tick);
      ToolState state = state_at(tick, 0);
      if (!sparse) {
        state.flags = ToolState::kRequestsSurface;
        state.pages_taken = tick < 50 ? 0 : tick <= 100 ? 1 : 2;
      }
      capture.state(state, sequence);
    }
    capture.close();
  }
  CapturedSession::Missing missing;
  std::map<std::uint64_t, std::size_t> pages;
  const auto ticks = all_ticks(file, 0, &missing);
  for (const CapturedTick& tick : ticks)
    if (!tick.pages.empty()) pages[tick.state.tick] = tick.pages.size();
  CHECK(ticks.size() == 100 + 9 + 100);
  CHECK(missing.left_out == 8 * 9);
  CHECK(missing.ticks == 19);
  CHECK(missing.pages == 0);
  CHECK(pages == std::map<std::uint64_t, std::size_t>{{50, 1}, {201, 1}});
  CHECK(missing.undated == 1);
}

TEST_CASE("ticks whose times jump back, or lie before time began, are left out and counted") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 50; ++tick) {
      ToolState state = state_at(tick, 0);
      if (tick == 20) state.t_ns -= 10'000'000;
      if (tick == 30) state.t_ns = std::numeric_limits<std::int64_t>::min();  // no time: refused
      if (tick == 40) state.t_ns = std::numeric_limits<std::int64_t>::max();
      capture.state(state, tick);
    }
    capture.close();
  }
  CapturedSession::Missing missing;
  CHECK(all_ticks(file, 0, &missing).size() == 47);
  CHECK(missing.backwards == 1);
  CHECK(survey(file, kQuiet).runs[0].ticks_hz() == Approx(500));
}

TEST_CASE("a tick whose time jumps ahead is left out, not all that follow") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 50; ++tick) {
      ToolState state = state_at(tick, 0);
      if (tick == 20) state.t_ns = std::int64_t{1} << 60;
      capture.state(state, tick);
    }
    capture.close();
  }
  CapturedSession::Missing missing;
  CHECK(all_ticks(file, 0, &missing).size() == 49);
  CHECK(missing.backwards == 1);
}

TEST_CASE("stragglers of a session that is over stay with their run") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 500; ++tick) {
      const bool old = tick <= 300;
      capture.state(state_at(tick, 0), old ? tick : tick - 300, old ? 7 : 8);
      if (tick == 305) capture.sample(sample_of(30), 31, 7);
      if (tick == 306) capture.state(state_at(299, 0), 299, 7);  // a copy
    }
    capture.close();
  }
  const CaptureSurvey found = survey(file, kQuiet);
  REQUIRE(found.runs.size() == 1);
  CHECK(found.runs[0].ticks == 500);
  CHECK(found.runs[0].samples == 1);
  CHECK(found.runs[0].duplicated() == 1);
}

TEST_CASE("two clients in one capture are two sessions, a restarted server is the same one") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 300; ++tick) {
      // The server of client 5000 starts again at tick 201: another session, sequences and samples from 1.
      const std::uint64_t session = tick <= 200 ? 7 : 8, base = tick <= 200 ? 0 : 200;
      if (tick % 10 == 0)
        capture.sample(sample_of((tick - base) / 10 + (base ? 1 : 0)), (tick - base) / 10 + 1, session);
      capture.state(state_at(tick, (tick - base) / 10 + (base && tick >= 210 ? 1
                                                         : base              ? 20
                                                                             : 0)),
                    tick - base, session);
      if (tick <= 100) capture.state(state_at(tick, 0), tick, 9, 6000);
    }
    // Client 6000 is started again with the same port: its ticks count from 1.
    for (std::uint64_t tick = 1; tick <= 20; ++tick) capture.state(state_at(tick, 0), tick, 10, 6000);
    capture.close();
  }
  const CaptureSurvey found = survey(file, kQuiet);
  REQUIRE(found.runs.size() == 3);
  CHECK(found.runs[0].ticks == 300);
  CHECK(found.runs[1].ticks == 100);
  CHECK(found.runs[2].ticks == 20);
  CapturedSession::Missing missing;
  const auto ticks = all_ticks(file, 0, &missing);
  REQUIRE(ticks.size() == 300);
  CHECK(missing.samples == 0);
  CHECK(ticks[19].arrived->number == 2);
  CHECK(ticks[19].arrived->tool_tick == 20);
  REQUIRE(ticks[209].arrived);
  CHECK(ticks[209].arrived->number == 2);
  CHECK(all_ticks(file, 1).size() == 100);
  CHECK(all_ticks(file, 2).size() == 20);
}

TEST_CASE("each session of a capture is of the scene of its own Welcome, and the first one counts") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  const protocol::ScenePrint one{.mesh = 1}, other{.mesh = 2};
  {
    CaptureOf capture(file);
    capture.welcome({.tool_radius = 0.005, .scene = one}, 7);
    capture.welcome({.tool_radius = 0.005, .scene = other}, 8, 6000);
    capture.welcome({.tool_radius = 0.005}, 9, 7000);  // of a server that does not say
    for (std::uint64_t tick = 1; tick <= 20; ++tick) {
      capture.state(state_at(tick, 0), tick, 7, 5000);
      capture.state(state_at(tick, 0), tick, 8, 6000);
      capture.state(state_at(tick, 0), tick, 9, 7000);
      capture.state(state_at(tick, 0), tick, 10, 8000);
    }
    capture.welcome({.tool_radius = 0.005, .scene = other}, 7);
    capture.close();
  }
  const CaptureSurvey found = survey(file, kQuiet);
  REQUIRE(found.runs.size() == 4);
  CHECK(found.runs[0].links[0].scene == one);
  CHECK(found.runs[1].links[0].scene == other);
  CHECK_FALSE(found.runs[2].links[0].scene);
  CHECK_FALSE(found.runs[3].links[0].scene);
}

TEST_CASE("a session whose client changes its address, and then its session, stays one run") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 300; ++tick) {
      const std::uint16_t port = tick <= 100 ? 5000 : 5001;
      const std::uint64_t session = tick <= 200 ? 7 : 8, base = tick <= 200 ? 0 : 200;
      if (tick % 10 == 0)
        capture.sample(sample_of((tick - base) / 10), (tick - base) / 10 + 1, session, port);
      capture.state(state_at(tick, 0), tick - base, session, port);
      if (tick == 150) capture.state(state_at(99, 0), 99, 7, 5000);  // a copy of before
    }
    capture.close();
  }
  const CaptureSurvey found = survey(file, kQuiet);
  REQUIRE(found.runs.size() == 1);
  CHECK(found.runs[0].ticks == 300);
  CHECK(found.runs[0].samples == 30);
  CHECK(found.runs[0].duplicated() == 1);
}

TEST_CASE("a capture with nothing of ours, or of another version, is an error that says so") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  CaptureOf capture(file);
  capture.close();
  CHECK_THROWS_WITH(survey(file, kQuiet), Catch::Contains("a.pcap: holds no tool states"));
  capture.raw({std::byte{1}, std::byte{2}});
  capture.sample(sample_of(1), 1);
  capture.close();
  CHECK_THROWS_WITH(survey(file, kQuiet),
                    Catch::Contains("holds no tool states") && Catch::Contains("2 packets, 1 of them ours"));
  const auto other = folder.path() / "b.pcap";
  CaptureOf version3(other);
  std::vector<std::byte> bytes(protocol::kMaxDatagram);
  bytes.resize(protocol::encode({7, 1}, state_at(1, 0), bytes));
  bytes[4] = std::byte{3};
  version3.raw(bytes);
  version3.close();
  CHECK_THROWS_WITH(survey(other, kQuiet), Catch::Contains("version 3, this program knows version 2"));
}

TEST_CASE("a capture of one tick and one sample has one tick with that sample") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    capture.sample(sample_of(1), 1);
    capture.state(state_at(12, 1), 1);
    capture.close();
  }
  CHECK(survey(file, kQuiet).runs[0].ticks_hz() == 0);
  const auto ticks = all_ticks(file, 0);
  REQUIRE(ticks.size() == 1);
  CHECK(ticks[0].arrived->number == 1);
}

TEST_CASE(
    "at another rate: poses on the line between, and each sample from the first tick on that knows it") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 101; ++tick) {
      if (tick % 10 == 0) capture.sample(sample_of(tick / 10), tick / 10);
      capture.state(state_at(tick, tick / 10), tick);
    }
    capture.close();
  }
  for (const double rate : {1000.0, 500.0, 300.0, 70.0}) {
    CAPTURE(rate);
    CapturedSession session(file, 0);
    Resampler resampler(session, rate);
    std::uint64_t k = 0, newest = 0;
    for (CapturedTick tick; resampler.next(tick); ++k) {
      const double t = 0.002 + static_cast<double>(k) / rate;
      CHECK(tick.state.tick == k + 1);
      CHECK(1e-9 * static_cast<double>(tick.state.t_ns) == Approx(t));
      CHECK(tick.state.p_W[0] == Approx(t / 0.002));  // tick number n stands at x = n
      const auto known = static_cast<std::uint64_t>((t + 1e-9) / 0.020);
      if (tick.arrived) newest = tick.arrived->number;
      CHECK(newest == known);
    }
    CHECK(k == static_cast<std::uint64_t>(0.2 * rate + 1e-6) + 1);
  }
}

TEST_CASE("states of a tool that waits to be let in are no ticks of its session") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t k = 1; k <= 3; ++k)
      capture.state({.tick = 1, .t_ns = static_cast<std::int64_t>(k), .flags = ToolState::kDeviceLost}, k);
    for (std::uint64_t tick = 1; tick <= 101; ++tick) {
      ToolState state = state_at(tick, 0);
      state.t_ns += 3600'000'000'000;  // up for an hour by then
      capture.state(state, 3 + tick);
    }
    capture.close();
  }
  CHECK(survey(file, kQuiet).runs[0].ticks_hz() == Approx(500));
  const auto ticks = all_ticks(file, 0);
  REQUIRE(ticks.size() == 101);
  CHECK(ticks[0].state.flags == 0);
}

TEST_CASE("at a higher rate what lasts until the next tick is of all ticks until then") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 100; ++tick) {
      ToolState state = state_at(tick, 0);
      if (tick >= 30 && tick < 60) state.flags = ToolState::kClutched;
      capture.state(state, tick);
    }
    capture.close();
  }
  CapturedSession session(file, 0);
  Resampler resampler(session, 2000);
  int clutched = 0;
  for (CapturedTick tick; resampler.next(tick);) clutched += tick.state.flags == ToolState::kClutched ? 1 : 0;
  CHECK(clutched == 4 * 30);
}

TEST_CASE("at another rate no event of a tick is lost or doubled, and a long gap is not filled") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    for (std::uint64_t tick = 1; tick <= 100; ++tick) {
      ToolState state = state_at(tick, 0);
      if (tick == 30) state.flags = ToolState::kDeviceLost;
      if (tick == 63) state.flags = ToolState::kRearmed;
      if (tick > 80) state.t_ns += 3600'000'000'000;
      capture.state(state, tick);
    }
    capture.close();
  }
  for (const double rate : {2000.0, 500.0, 100.0}) {
    CAPTURE(rate);
    CapturedSession session(file, 0);
    Resampler resampler(session, rate);
    std::map<int, int> events;
    std::size_t ticks = 0;
    for (CapturedTick tick; resampler.next(tick); ++ticks) ++events[tick.state.flags];
    CHECK(events[ToolState::kDeviceLost] ==
          std::max(1, static_cast<int>(rate / 500)));  // it lasts for a tick
    CHECK(events[ToolState::kRearmed] == 1);
    CHECK(static_cast<double>(ticks) == Approx(0.2 * rate).margin(3 + 0.002 * rate));
  }
}
#endif
