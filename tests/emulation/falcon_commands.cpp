// What the control socket can do to a Falcon, and what it can ask.
#include <algorithm>

#include "tests/emulation/falcon.h"
#include "tests/emulation/json.h"

namespace palpate::emulation {
namespace {

constexpr double kFarOut = 0.172, kFarIn = 0.080, kPullTime = 0.5;  // m, m, s: the motion of homing
const Vec kRest{0, 0, 0.110};                                       // m

void need(const Words& words, std::size_t least, std::size_t most, const char* form) {
  if (words.size() < least || words.size() > most) throw CommandError(std::string("expected ") + form);
}

Vec point(const Words& words, std::size_t first) {
  return {number(words[first], -0.3, 0.3), number(words[first + 1], -0.3, 0.3),
          number(words[first + 2], -0.3, 0.3)};
}

}  // namespace

std::string Falcon::command(const std::string& verb, const Words& arguments, double now) {
  advance(now);
  if (verb == "hand") {
    move_hand(arguments);
  } else if (verb == "buttons") {
    need(arguments, 1, 1, "buttons DEVICE MASK (0 to 15)");
    buttons_ = static_cast<int>(number(arguments[0], 0, 15));
  } else if (verb == "homing") {
    need(arguments, 1, 1, "homing DEVICE pull|push|home|now");
    pull_and_push(arguments[0]);
  } else if (verb == "power") {
    need(arguments, 1, 1, "power DEVICE off|on");
    if (arguments[0] != "on" && arguments[0] != "off") throw CommandError("power is on or off");
    mechanics_.set_mains(arguments[0] == "on");
  } else if (verb == "at") {
    need(arguments, 2, 9, "at DEVICE PACKET COMMAND [arguments without the device]");
    const auto packet = static_cast<std::uint64_t>(number(arguments[0], 0, 1e12));
    due_.insert({packet, {arguments[1], Words(arguments.begin() + 2, arguments.end())}});
  } else {
    return UsbDevice::command(verb, arguments, now);
  }
  return {};
}

void Falcon::run_due() {
  while (!due_.empty() && due_.begin()->first <= packets_) {
    const auto due = due_.extract(due_.begin()).mapped();
    try {
      command(due.first, due.second, mechanics_until_);
    } catch (const CommandError&) {  // nobody is there to be told; the state shows that it did not happen
    }
  }
}

void Falcon::move_hand(const Words& words) {
  constexpr const char* kForm =
      "hand DEVICE target|then|place X Y Z [SECONDS], or stiffness|damping|mass|weight|tremor|tremor_rate "
      "VALUE ...";
  need(words, 2, 99, kForm);
  const std::string& what = words[0];
  if (what == "place" && words.size() == 4) {
    if (!mechanics_.place(point(words, 1))) throw CommandError("the links do not reach that point");
  } else if (what == "target" || what == "then") {
    need(words, 4, 5, kForm);
    const double seconds = words.size() == 5 ? number(words[4], 0, 3600) : 0;
    if (what == "target") {
      mechanics_.hand.move(point(words, 1), seconds);
    } else {
      mechanics_.hand.then(point(words, 1), seconds);
    }
  } else {
    if (words.size() % 2 != 0) throw CommandError(std::string("expected ") + kForm);
    for (std::size_t i = 0; i < words.size(); i += 2) set_hand(words[i], number(words[i + 1], 0, 1e5));
  }
}

void Falcon::set_hand(const std::string& key, double value) {
  if (key == "stiffness") {
    mechanics_.hand.stiffness = std::min(value, 2e4);  // above that a step of 0.1 ms is too long
  } else if (key == "damping") {
    mechanics_.hand.damping = std::min(value, 200.0);
  } else if (key == "mass") {
    mechanics_.mass = std::clamp(value, 0.02, 5.0);
  } else if (key == "weight") {
    mechanics_.weight = std::min(value, 2.0);
  } else if (key == "tremor") {
    mechanics_.hand.tremor = std::min(value, 0.01);
  } else if (key == "tremor_rate") {
    mechanics_.hand.tremor_rate = std::min(value, 50.0);
  } else {
    throw CommandError("a hand has no \"" + key + "\"");
  }
}

void Falcon::pull_and_push(const std::string& what) {
  if (what == "now") return mechanics_.home_now();
  if (what != "pull" && what != "push" && what != "home")
    throw CommandError("homing is pull, push, home or now");
  const Vec out{0, 0, kFarOut}, in{0, 0, kFarIn};
  mechanics_.hand.move(what == "push" ? in : out, kPullTime);
  if (what != "home") return;
  mechanics_.hand.then(in, kPullTime);
  mechanics_.hand.then(kRest, kPullTime);
}

std::string Falcon::state(double now) {
  advance(now);
  JsonLine json;
  json.add("position", mechanics_.position());
  json.add("velocity", mechanics_.velocity());
  json.add("encoders", mechanics_.encoders());
  json.add("dac", mechanics_.dac());
  json.add("wished_dac", wished_dac_);
  json.add("force", mechanics_.motor_force());
  json.add("hand_target", mechanics_.hand.target());
  json.add("hand_at_rest", mechanics_.hand.at_rest());
  json.add("homed", static_cast<double>(mechanics_.homed()));
  json.add("buttons", static_cast<double>(buttons_));
  json.add("green", (leds_ & kGreenBit) != 0);
  json.add("blue", (leds_ & kBlueBit) != 0);
  json.add("red", (leds_ & kRedBit) != 0);
  json.add("loaded", mcu_.running());
  json.add("image_bytes", static_cast<double>(mcu_.image().size()));
  json.add("resets", static_cast<double>(mcu_.resets()));
  json.add("mains", mechanics_.mains());
  json.add("work_hand", mechanics_.work().hand);
  json.add("work_motors", mechanics_.work().motors);
  json.add("work_friction", mechanics_.work().friction);
  json.add("work_stops", mechanics_.work().stops);
  json.add("work_weight", mechanics_.work().weight);
  json.add("kinetic", mechanics_.kinetic_energy());
  json.add("packets", static_cast<double>(packets_));
  json.add("opens", static_cast<double>(opens_));
  json.add("writes", static_cast<double>(writes_));
  json.add("largest_dac", static_cast<double>(largest_dac_));
  json.add("largest_dac_unhomed", static_cast<double>(largest_dac_unhomed_));
  json.add("time", mechanics_.time());
  return json.text();
}

}  // namespace palpate::emulation
