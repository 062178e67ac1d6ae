// SPDX-License-Identifier: Apache-2.0
// What file managers and window managers tell a window: the source's side of X's drag and drop (freedesktop.org,
// "XDND", version 5), as far as a window needs it to get files; and that it shall close.
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

#include "desktop.hpp"

// Last, since it defines macros by common names.
#include <X11/Xatom.h>
#include <X11/Xlib.h>

namespace palpate {
namespace {

class Messenger {
 public:
  explicit Messenger(const std::string& name) : display_(XOpenDisplay(name.c_str()), XCloseDisplay) {
    if (!display_) throw std::runtime_error("no display " + name);
    self_ = XCreateSimpleWindow(at(), XDefaultRootWindow(at()), 0, 0, 1, 1, 0, 0, 0);
    other_ = named("Palpate", XDefaultRootWindow(at()));
    if (other_ == 0) throw std::runtime_error("there is no window");
  }
  void send(const char* type, const std::array<long, 5>& values) const {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = other_;
    event.xclient.message_type = atom(type);
    event.xclient.format = 32;
    for (std::size_t i = 0; i < values.size(); ++i) event.xclient.data.l[i] = values[i];
    XSendEvent(at(), other_, False, NoEventMask, &event);
    XFlush(at());
  }
  [[nodiscard]] long number(const char* name) const { return static_cast<long>(atom(name)); }

  // Until the other window has the names.
  void drop(const std::string& names) const {
    const long self = static_cast<long>(self_);
    XSetSelectionOwner(at(), atom("XdndSelection"), self_, CurrentTime);
    send("XdndEnter", {self, long{5} << 24, number("text/uri-list"), 0, 0});
    send("XdndPosition", {self, 0, long{600} << 16 | 300, CurrentTime, number("XdndActionCopy")});
    send("XdndDrop", {self, 0, CurrentTime, 0, 0});
    for (int i = 0; i < 1000; ++i) {
      while (XPending(at()) > 0) {
        XEvent event;
        XNextEvent(at(), &event);
        if (event.type == SelectionRequest) answer(event.xselectionrequest, names);
        if (event.type == ClientMessage && event.xclient.message_type == atom("XdndFinished")) return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    throw std::runtime_error("the dropped files were not taken");
  }

 private:
  [[nodiscard]] Display* at() const { return display_.get(); }
  [[nodiscard]] Atom atom(const char* name) const { return XInternAtom(at(), name, False); }

  // The first window with this in its title.
  [[nodiscard]] Window named(const std::string& words, Window below) const {
    Window root = 0, parent = 0, *children = nullptr;
    unsigned count = 0;
    char* title = nullptr;
    if (XFetchName(at(), below, &title) != 0) {
      const bool found = std::string(title).find(words) != std::string::npos;
      XFree(title);
      if (found) return below;
    }
    if (XQueryTree(at(), below, &root, &parent, &children, &count) == 0) return 0;
    Window found = 0;
    for (unsigned i = 0; i < count && found == 0; ++i) found = named(words, children[i]);
    if (children != nullptr) XFree(children);
    return found;
  }
  void answer(const XSelectionRequestEvent& asked, const std::string& names) const {
    XChangeProperty(at(), asked.requestor, asked.property, asked.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(names.data()), static_cast<int>(names.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = asked.requestor;
    event.xselection.selection = asked.selection;
    event.xselection.target = asked.target;
    event.xselection.property = asked.property;
    event.xselection.time = asked.time;
    XSendEvent(at(), asked.requestor, False, NoEventMask, &event);
    XFlush(at());
  }

  std::unique_ptr<Display, int (*)(Display*)> display_;
  Window self_ = 0, other_ = 0;
};

}  // namespace

void Desktop::drops(const std::vector<std::filesystem::path>& files) const {
  std::string names;
  for (const std::filesystem::path& file : files) {
    names += "file://";
    for (const char c : file.string()) names += c == ' ' ? "%20" : std::string(1, c);
    names += "\r\n";
  }
  Messenger(display_).drop(names);
}

void Desktop::asksToClose() const {
  const Messenger messenger(display_);
  messenger.send("WM_PROTOCOLS", {messenger.number("WM_DELETE_WINDOW"), CurrentTime, 0, 0, 0});
}

}  // namespace palpate
