// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/benches.hpp"

#include "apps/bench/edit_bench.hpp"
#include "apps/bench/field_bench.hpp"
#include "apps/bench/live_bench.hpp"
#include "apps/bench/load_bench.hpp"
#include "apps/bench/loop_bench.hpp"
#include "apps/bench/render_bench.hpp"
#include "apps/bench/service_bench.hpp"
#include "apps/bench/servo_bench.hpp"
#include "apps/bench/start_bench.hpp"

namespace palpate {
namespace {

constexpr const char* kServoIntroduction =
    R"(Every algorithm of the registry along the same paths, in one process, interleaved: each repetition goes round all of them and
begins with another one. The tool follows the phantom's exact surface at 0.1 m/s, 1 voxel below it, in a direction that turns slowly
by chance, 1000 ticks a second, K = 500 N/m, B = 0, windows of 32 x 32 x 32 samples as in the program.

- *Cost, mean*: median over repetitions of a replay's time divided by its ticks, so that the clock's own cost stays out. Each
  tick's position depends on the last tick's force, as in a loop, where ticks do not overlap. What this harness costs by itself
  stands below the tables and is not taken off. p99, p99.9 and maximum: over ticks, the fastest of several replays of each, the
  clock's median cost taken off; the raw figures are in the JSON.
- *VHIP*: its distance from the exact surface. *Force*: | |F| - K depth | / (K depth), depth of the tool below the exact surface.
  *Angle*: between the force and the exact normal. *Jump*: largest change of the force from one tick to the next. *Falls*: how
  often contact was lost while the tool was more than 0.25 voxel inside.
- *Strokes*: a rigid hand right through a wall, from a random side, at up to 45 degrees, counted until K times the way past the wall
  reaches 8 N. Missed: never felt. Lost: felt and let go.
- *Noise and depth*: the same path, deeper, over samples with noise; noise is told as how far it moves the surface, and errors
  are against the surface without it. *Speeds*: 2 mm deep, any n.
- *hri-paper* is the paper's Figure 2 to the letter, and stands for the paper wherever one name does; *hri-paper-line* is the other
  reading of its text (docs/hri-mends.md). *haptization* shows no surface, and K means nothing to it: it has no VHIP error and no error of the force.
- Windows follow as in the program, around the surface where an algorithm says that it holds one and otherwise around the tool,
  without delay.

Exact places: `apps/bench/*.hpp`. Costs are compared within a run only; figures of correctness are the same on every machine.)";

constexpr const char* kLoopIntroduction =
    R"(The real-time loop (hri, n = 5, simulated device, rigid hand at 0.5 m/s over a knot of 128 x 128 x 64 voxels) while the engine gathers a
window every 12 ms on its own thread, and `cyclictest` (SCHED_FIFO, same priority, memory locked, same clock, no affinity, no power
management request) in its place, in turns of half a second: loop, cyclictest, cyclictest, loop, and so on. Lateness: from the due time to the
first reading of the clock, in whole microseconds, cut down, on both sides. A miss: later than a period. On a virtual machine the
tails are the host's.)";

constexpr const char* kEditIntroduction = R"(
What one edit costs, stage by stage: `plan` finds the bricks and makes room, `record` writes the commands' list of
work, the four kernels change densities, bounds, gradients and the window, `submit, wait` is what the driver takes
beside them, `publish` hands the window to the servo; that is `to window`.
`settle` (storage given back) and `VDB read-back` come after it.
`journal` is what the journal takes of the engine's thread; `sum` holds all of these.
`on disk` is the time until the disk has confirmed the record, without the 3 ms in which a session gathers records.
Medians over edits at random places on the same plane, the volumes taking turns of eight; `all` has gradients in every
brick.
`anew` is what it takes to compute that volume's bounds, gradients and window anew, on the device, `times` how much
dearer that is than the edit to its window.)";

constexpr const char* kLoadIntroduction = R"(
A file of random floats read from the system's cache: by its format's library alone (ITK into plain memory, OpenVDB
into its grid), and by Palpate into its bricks.
Both in turns, in one process; medians.
`first` is the first load, which meets memory that the process never had.
Values that lie in a file as they lie in memory go from the file into the bricks; what is packed is unpacked first.)";

