#pragma once
#include <array>

namespace palpate::emulation {

/// What can go wrong with a Falcon. 0: it does not. Counters count down as the fault happens.
struct FalconFaults {
  int loader_silent = 0, loader_fails = 0, echo_corrupt = 0, loader_zero = 0, loader_xoff = 0;
  int split = 0, join = 0, status_flood = 0, garbage = 0, zero_in = 0, stale = 0, stall = 0;
  int latency = 0, mute = 0, hang = 0, freeze = 0;
};

struct FalconFault {
  const char* name;
  int FalconFaults::*value;
  const char* meaning;
};

inline constexpr std::array<FalconFault, 16> kFalconFaults{{
    {"loader_silent", &FalconFaults::loader_silent,
     "the next N greetings of the boot loader are not answered"},
    {"loader_fails", &FalconFaults::loader_fails, "in the next N loads the echo stops after 1000 bytes"},
    {"echo_corrupt", &FalconFaults::echo_corrupt,
     "in the next N loads byte 2000 is echoed with a flipped bit"},
    {"loader_zero", &FalconFaults::loader_zero, "1: a zero byte stands before the answer to the greeting"},
    {"loader_xoff", &FalconFaults::loader_xoff, "1: a byte 13 hex stands before the echo of 41 hex"},
    {"split", &FalconFaults::split, "1: every reply comes in two IN packets, 14 + 2 bytes"},
    {"join", &FalconFaults::join, "1: a reply waits 3 ms for the next one, and both come in one IN packet"},
    {"status_flood", &FalconFaults::status_flood,
     "N IN packets without data stand before every one with data"},
    {"garbage", &FalconFaults::garbage, "N bytes of garbage stand before the '<' of every reply"},
    {"zero_in", &FalconFaults::zero_in, "the next N IN transfers end with 0 bytes"},
    {"stale", &FalconFaults::stale, "N bytes of an old reply wait when the device is opened, until a purge"},
    {"stall", &FalconFaults::stall, "the next N control requests of the chip stall"},
    {"latency", &FalconFaults::latency, "every answer comes N ms late (of the wall clock)"},
    {"mute", &FalconFaults::mute, "1: the microcontroller does not answer; the chip still sends its status"},
    {"hang", &FalconFaults::hang, "1: IN transfers never end, not even by a status"},
    {"freeze", &FalconFaults::freeze, "1: the encoders stand still in every reply"},
}};

}  // namespace palpate::emulation
