// SPDX-License-Identifier: Apache-2.0
// apps/serve/serve_job.hpp: `palpate serve`: a scene's volume for a servo and for clients, until it is told to end.
//
// SIGTERM, SIGINT and `palpate ctl stop` end it in good order: what was asked for is finished, and the volume is saved
// if the scene says where. SIGHUP reads the scene's file again and takes the settings that may change. One thread,
// which blocks.
#pragma once

#include <functional>
#include <string>

#include "apps/console/progress.hpp"
#include "apps/scene/scene.hpp"

namespace palpate {

struct ServeRequest {
  Scene scene;
  std::function<Scene()> read_again;  // the scene as its file says now; throws Error. Empty: it has no file
  std::string commit;                 // of this program
};

// Throws Error as ServedVolume and ClientDesk do; kDevice if the engine failed.
void serveScene(const ServeRequest& request, Progress& progress);

}  // namespace palpate
