// SPDX-License-Identifier: Apache-2.0
// apps/supervise/supervisor.hpp: runs some programs beside each other and starts again what died. Linux only.
//
// One that a signal ends, or that ends with a status other than 0, is started again: the first time at once, then with
// growing waits (restart_pace.hpp), unless that is hopeless. One that ends with status 0 is done; if it is essential,
// all are ended. All are ended too when SIGTERM or SIGINT comes, when one is given up, and when supervise() throws for
// another reason. To be ended is: SIGTERM, time to come to rest, then SIGKILL. SIGHUP is passed on as it is. If the
// supervisor itself is killed, the children get SIGTERM (child_start.hpp).
//
// Signals of the terminal and of service managers come to the supervisor alone, since each child has a process group of
// its own. SIGTERM goes to the whole group, SIGHUP to the child only: what it started for some work would die of it.
// What a child leaves of its group when it ends gets SIGTERM; it is not waited for.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/supervise/restart_pace.hpp"

namespace palpate {

struct SupervisedCommand {
  std::string name;                // in messages: "servo"
  std::vector<std::string> argv;   // the program, along PATH if it has no '/', and its arguments
  bool essential = false;          // when it ends with status 0, all are ended
  std::vector<int> hopeless = {};  // statuses with which it would only end again: not started again, and all are ended
  std::optional<double> patience_s = {};  // from SIGTERM until SIGKILL, for what has much to finish [s]
};

struct SupervisorSettings {
  RestartLimits restarts = {};
  double patience_s = 10;  // from SIGTERM until SIGKILL, for those that name no own [s]
  // Gets a line for each death, which says what is done about it, and for each that had to be killed. Empty:
  // tellUser(). What it throws is dropped.
  std::function<void(const std::string&)> tell = {};
};

struct SupervisionEnd {
  int signal = 0;    // the first that asked for the end, SIGTERM or SIGINT; 0: an essential one, or each, ended with 0
  int restarts = 0;  // of all
  int killed = 0;    // how many did not end within the patience
};

// Runs the commands until the end, as above; then none of them is left, nor a zombie. (One that hangs in the kernel
// cannot be killed; after the patience once more it is left behind, and a line says so.)
// Throws Error: kBadInput for no command, or one without name or program, and if this process supervises already;
// kNotFound or kIo, before anything was restarted, if one cannot be started; kIo if one is given up, since it ended
// with a hopeless status or died too often at once (a program that cannot be started again has died too); kCancelled if
// a request to stop came before. Thread: a set-up thread. Blocks until the end. No other thread should start processes
// meanwhile. Between signals it uses no processor time. Further requests to stop are passed on as well and do not
// shorten the patience.
SupervisionEnd supervise(const std::vector<SupervisedCommand>& commands, const SupervisorSettings& settings = {});

}  // namespace palpate