constexpr const char* kFieldIntroduction = R"(
Every row is one filter or gradient of one volume that lies in memory already (Palpate's in its brick pool, with pools
for results at hand and kernels compiled; the others' as their own images and grids, with a result made anew for each
run, as they make it).
All run in turns, in one process but for VTK and SciPy, which a child runs; medians and quartiles of the wall clock,
and processor time of the process.
`moved` is what the passes must move: each reads its field once and writes its result once, samples of a gradient 16
bytes a voxel, 8 as halves; `of copy` is that over the time, as a share of what a plain copy moves in the same turns.
`Palpate/this` below 1 says that Palpate is the faster one, `by cpu` that it takes less processor time, which says
more on a busy machine.
Who would take more than 12 s of it for one run is left out.
SciPy has one thread, the others as many as the machine has.
VTK and SciPy are measured where they are installed (`apt-get install python3-scipy python3-vtk9`); Palpate needs
neither.)";

constexpr const char* kRenderIntroduction = R"(
A picture of the isosurface with a ray for each pixel, by the kernel that the program uses and by the one it had before,
in turns, in one process; medians.
*Error*: | depth - exact distance along the ray to the phantom's surface |; voxels of the phantom blur that surface, so
it is no error of the kernel alone.
*Holes*: pixels without a hit though the exact ray goes deeper than half a voxel; *false*: pixels with one though it stays
farther out than that.)";

constexpr const char* kLiveIntroduction = R"(
A sculpting session as its window has it, without the window: the tool drills along a circle on the surface, 1 mm deep,
while nothing is drawn, while the camera stands, and while it turns by 0.6 radian a second; in turns, each in a session
of its own.
`between`: mean time between pictures; while the camera stands those at full quality count, while it turns the first
one of each camera.
`to pixel`: from an edit to the first picture that shows all of it.
`settling`: from the camera's last movement to a whole picture.
`ready`: from the request to the first whole picture.
`late`, `age`: lateness of the servo's ticks, and age of its window of samples; ratios: over those of the session of the
same turn in which nothing is drawn.)";

constexpr const char* kServiceIntroduction = R"(
The servo in a process of its own (`palpate touch --service`) against the servo beside the engine, in turns: one, two,
two, one, and so on.
All runs are the same: a knot of 128 x 128 x 64 voxels, the tool 1 voxel below its surface at 0.1 m/s in a rigid hand, a
window of 32 x 32 x 32 samples, an edit around the tool every 15 to 35 ms.
*Window age*: time since the window that a tick used was published; *first use*: the same at the first tick that used
it.
*Edit to window*: from asking for an edit to the begin of the first tick whose window held it.
*Tick cost*: of a tick without its sleep.
Each ratio is that of two processes over one within a pair of runs; the median over pairs is promised.
`from`, `to`: between them the true median lies with a chance of 95 %; then the quartiles over pairs.
`one / one` is the same ratio of two runs in one process, a pair apart: what is inside its quartiles may be chance.)";

constexpr const char* kStartIntroduction = R"(
This program started again and again as a process of its own, the jobs in turns; medians.
`first tick`: from the start of the process until the servo's first tick was due, as the program itself tells it: the
processor time until `main()`, which is the loader's, and the wall clock from there.
`whole run`: of the process, seen from outside; a touch runs for 50 ms and writes its report, without a picture.
`libraries`: shared libraries loaded at the end, the Vulkan driver's among them.
The driver's cache of compiled kernels and the system's cache of files are warm.)";

// What the user asked for, in a bench's own request.
template <auto kRun, class Request>
BenchResult run(const Bench& bench, const BenchArguments& arguments, Progress& progress) {
  Request request = arguments.quick ? Request::quick() : Request{};
  request.seed = arguments.seed;
  if constexpr (requires { request.commit; }) request.commit = arguments.commit;
  if constexpr (requires { request.gpu; }) request.gpu = arguments.gpu;
  if constexpr (requires { request.seconds; }) request.seconds = arguments.seconds.value_or(request.seconds);
  if constexpr (requires { request.sizes; }) {
    request.sizes = !arguments.sizes.empty() ? arguments.sizes : arguments.quick ? bench.quick_sizes : bench.sizes;
  }
  return kRun(request, progress);
}

}  // namespace

