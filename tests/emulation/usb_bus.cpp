#include "tests/emulation/usb_bus.h"

#include <algorithm>
#include <regex>
#include <sstream>
#include <sys/socket.h>

#include "tests/emulation/hub.h"

namespace palpate::emulation {

void UsbBus::add(const std::string& name, std::unique_ptr<UsbDevice> device) {
  static const std::regex form(R"(([1-9]|[1-9][0-9])-([1-9][0-9]?)(\.[1-9][0-9]?)*)");
  std::smatch parts;
  if (!std::regex_match(name, parts, form))
    throw CommandError("\"" + name + "\" is no port; expected BUS-PORT, as 2-1");
  if (has(name)) throw CommandError("port " + name + " is taken");
  const auto bus = static_cast<std::uint8_t>(std::stoi(parts[1]));
  const std::string root = "usb" + parts[1].str();
  if (!has(root)) put(root, bus, std::make_unique<Hub>(true));
  for (std::size_t dot = name.find('.'); dot != std::string::npos; dot = name.find('.', dot + 1)) {
    const std::string above = name.substr(0, dot);
    if (!has(above)) put(above, bus, std::make_unique<Hub>(false));
    if (!find(above).device->is_hub()) throw CommandError("the device at " + above + " is no hub");
  }
  put(name, bus, std::move(device));
}

void UsbBus::put(const std::string& name, std::uint8_t bus, std::unique_ptr<UsbDevice> device) {
  auto port = std::make_unique<Port>();
  port->name = name;
  port->bus = bus;
  port->device = std::move(device);
  port->kernel_owns = !port->device->kernel_driver().empty();
  port->address = ++last_address_[bus];
  ports_.push_back(std::move(port));
}

bool UsbBus::has(const std::string& name) const {
  return std::ranges::any_of(ports_, [&](const auto& port) { return port->name == name; });
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
      for (const auto& port : ports_) {
        if (port->device->is_hub()) continue;
        names += " " + port->name + (port->plugged ? "" : "(unplugged)");
      }
      return "ok" + names;
    }
    Port& port = find(name);
    if (verb == "unplug") {
      unplug(port);
    } else if (verb == "plug") {
      plug(port, now);
    } else if (verb == "driver") {
      return "ok " + driver_of(port);
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
