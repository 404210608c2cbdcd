#include "tests/emulation/usb_bus.h"

#include <algorithm>
#include <regex>
#include <sstream>
#include <sys/socket.h>

namespace palpate::emulation {

void UsbBus::add(const std::string& name, std::unique_ptr<UsbDevice> device) {
  static const std::regex form(R"(([1-9]|[1-9][0-9])-([1-9][0-9]?)(\.[1-9][0-9]?)*)");
  std::smatch parts;
  if (!std::regex_match(name, parts, form))
    throw CommandError("\"" + name + "\" is no port; expected BUS-PORT, as 2-1");
  for (const auto& port : ports_) {
    if (port->name == name) throw CommandError("port " + name + " is taken");
  }
  auto port = std::make_unique<Port>();
  port->name = name;
  port->bus = static_cast<std::uint8_t>(std::stoi(parts[1]));
  port->device = std::move(device);
  port->kernel_owns = !port->device->kernel_driver().empty();
  last_address_.try_emplace(port->bus, std::uint8_t{1});  // 1 is the root hub
  port->address = ++last_address_[port->bus];
  ports_.push_back(std::move(port));
}

void UsbBus::closed(const Link& link) {
  for (const auto& port : ports_) {
    if (port->claimed == &link) port->claimed = nullptr;
  }
}

void UsbBus::announce(const Port& port, wire::Kind kind) const {
  for (const Link* link : links) {
    if (link->monitor) wire::send(link->fd, description_of(port, kind));
  }
}

void UsbBus::plug(Port& port, double now) {
  if (port.plugged) throw CommandError("it is plugged in");
  port.plugged = true;
  port.address = ++last_address_[port.bus];
  port.kernel_owns = !port.device->kernel_driver().empty();
  port.device->power_up(now);
  announce(port, wire::Kind::kAttached);
}

void UsbBus::unplug(Port& port) {
  if (!port.plugged) throw CommandError("it is not plugged in");
  port.plugged = false;
  port.claimed = nullptr;
  for (Link* link : links) {
    if (link->port != &port) continue;
    link->port = nullptr;
    link->waiting.clear();
    shutdown(link->fd, SHUT_WR);
    link->wake();
  }
  announce(port, wire::Kind::kDetached);
}

Port& UsbBus::find(const std::string& name) {
  for (const auto& port : ports_) {
    if (port->name == name) return *port;
  }
  throw CommandError("no device \"" + name + "\"");
}

std::string UsbBus::command(const std::string& line, double now) {
  std::istringstream in(line);
  std::string verb, name;
  in >> verb >> name;
  Words arguments;
  for (std::string word; in >> word;) arguments.push_back(word);
  try {
    if (verb == "devices") {
      std::string names;
      for (const auto& port : ports_) names += " " + port->name + (port->plugged ? "" : "(unplugged)");
      return "ok" + names;
    }
    Port& port = find(name);
    if (verb == "unplug") {
      unplug(port);
    } else if (verb == "plug") {
      plug(port, now);
    } else {
      const std::string answer = port.device->command(verb, arguments, now);
      return answer.empty() ? "ok" : "ok " + answer;
    }
    return "ok";
  } catch (const CommandError& error) {
    return std::string("error ") + error.what();
  }
}

}  // namespace palpate::emulation