const std::vector<Bench>& benches() {
  static const std::vector<Bench> kBenches = {
      {.name = "servo",
       .help = "cost and error of every haptic algorithm (some minutes; --quick: half a minute)",
       .title = "What a tick costs and how true it is",
       .introduction = kServoIntroduction,
       .run = run<runServoBench, ServoBenchRequest>,
       .table = servoTable,
       .charts = servoCharts},
      {.name = "loop",
       .help = "lateness of the real-time loop beside cyclictest's (four minutes; --quick: seconds)",
       .title = "How well the loop keeps its times",
       .introduction = kLoopIntroduction,
       .seconds = "how long each side runs at each rate [s] (default 30; quick 2)",
       .takes = {"seconds", "gpu"},
       .run = run<runLoopBench, LoopBenchRequest>,
       .table = loopTable,
       .charts = loopCharts},
      {.name = "edit",
       .help = "what an edit costs, by stage, brush and volume (a few minutes and 4 GiB; --quick: seconds)",
       .title = "What an edit costs",
       .introduction = asParagraph(kEditIntroduction),
       .sizes = {64, 256, 1024, 2048},
       .quick_sizes = {64, 256, 1024},
       .takes = {"gpu"},
       .run = run<runEditBench, EditBenchRequest>,
       .table = editTable,
       .charts = editCharts},
      {.name = "load",
       .help = "loading beside the format's library alone (minutes, 3 GiB of memory and 0.5 of disk; --quick: seconds)",
       .title = "What loading costs",
       .introduction = asParagraph(kLoadIntroduction),
       .sizes = {512},
       .quick_sizes = {256},
       .run = run<runLoadBench, LoadBenchRequest>,
       .table = loadTable,
       .charts = loadCharts},
      {.name = "filters",
       .help = "every filter beside ITK, VTK, SciPy and OpenVDB (some ten minutes and 6 GiB; --quick: seconds)",
       .title = "What filters cost",
       .introduction = asParagraph(kFieldIntroduction),
       .sizes = {128, 256, 512},
       .quick_sizes = {64},
       .takes = {"gpu", "sizes"},
       .run = run<runFilterBench, FieldBenchRequest>,
       .table = fieldTable,
       .charts = filterCharts},
      {.name = "gradient",
       .help = "every gradient operator beside them, and a CT head's needed bricks (minutes, 9 GiB; --quick: seconds)",
       .title = "What gradients cost",
       .introduction = asParagraph(kFieldIntroduction),
       .sizes = {128, 256, 512},
       .quick_sizes = {64},
       .takes = {"gpu", "sizes"},
       .run = run<runGradientBench, FieldBenchRequest>,
       .table = fieldTable,
       .charts = gradientCharts},
      {.name = "render",
       .help = "pictures of the isosurface: cost and error of depth (a minute; --quick: seconds)",
       .title = "What a picture costs and how true its depth is",
       .introduction = asParagraph(kRenderIntroduction),
       .sizes = {256},
       .quick_sizes = {128},
       .takes = {"gpu", "sizes"},
       .run = run<runRenderBench, RenderBenchRequest>,
       .table = renderTable,
       .charts = renderCharts},
      {.name = "live",
       .help = "pictures and servo while a session drills (two minutes; --quick: seconds)",
       .title = "How smooth a sculpting session is",
       .introduction = asParagraph(kLiveIntroduction),
       .seconds = "how long each session drills [s] (default 5; quick 1.5)",
       .takes = {"seconds", "gpu"},
       .run = run<runLiveBench, LiveBenchRequest>,
       .table = liveTable,
       .charts = liveCharts},
      {.name = "service",
       .help = "engine and servo in two processes beside one (three minutes; --quick: seconds)",
       .title = "What two processes cost",
       .introduction = asParagraph(kServiceIntroduction),
       .seconds = "how long each run is [s] (default 2; quick 1.5)",
       .takes = {"seconds", "gpu"},
       .run = run<runServiceBench, ServiceBenchRequest>,
       .table = serviceTable,
       .charts = serviceCharts},
      {.name = "start",
       .help = "from the start of the program to its first tick (a minute; --quick: half of it)",
       .title = "How long the program takes to start",
       .introduction = asParagraph(kStartIntroduction),
       .run = run<runStartBench, StartBenchRequest>,
       .table = startTable,
       .charts = startCharts}};
  return kBenches;
}

}  // namespace palpate
