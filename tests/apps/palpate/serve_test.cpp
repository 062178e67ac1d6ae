// SPDX-License-Identifier: Apache-2.0
// `palpate serve` and `ctl`: what clients and users ask of a service.
#include <cerrno>
#include <chrono>
#include <fstream>
#include <set>
#include <sstream>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "nrrd_bytes.hpp"
#include "served_sphere.hpp"
#include "tests/support/unix_stream.hpp"

namespace palpate {
namespace serve_test {

using testing::HasSubstr;

class Serve : public ServedSphere {};

TEST_F(Serve, EditsAndIsAsked) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  const Outcome added = ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm", "add:radius=2mm:at=12,-12,-12mm"});
  expectSuccess(added);
  EXPECT_EQ(added.out, "2 edits made, and on the disk\n");
  EXPECT_EQ(status()["edits"], 1);  // both together
  expectSuccess(ctl({"save", "two.vdb"}));
  EXPECT_GT(densityAt("two.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
  EXPECT_GT(densityAt("two.vdb", Vec3(12, -12, -12) * 1e-3), 0);
  expectSuccess(ctl({"undo"}));
  expectSuccess(ctl({"save", "none.nrrd"}));
  EXPECT_LE(densityAt("none.nrrd", Vec3(-12, -12, -12) * 1e-3), 0);
  EXPECT_LE(densityAt("none.nrrd", Vec3(12, -12, -12) * 1e-3), 0);
  expectSuccess(ctl({"redo"}));
  const Outcome exported = ctl({"export", "sphere.stl"});
  expectSuccess(exported);
  EXPECT_THAT(exported.out, HasSubstr("triangles"));
  expectSuccess(ctl({"render", "now.png", "--width", "64", "--height", "48"}));
  EXPECT_EQ(contentsOf(file("now.png")).substr(1, 3), "PNG");
  EXPECT_THAT(ctl({"get", "servo.n"}).out, HasSubstr("servo.n = 5"));
  EXPECT_THAT(ctl({"set", "servo.n", "9"}).out, HasSubstr("servo.n = 9"));
  EXPECT_THAT(ctl({"get", "servo.n"}).out, HasSubstr("servo.n = 9"));
  EXPECT_THAT(ctl({"set", "servo.n=8"}).out, HasSubstr("servo.n = 8"));
  EXPECT_THAT(run({"top", "--count", "2", "--every", "0.05"}).out, HasSubstr("undo/redo"));
  const std::string tiny = ctl({"edit", "add:radius=2mm:at=0,0,0mm", "add:radius=1e-7mm:at=12,-12,-12mm"}).out;
  EXPECT_THAT(
      tiny,
      HasSubstr("2 edits made, and on the disk; one of them at least: its radius of 1e-07 mm is below half a voxel"));
  for (const char* nowhere : {"remove:radius=2mm:at=25,25,25mm", "cut:point=0,0,50mm:normal=0,0,1"})
    EXPECT_THAT(ctl({"edit", nowhere}).out, HasSubstr("1 edit made, and on the disk; it reaches no voxel: "))
        << nowhere;
  EXPECT_THAT(ctl({"edit", "add:radius=1e-7mm:at=0,0,0mm", "add:radius=2mm:at=0,0,50mm"}).out,
              HasSubstr("one of them at least: it reaches no voxel: "));
  EXPECT_EQ(ctl({"edit", "cut:point=0,0,5mm:normal=0,0,1"}).out, "1 edit made, and on the disk\n");
  expectSuccess(ctl({"undo"}));
  EXPECT_THAT(
      ctl({"edit", "add:radius=2mm:at=0,0,50mm"}).out,
      HasSubstr("1 edit made, and on the disk; it reaches no voxel: 'palpate info' says where the volume lies"));
  expectSuccess(ctl({"stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(engine.hasEnded());
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("palpate: serve: ended"));
}

// Where the scene names none, the isovalue is that of every other verb. (A sphere's is 0.)
TEST_F(Serve, TouchesTheUsualIsovalue) {
  serve({"phantom:head?size=32"});
  ASSERT_TRUE(awaitService());
  const std::string said = ctl({"get", "isovalue"}).out;
  EXPECT_NE(std::stod(said.substr(said.find('=') + 1)), 0);
  expectSuccess(ctl({"export", "served.stl"}));
  expectSuccess(run({"convert", "phantom:head?size=32", "converted.stl"}));
  EXPECT_EQ(contentsOf(file("served.stl")), contentsOf(file("converted.stl")));
}

TEST_F(Serve, RefusesWithWords) {
  const auto refused = [this](const Words& words, const std::string& input, const std::string& why, int status = 2) {
    expectRefusal(ctl(words), input, why, status);
  };
  refused({"status"}, "service.sock", "no service listens there", 3);
  refused({"status", "--socket", "other.sock"}, "other.sock", "no service listens there", 3);
  refused({"set", "servo.n"}, "servo.n", "no value is given for it");
  expectRefusal(run({"top", "--count", "x"}), "--count", "'x' is no number from 0 to 1e+09", 2);
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  refused({"undo"}, "undo", "there is no edit to undo");
  refused({"edit", "melt:radius=1mm"}, "melt", "");
  refused({"edit", "undo"}, "undo", "it is not an edit of one place");
  refused({"edit", "stamp-add:mesh=none.stl:at=0,0,0mm"}, "none.stl", "", 3);
  refused({"filter", "sharpest:3"}, "sharpest", "");
  refused({"edit", "remove:radius=1mm"}, "remove:radius=1mm", "");
  refused({"edit", "remove:radius=900mm:at=1,1,1mm"}, "radius", "");
  refused({"set", "servo.rate_hz", "500"}, "servo.rate_hz", "it cannot change while the scene is served");
  refused({"set", "servo.stifness_N_per_m", "500"}, "servo.stifness_N_per_m", "no setting of a scene has this key");
  refused({"set", "servo.n", "much"}, "servo.n", "");
  refused({"set", "servo.algorithm", "god-object"}, "god-object", "would not follow the edits");
  refused({"set", "servo.algorithm", "avila"}, "avila", "it reads gradients everywhere");
  refused({"set", "isovalue", "1e9"}, "isovalue", "so there is no isosurface");
  refused({"get", std::string(60'000, 'x')}, "xxx", "no setting of a scene has this key");
  EXPECT_NE(ctl({"edit", std::string(60'000, 'x')}).status, 0);
  EXPECT_THAT(ctl({"get", "servo.stiffness_N_per_m", "isovalue", "servo.algorithm"}).out,
              HasSubstr("isovalue = 0\nservo.algorithm = hri\n"));  // as before
  refused({"save", "a.xyz"}, "a.xyz", "");
  refused({"save", "none/a.vdb"}, "a.vdb", "", 4);
  refused({"render", "a.jpg"}, "a.jpg", "pictures are written as PNG");
  refused({"render", "a.png", "--width", "5"}, "the picture", "16 to 4096 pixels");
  EXPECT_EQ(status()["edits"], 0);
  // A second engine at the same place.
  const Outcome second = run({"serve", kServedSphere});
  EXPECT_EQ(second.status, 4);
  EXPECT_THAT(second.err, HasSubstr("somebody listens there already"));
}

TEST_F(Serve, RefusesScenesThatCannotBeServed) {
  const auto refused = [this](const Words& more, const std::string& why) {
    const Outcome outcome = run(Words{"serve", kServedSphere} + more);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(why));
  };
  refused({"--clock", "simulated"}, "a service runs by the real clock");
  refused({"--device", "recorded", "--recording", "a.rec"}, "a service plays no recording back");
  refused({"--edit", "remove:radius=1mm"}, "a service edits what its clients ask for");
  refused({"--service"}, "a service's servo is in a process of its own already");
  refused({"--record", "a.rec"}, "a service keeps no recording");
  refused({"--save-every", "3"}, "a service keeps every edit in its journal");
  refused({"--out", "there"}, "a service writes no report");
  refused({"--trace", "off"}, "a service writes no trace");
  refused({"--stopped-trace", "5"}, "a service writes no trace");
  refused({"--picture", "off"}, "a service draws when a client asks");
  refused({"--width", "640"}, "a service draws when a client asks");
  refused({"--height", "480"}, "a service draws when a client asks");
  refused({"--save", "a.xyz"}, "a.xyz");
  refused({"--filter", "sharpest:3"}, "sharpest");
  refused({"--log", "loud"}, "loud");
  refused({"--algorithm", "god-object"}, "which would not follow the edits");
}

// Another service at the same socket, or with the same journal, is refused before it touches the journal.
TEST_F(Serve, ASecondServiceTakesNothing) {
  serve({kServedSphere, "--journal", "kept/"});
  ASSERT_TRUE(awaitService());
  write("kept/mine.txt", "mine");
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  const Outcome same = run({"serve", kServedSphere, "--journal", "kept"});
  EXPECT_EQ(same.status, 4);
  EXPECT_THAT(same.err, HasSubstr("somebody listens there already"));
  const Outcome other = run({"serve", kServedSphere, "--journal", "kept", "--socket", "other.sock"});
  EXPECT_EQ(other.status, 4);
  EXPECT_THAT(other.err, HasSubstr("another service keeps it"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=12,-12,-12mm"}));
  engine.end(SIGKILL);
  serveFromTheJournal({kServedSphere, "--journal", "kept"});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(status()["undoable"], 2);
  EXPECT_EQ(contentsOf(file("kept/mine.txt")), "mine");
}

// A signal ends it in good order: the file that the scene names is written. The journal stays, so that the next start
// goes on from there; one without an edit leaves the file as it is.
TEST_F(Serve, SavesWhenItIsToldToEnd) {
  serve({kServedSphere, "--save", "end.vdb"});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  engine.send(SIGTERM);
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GT(densityAt("end.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
  const std::string saved = contentsOf(file("end.vdb"));
  serveFromTheJournal({kServedSphere, "--save", "end.vdb"});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(status()["undoable"], 1);
  expectSuccess(ctl({"undo"}));
  expectSuccess(ctl({"stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(contentsOf(file("end.vdb")), saved);
  serve({"phantom:knot?size=32"});  // nothing is left that would be lost
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(status()["undoable"], 0);
}

// Without one the edits stay in the journal, and come back with the next start.
TEST_F(Serve, KeepsWhatNoFileHolds) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  expectSuccess(ctl({"stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  // Not for another volume, and not lost by trying.
  for (int start = 0; start < 2; ++start) {
    const Outcome other = run({"serve", "phantom:knot?size=32"});
    EXPECT_EQ(other.status, 2);
    EXPECT_THAT(other.err, HasSubstr("edits of an earlier service wait in "));
  }
  serveFromTheJournal({kServedSphere});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(status()["undoable"], 1);
}

TEST_F(Serve, ReadsItsSceneAgain) {
  const auto scene = [&](int n, int rate) {
    write("s.toml", "volume = \"phantom:sphere?size=32\"\n[servo]\nn = " + std::to_string(n) +
                        "\nrate_hz = " + std::to_string(rate) + "\n");
  };
  scene(7, 1000);
  serve({"s.toml"});
  ASSERT_TRUE(awaitService());
  EXPECT_THAT(ctl({"get", "servo.n"}).out, HasSubstr("servo.n = 7"));
  scene(11, 500);
  engine.send(SIGHUP);
  std::string now;
  for (int look = 0; look < 100 && now.find("= 11") == std::string::npos; ++look) {
    now = ctl({"get", "servo.n"}).out;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_THAT(now, HasSubstr("servo.n = 11"));
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("these take effect with the next start: servo.rate_hz"));
  write("s.toml", "volume = 3 =");
  engine.send(SIGHUP);
  EXPECT_TRUE(awaitSaid("stay as they are"));
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("the settings stay as they are: "));
  EXPECT_THAT(ctl({"get", "servo.n"}).out, HasSubstr("servo.n = 11"));
}

// Without a file there is nothing to read, and what clients have set stays.
TEST_F(Serve, HasNothingToReadAgainWithoutAFile) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"set", "servo.n", "9"}));
  engine.send(SIGHUP);
  EXPECT_TRUE(awaitSaid("no scene file was named, so there are no settings to read again"));
  EXPECT_THAT(ctl({"get", "servo.n"}).out, HasSubstr("servo.n = 9"));
}

// What it was told to write could not be written: its status says so, and the edits are in the journal.
TEST_F(Serve, SaysThatItCouldNotSave) {
  std::filesystem::create_directories(file("out"));
  serve({kServedSphere, "--save", "out/end.vdb"});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  std::filesystem::remove_all(file("out"));
  EXPECT_EQ(WEXITSTATUS(engine.end(SIGTERM)), 4);
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("out/end.vdb: it was not written: "));
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("; the edits are in the journal"));
  // The next start says so at once, and serves what the journal has.
  serve({kServedSphere, "--save", "out/end.vdb"});
  ASSERT_TRUE(awaitService());
  EXPECT_THAT(contentsOf(file("serve.log")),
              HasSubstr("the volume cannot be written at the end, as things are: out/end.vdb: cannot be created"));
  expectSuccess(ctl({"save", "kept.vdb"}));  // a checkpoint may hold the edit, so it need not be one to undo
  EXPECT_GT(densityAt("kept.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
  // It is written once it can be.
  std::filesystem::create_directories(file("out"));
  EXPECT_EQ(WEXITSTATUS(engine.end(SIGTERM)), 0);
  EXPECT_GT(densityAt("out/end.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
}

// Filters are changed while the object is touched: the servo goes over to the filtered field, and the edits stay.
TEST_F(Serve, IsFeltThroughOtherFilters) {
  writePress();
  serve({kServedSphere, "--path", "press.csv"});
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  const double tick = status()["tick"];
  // Eroded by more than the tool's depth: there is nothing any more where it is.
  EXPECT_THAT(ctl({"filter", "erode:3"}).out, HasSubstr("felt through erode:3"));
  EXPECT_THAT(ctl({"get", "filter"}).out, HasSubstr("filter = erode:3"));
  ASSERT_TRUE(
      await([](const nlohmann::json& now) { return now["servo"] == 1 && now["windows"] > 0 && now["force_N"] == 0; }));
  EXPECT_EQ(status()["undoable"], 1);
  EXPECT_EQ(status()["engines"], 2);
  expectSuccess(ctl({"filter", "erode:3"}));  // as it is
  EXPECT_EQ(status()["engines"], 2);
  EXPECT_THAT(ctl({"filter"}).out, HasSubstr("without filters"));
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  EXPECT_GT(status()["tick"], tick);
}

// An isovalue is answered when it is felt, or seen, with a servo or without; one that nothing crosses is not taken.
TEST_F(Serve, AnotherIsovalueComesAbout) {
  writePress();
  serve({kServedSphere, "--path", "press.csv"});
  ASSERT_TRUE(awaitService());
  const auto exported = [&](const std::string& name) {
    expectSuccess(ctl({"export", name}));
    return std::filesystem::file_size(file(name));
  };
  const auto first = exported("first.stl");
  expectSuccess(ctl({"set", "isovalue", "500"}));
  EXPECT_NE(exported("alone.stl"), first);
  EXPECT_THAT(ctl({"set", "isovalue", "1e9"}).err, HasSubstr("so there is no isosurface"));
  EXPECT_THAT(ctl({"get", "isovalue"}).out, HasSubstr("isovalue = 500"));
  expectSuccess(ctl({"set", "isovalue", "0"}));
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  EXPECT_THAT(ctl({"set", "isovalue", "1e9"}).err, HasSubstr("so there is no isosurface"));
  EXPECT_THAT(ctl({"get", "isovalue"}).out, HasSubstr("isovalue = 0"));
  expectSuccess(ctl({"set", "isovalue", "900"}));  // a smaller ball, away from the tool
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] < 0.3; }));
}

// Of a map of labels each answer about an isovalue or filters says what they feel, in the words of a start with them.
TEST_F(Serve, SaysAnewThatAVolumeIsFeltAsStairs) {
  NrrdBytes labels = ballNrrd();
  for (std::size_t n = 0; n < labels.values.size(); ++n)
    labels.values[n] = labels.values[n] <= 0 ? 0.0F : n % 16 < 8 ? 3.0F : 1.0F;  // two halves of a ball
  write("labels.nrrd", labels.bytes());
  serve({"labels.nrrd", "--iso", "0.5"});
  ASSERT_TRUE(awaitService());
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("isovalue 0.5 feels those from 1 to 3 as one object"));
  EXPECT_THAT(ctl({"set", "isovalue", "2"}).out,
              testing::MatchesRegex("isovalue = 2\nit holds 3 values \\(0, 1, 3\\), so its surface is felt as stairs; "
                                    "if these are labels, isovalue 2 feels label 3 alone: .*\n"));
  EXPECT_EQ(ctl({"set", "servo.n", "3"}).out, "servo.n = 3\n");
  EXPECT_THAT(
      ctl({"filter", "gaussian:1.5"}).out,
      HasSubstr("felt through gaussian:1.5; it holds 3 values (0, 1, 3); if these are labels, isovalue 2 feels"));
  EXPECT_THAT(ctl({"set", "isovalue", "1.5"}).out, HasSubstr("(0, 1, 3); if these are labels, isovalue 1.5 feels"));
  EXPECT_THAT(ctl({"filter"}).out, HasSubstr("without filters; it holds 3 values (0, 1, 3), so its surface"));
}

// A mesh is named from where the client is, and the edits after it wait for it.
TEST_F(Serve, StampsMeshes) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"export", "ball.stl"}));
  expectSuccess(ctl({"edit", "remove:radius=20mm:at=0,0,0mm"}));
  expectSuccess(ctl({"save", "gone.vdb"}));
  EXPECT_LT(densityAt("gone.vdb", Vec3(0, 0, 0)), 0);
  expectSuccess(ctl({"edit", "stamp-add:mesh=ball.stl:at=0,0,0mm", "add:radius=2mm:at=-12,-12,-12mm"}));
  EXPECT_EQ(status()["undoable"], 2);
  expectSuccess(ctl({"save", "back.vdb"}));
  EXPECT_GT(densityAt("back.vdb", Vec3(0, 0, 0)), 0);
  EXPECT_GT(densityAt("back.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
  engine.end(SIGKILL);  // the mesh is in the journal too
  std::filesystem::remove(file("ball.stl"));
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"save", "again.vdb"}));
  EXPECT_GT(densityAt("again.vdb", Vec3(0, 0, 0)), 0);
}

// The second of two pictures of the same size shows the edit between them.
TEST_F(Serve, PicturesShowEveryEdit) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  const auto drawn = [&](const std::string& name) {
    expectSuccess(ctl({"render", name, "--width", "96", "--height", "64"}));
    return contentsOf(file(name));
  };
  const std::string before = drawn("a.png");
  EXPECT_EQ(drawn("b.png"), before);
  expectSuccess(ctl({"edit", "remove:radius=6mm:at=0,0,11mm", "remove:radius=6mm:at=0,-11,0mm"}));
  EXPECT_NE(drawn("c.png"), before);
  expectSuccess(ctl({"undo"}));
  EXPECT_EQ(drawn("d.png"), before);
}

// One file says it all; whoever reads messages gets objects of JSON; metrics are at a socket of their own.
TEST_F(Serve, IsSetUpByOneFile) {
  write("s.toml",
        "volume = \"phantom:sphere?size=32\"\n[service]\nsocket = \"own/s.sock\"\n"
        "metrics_socket = \"own/m.sock\"\nlog = \"json\"\n");
  serve({"s.toml", "--supervise"});
  const auto there = [&](const Words& words) { return run(words + Words{"--socket", "own/s.sock"}); };
  for (int look = 0; look < 1200 && there({"ctl", "status"}).status != 0; ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  expectSuccess(there({"ctl", "edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  const int reader = connectedStream(file("own/m.sock").string());
  sayTo(reader, "GET /metrics HTTP/1.0\r\n\r\n");
  EXPECT_THAT(readAllOf(reader), HasSubstr("palpate_edits 1\n"));
  expectSuccess(there({"ctl", "stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::istringstream log(contentsOf(file("serve.log")));
  int messages = 0;
  std::set<std::string> programs;
  for (std::string line; std::getline(log, line); ++messages) {
    const nlohmann::json one = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(one.is_object()) << line;
    EXPECT_EQ(one["level"], "info") << line;
    EXPECT_EQ(std::string(one["time"]).size(), std::string("2026-01-31T12:00:00.000Z").size());
    EXPECT_GT(one["pid"], 1);
    EXPECT_NE(one["message"], "");
    programs.insert(one["program"]);
  }
  EXPECT_GT(messages, 2);
  EXPECT_THAT(programs, testing::IsSupersetOf({"palpate", "palpate-servo"}));
}

// Whatever clients send, or do not, the service goes on for the others. Its socket is the user's alone.
TEST_F(Serve, IsNotHeldUpByBadClients) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  const std::string socket = (file("run") / "palpate/service.sock").string();
  struct stat facts {};
  ASSERT_EQ(lstat(socket.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0600U);
  ASSERT_EQ(lstat(std::filesystem::path(socket).parent_path().c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0700U);
  const auto connected = [&] {
    const int client = ::socket(AF_UNIX, SOCK_SEQPACKET, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return client;
  };
  const int silent = connected();
  for (const std::string& bytes : {std::string("hello"), std::string(60'000, '\0'), std::string(20, '\xff')}) {
    const int client = connected();
    EXPECT_GT(send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL), 0);
    char byte = 0;
    EXPECT_EQ(recv(client, &byte, 1, 0), 0);  // it is let go
    close(client);
  }
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("is dropped: "));
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("it sent what is no message of Palpate"));
  // More than there is room for: those that are too many are turned away, and room comes back.
  std::vector<int> many;
  for (int i = 0; i < 40; ++i) many.push_back(connected());
  EXPECT_TRUE(awaitSaid("is turned away: 32 are here"));
  expectRefusal(ctl({"get", "servo.n"}), "the service", "32 clients are connected, and no more are served at once", 5);
  for (const int client : many) close(client);
  close(silent);
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(status()["clients"], 1);
}

}  // namespace serve_test
}  // namespace palpate
